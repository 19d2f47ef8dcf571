// Draws the world frame by frame, in three dimensions or in two: in two by itself where three come slowly or not at all.
import { element, put } from "./dom.ts";
import { Labels } from "./labels.ts";
import { Pace } from "./pace.ts";
import type { Quaternion } from "./told.ts";
import type { View } from "./view.ts";
import { View2D } from "./view2d.ts";
import { View3D } from "./view3d.ts";
import type { World } from "./world.ts";

const FLAT_MS = 30; // between frames in two dimensions: 30 a second leave the processor to the rest
const MEASURED_MS = 1000;

export class Stage {
  private readonly flat: View2D;
  private readonly deep: View3D | null;
  private now: View;
  private readonly pace = new Pace();
  private byHand = false;
  private last = 0;
  private scripted = 0;
  private frames = 0;
  private measured = 0;

  constructor(private readonly world: World) {
    const labels = new Labels(element("labels"));
    this.flat = new View2D(element<HTMLCanvasElement>("flat"), labels, world);
    this.deep = made(() => new View3D(element<HTMLCanvasElement>("scene"), labels, world));
    this.now = this.deep ?? this.flat;
    const why = this.deep ? (isQuick() ? "" : "2-D, as 3-D is drawn without a GPU here") : "2-D, as this browser has no WebGL";
    this.choose(why ? "2d" : "3d", why);
    if (!this.deep) for (const each of this.choices()) each.disabled = each.value === "3d";
    element("draw").addEventListener("change", () => {
      this.byHand = true;
      this.choose(this.choices().find((each) => each.checked)?.value ?? "2d", "");
    });
    requestAnimationFrame((ms) => this.frame(ms));
  }

  get view(): Quaternion {
    return this.now.view;
  }

  theme(): void {
    this.flat.theme();
    this.deep?.theme();
  }

  private choices(): HTMLInputElement[] {
    return [...document.querySelectorAll<HTMLInputElement>('input[name="draw"]')];
  }

  private choose(how: string, why: string): void {
    this.now = how === "3d" && this.deep ? this.deep : this.flat;
    this.flat.show(this.now === this.flat);
    this.deep?.show(this.now === this.deep);
    for (const each of this.choices()) each.checked = each.value === how;
    element("view").dataset.draw = how;
    put("draw-note", why);
    this.deep?.coarsen(false);
    this.pace.reset();
  }

  private frame(ms: number): void {
    requestAnimationFrame((next) => this.frame(next));
    const since = ms - this.last;
    if (this.now === this.flat && since < FLAT_MS) return;
    this.last = ms;
    const began = performance.now();
    this.world.update(Math.min(0.25, since / 1000), began);
    this.now.draw();
    this.measure(performance.now() - began, began);
    if (!this.pace.frame(ms) || this.now === this.flat) return;
    if (this.byHand) this.deep?.coarsen();
    else this.choose("2d", `2-D, as 3-D came at ${this.pace.fps.toFixed(0)} fps`);
  }

  /** Frames a second, and the script's share of one (ms), for who looks. */
  private measure(script: number, now: number): void {
    this.scripted += script;
    this.frames += 1;
    if (now - this.measured < MEASURED_MS) return;
    const { dataset } = element("view");
    dataset.fps = this.pace.fps.toFixed(1);
    dataset.script = (this.scripted / this.frames).toFixed(2);
    this.measured = now;
    this.scripted = this.frames = 0;
  }
}

/** Whether three dimensions are drawn by more than the processor, as far as the browser says it. */
function isQuick(): boolean {
  const probe = document.createElement("canvas").getContext("webgl2", { failIfMajorPerformanceCaveat: true });
  if (!probe) return false;
  const told = probe.getExtension("WEBGL_debug_renderer_info");
  const name = told ? String(probe.getParameter(told.UNMASKED_RENDERER_WEBGL)) : "";
  probe.getExtension("WEBGL_lose_context")?.loseContext();
  return !/swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}

function made<T>(make: () => T): T | null {
  try {
    return make();
  } catch {
    return null;
  }
}
