// The world from above and from the robot's right side, in two dimensions: for machines that draw three slowly or not at all.
import { Vector3 } from "three";
import { element } from "./dom.ts";
import { hull, type Point } from "./hull.ts";
import type { Labels } from "./labels.ts";
import type { Thing } from "./shapes.ts";
import type { Quaternion as Q } from "./told.ts";
import { css, type View } from "./view.ts";
import type { World } from "./world.ts";

const UPRIGHT = matchMedia("(max-width: 760px)");
const CHOICES = () => (UPRIGHT.matches ? 108 : 64); // px: what is chosen above, and the pane's name
const ARROW = 0.7; // s: an arrow's length is the way of so long
const LEAST = { x: [-0.35, 0.8], y: [-0.6, 0.6], z: [-0.08, 0.85] } as const; // m that are shown, and more where something is beyond
const MOST = 1.6; // m

/** One of the two: what is to the right, what is up on the screen (axes of base), and where it lies. */
interface Pane {
  name: string;
  up: "y" | "z";
  left: number;
  top: number;
  width: number;
  height: number;
  /** Where its name stands, beside nothing that lies over it (px). */
  named: number;
  middle: Point;
  scale: number;
}

export class View2D implements View {
  readonly view: Q = [1, 0, 0, 0];
  private readonly pen: CanvasRenderingContext2D;
  private colours: Record<string, string> = {};
  private panes: Pane[] = [];
  private seen: Record<"x" | "y" | "z", number[]> = { x: [...LEAST.x], y: [...LEAST.y], z: [...LEAST.z] };
  private scenes = -1;

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly labels: Labels,
    private readonly world: World,
  ) {
    const pen = canvas.getContext("2d", { alpha: false, willReadFrequently: true }); // drawn by the processor: who has a GPU draws three
    if (!pen) throw new Error("this browser draws nothing");
    this.pen = pen;
    this.theme();
  }

  show(shown: boolean): void {
    this.canvas.hidden = !shown;
  }

  theme(): void {
    for (const name of ["ground", "grid", "line", "text", "dim", "arm", "thing", "go", "slow", "plan"])
      this.colours[name] = css(`--${name}`);
  }

  draw(): void {
    this.resize();
    const { pen, world } = this;
    pen.fillStyle = this.colour("ground");
    pen.fillRect(0, 0, this.canvas.clientWidth, this.canvas.clientHeight);
    for (const pane of this.panes) {
      pen.save();
      pen.beginPath();
      pen.rect(pane.left, pane.top, pane.width, pane.height);
      pen.clip();
      this.drawPane(pane);
      pen.restore();
      pen.fillStyle = this.colour("dim");
      pen.font = "600 13px system-ui, 'DejaVu Sans', sans-serif";
      pen.fillText(pane.name, pane.left + 12, pane.named);
    }
    const side = this.panes[1];
    this.labels.show(world.words, (at) => (side ? at2(side, at) : null));
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const ratio = Math.min(2, devicePixelRatio);
    if (this.canvas.width !== Math.floor(width * ratio) || this.canvas.height !== Math.floor(height * ratio)) {
      this.canvas.width = Math.floor(width * ratio);
      this.canvas.height = Math.floor(height * ratio);
      this.pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    }
    this.widen();
    const [besides, stacked] = [this.layOut(width, height, true), this.layOut(width, height, false)];
    this.panes = (besides[0]?.scale ?? 0) >= (stacked[0]?.scale ?? 0) ? besides : stacked;
  }

  private layOut(width: number, height: number, beside: boolean): Pane[] {
    const [w, h] = beside ? [width / 2, height] : [width, height / 2];
    const covered = UPRIGHT.matches && element("camera").dataset.look !== "none";
    const top = (up: "y" | "z") => (covered && (beside || up === "y") ? 182 : CHOICES()); // px: what is chosen, and the pane's name
    const below = UPRIGHT.matches ? 156 : 130; // keys or sticks
    const room = (up: "y" | "z") => h - top(up) - (beside || up === "z" ? below : 8);
    const [x0 = 0, x1 = 1] = this.seen.x;
    const tall = (up: "y" | "z") => (this.seen[up][1] ?? 1) - (this.seen[up][0] ?? 0);
    const scale = Math.max(1, Math.min((w - 16) / (x1 - x0), room("y") / tall("y"), room("z") / tall("z")));
    const pane = (name: string, up: "y" | "z", left: number, above: number): Pane => {
      const slack = (w - (x1 - x0) * scale) / 2;
      const middle: Point = [
        left + slack - x0 * scale,
        above + top(up) + (room(up) - tall(up) * scale) / 2 + (this.seen[up][1] ?? 1) * scale,
      ];
      const named = above > 0 ? above + 22 : top(up) - 2;
      return { name, up, left, top: above, width: w, height: h, named, scale, middle };
    };
    return [pane("from above", "y", 0, 0), pane("from its right side", "z", beside ? w : 0, beside ? 0 : h)];
  }

  /** To all that is around the robot, as far as it is near; never narrower again for the same scene, so that nothing jumps. */
  private widen(): void {
    const { world } = this;
    if (this.scenes !== world.scenes) {
      this.scenes = world.scenes;
      this.seen = { x: [...LEAST.x], y: [...LEAST.y], z: [...LEAST.z] };
    }
    const things = world.things.filter((each) => each.shape.kind !== "plane").map((each) => each.position);
    for (const at of [...things, ...world.targets, ...(world.tool ? [world.tool] : [])])
      for (const axis of ["x", "y", "z"] as const) {
        const [low = 0, high = 0] = this.seen[axis];
        this.seen[axis] = [Math.max(-MOST, Math.min(low, at[axis] - 0.12)), Math.min(MOST, Math.max(high, at[axis] + 0.12))];
      }
  }

  private colour(name: string): string {
    return this.colours[name] ?? "#888";
  }

  private drawPane(pane: Pane): void {
    const { pen, world } = this;
    this.drawGrid(pane);
    for (const { thing, keeps, binds } of world.dangers) {
      this.drawThing(pane, thing, this.colour("slow"), binds ? 0.3 : 0.14, keeps);
      if (thing.shape.kind !== "plane") this.rim(this.colour("slow"), binds ? 1 : 0.5);
    }
    for (const thing of world.things) this.drawThing(pane, thing, this.colour("thing"), thing.known ? 0.9 : 0.3, 0);
    this.drawLine(
      pane,
      world.trail.map(({ at }) => at),
      this.colour("arm"),
      2,
      0.6,
    );
    const fresh = Math.max(0.3, 1 - Math.max(0, world.age - 0.25));
    for (const hull of world.confirmed.hulls()) {
      this.fill(
        hull.map((at) => at2(pane, at)),
        this.colour("arm"),
        fresh,
        0,
      );
      this.rim(this.colour("ground"), 0.6);
    }
    if (world.ghostSeen > 0 && world.ghostWhole)
      for (const hull of world.ghost.hulls())
        this.outline(
          hull.map((at) => at2(pane, at)),
          this.colour("plan"),
          world.ghostSeen,
        );
    if (world.ghostSeen > 0 && !world.ghostWhole) this.ring(at2(pane, world.ghostAt), 9, this.colour("plan"));
    const target = world.targets[world.target];
    if (target) this.ring(at2(pane, target), Math.max(7, 0.03 * pane.scale), this.colour("go"));
    this.drawLine(pane, world.path, this.colour("ground"), 8, 0.75);
    this.drawLine(pane, world.path, this.colour("plan"), 3, 1);
    this.drawSteps(pane, world.path);
    const [first] = world.path;
    const end = world.path.at(-1);
    if (first && end && first.distanceTo(end) > 0.004) this.ring(at2(pane, end), 7, this.colour("plan"));
    if (!world.tool) return;
    pen.globalAlpha = 0.7;
    if (world.bare || world.dangers.some((each) => each.binds))
      this.ring(at2(pane, world.tool), world.radius * pane.scale, this.colour("dim"), 1.5);
    pen.globalAlpha = 1;
    this.arrow(pane, world.tool, world.asked, this.colour("dim"), 2);
    this.arrow(pane, world.tool, world.done, this.colour("text"), 5);
    const danger = world.dangers[0];
    if (danger?.binds) this.drawLine(pane, [danger.from, danger.to], this.colour("slow"), 3, 1);
  }

  private drawGrid(pane: Pane): void {
    const { pen } = this;
    pen.strokeStyle = this.colour("grid");
    pen.lineWidth = 1;
    pen.beginPath();
    const [x0, y0] = pane.middle;
    const [right, bottom] = [pane.left + pane.width, pane.top + pane.height];
    const line = (...ends: [Point, Point]) => this.trace(ends);
    for (let k = -20; k <= 20; k += 1) {
      const x = x0 + 0.1 * k * pane.scale;
      const y = y0 - 0.1 * k * pane.scale;
      if (pane.up === "y" || k === 0) line([pane.left, y], [right, y]);
      if (pane.up === "y") line([x, pane.top], [x, bottom]);
    }
    if (pane.left > 0) line([pane.left, 0], [pane.left, bottom]);
    if (pane.top > 0) line([0, pane.top], [right, pane.top]);
    pen.stroke();
  }

  /** Its outline, with `more` around it (m): a hull with a round brush. */
  private drawThing(pane: Pane, thing: Thing, colour: string, alpha: number, more: number): void {
    if (thing.shape.kind === "plane") this.drawPlane(pane, thing, colour, alpha, more);
    else
      this.fill(
        thing.outline.map((at) => at2(pane, at)),
        colour,
        alpha,
        (thing.round + more) * pane.scale,
      );
  }

  /** Seen from its edge a plane is a line, and all behind it solid; seen from its front it is everywhere, and not drawn. */
  private drawPlane(pane: Pane, thing: Thing, colour: string, alpha: number, more: number): void {
    const normal = new Vector3(0, 0, 1).applyQuaternion(thing.orientation);
    const depth = pane.up === "y" ? normal.z : normal.y;
    if (Math.abs(depth) > 0.3) return;
    const at = thing.position.clone().addScaledVector(normal, more);
    const along = pane.up === "y" ? new Vector3(-normal.y, normal.x, 0) : new Vector3(-normal.z, 0, normal.x);
    const far = [at.clone().addScaledVector(along, -3), at.clone().addScaledVector(along, 3)];
    const back = far.map((each) => each.clone().addScaledVector(normal, -3)).reverse();
    this.fill(
      [...far, ...back].map((each) => at2(pane, each)),
      colour,
      0.4 * alpha,
      0,
    );
  }

  private fill(points: Point[], colour: string, alpha: number, brush: number): void {
    const { pen } = this;
    const around = points.length > 2 ? hull(points) : points;
    const [first] = around;
    if (!first) return;
    pen.globalAlpha = alpha;
    pen.fillStyle = pen.strokeStyle = colour;
    pen.beginPath();
    if (around.length === 1) pen.arc(first[0], first[1], Math.max(1, brush), 0, 7);
    else this.trace(around);
    pen.closePath();
    if (brush > 0 && around.length > 1) this.thicken(around, brush);
    else pen.fill();
    pen.globalAlpha = 1;
  }

  /** A body that is not there yet: its rim, and little within. */
  private outline(points: Point[], colour: string, seen: number): void {
    this.fill(points, colour, 0.2 * seen, 0);
    this.rim(colour, seen);
  }

  /** Around what was filled last. */
  private rim(colour: string, alpha: number): void {
    const { pen } = this;
    pen.globalAlpha = alpha;
    pen.strokeStyle = colour;
    pen.lineWidth = 1.5;
    pen.stroke();
    pen.globalAlpha = 1;
  }

  /** Fill with a round brush along the rim, each spot once: what is drawn twice would be darker. */
  private thicken(around: Point[], brush: number): void {
    const { pen } = this;
    const spots = around.flatMap(([x, y]) =>
      Array.from({ length: 16 }, (_, k): Point => [x + brush * Math.cos((k * Math.PI) / 8), y + brush * Math.sin((k * Math.PI) / 8)]),
    );
    pen.beginPath();
    this.trace(hull(spots));
    pen.fill();
  }

  private trace(points: Point[]): void {
    points.forEach(([x, y], k) => {
      if (k) this.pen.lineTo(x, y);
      else this.pen.moveTo(x, y);
    });
  }

  private drawLine(pane: Pane, points: Vector3[], colour: string, width: number, alpha: number): void {
    if (points.length < 2) return;
    const { pen } = this;
    pen.globalAlpha = alpha;
    pen.strokeStyle = colour;
    pen.lineWidth = width;
    pen.lineJoin = pen.lineCap = "round";
    pen.beginPath();
    this.trace(points.map((each) => at2(pane, each)));
    pen.stroke();
    pen.globalAlpha = 1;
  }

  /** A dot for each step of the plan: where they are close together it goes slowly. */
  private drawSteps(pane: Pane, points: Vector3[]): void {
    this.pen.fillStyle = this.colour("plan");
    for (const point of points.slice(0, -1)) {
      const [x, y] = at2(pane, point);
      this.pen.beginPath();
      this.pen.arc(x, y, 4, 0, 7);
      this.pen.fill();
    }
  }

  private ring([x, y]: Point, radius: number, colour: string, width = 3): void {
    this.pen.strokeStyle = colour;
    this.pen.lineWidth = width;
    this.pen.beginPath();
    this.pen.arc(x, y, radius, 0, 7);
    this.pen.stroke();
  }

  private arrow(pane: Pane, from: Vector3, velocity: Vector3, colour: string, width: number): void {
    const [x, y] = at2(pane, from);
    const [x2, y2] = at2(pane, from.clone().addScaledVector(velocity, ARROW));
    const length = Math.hypot(x2 - x, y2 - y);
    if (length < 3) return;
    const [ux, uy] = [(x2 - x) / length, (y2 - y) / length];
    const head = 3 * width;
    const { pen } = this;
    pen.strokeStyle = pen.fillStyle = colour;
    pen.lineWidth = width;
    pen.lineCap = "butt";
    pen.beginPath();
    pen.moveTo(x, y);
    pen.lineTo(x2, y2);
    pen.stroke();
    pen.beginPath();
    pen.moveTo(x2 + ux * head, y2 + uy * head);
    pen.lineTo(x2 - uy * head * 0.6, y2 + ux * head * 0.6);
    pen.lineTo(x2 + uy * head * 0.6, y2 - ux * head * 0.6);
    pen.fill();
  }
}

function at2(pane: Pane, at: Vector3): Point {
  return [pane.middle[0] + at.x * pane.scale, pane.middle[1] - at[pane.up] * pane.scale];
}
