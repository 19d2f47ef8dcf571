// The camera's pane: the newest picture, its age by the page's own count, and what is to be done where it froze.
import { element, emphasise } from "./dom.ts";
import { clock, type Picture } from "./told.ts";

const DIM_S = 0.5;
const FROZEN_S = 1.0;
const SEVERAL = 2.5; // so many of a slow camera's own periods are no silence
const SLOWEST_S = 5;

export type Look = "none" | "fresh" | "dim" | "frozen";

/** Ages are by now (s). */
export interface Seen {
  /** Since the picture was captured, at most and at least; null: not known. */
  most: number | null;
  least: number | null;
  /** Since it came. */
  silent: number;
  /** From one picture to the next. */
  between: number;
}

/** How a picture is to look, and what is said of it; null: none ever came. Knows no browser. */
export function lookOf(seen: Seen | null): { look: Look; said: string } {
  if (!seen) return { look: "none", said: "no camera" };
  const sure = Math.max(seen.least ?? 0, seen.silent);
  if (sure > Math.max(FROZEN_S, SEVERAL * Math.min(SLOWEST_S, seen.between)))
    return { look: "frozen", said: `camera frozen, ${sure.toFixed(0)} s` };
  const age = seen.most ?? sure;
  const said = `${seen.most === null ? "≥" : "≤"} ${age < 1 ? `${(age * 1000).toFixed(0)} ms` : `${age.toFixed(1)} s`} old`;
  return { look: age > DIM_S ? "dim" : "fresh", said: `camera ${said}` };
}

export class Camera {
  private picture: Picture | null = null;
  private came = 0;
  private between = 0;
  /** The person drives on without it, until it moves again. */
  private without = false;

  hear(picture: Picture, at: number): void {
    const { bitmap } = picture;
    if (!bitmap) return; // what is said of one that is old: its age is counted here
    const canvas = element<HTMLCanvasElement>("camera-picture");
    if (canvas.width !== bitmap.width) canvas.width = bitmap.width;
    if (canvas.height !== bitmap.height) canvas.height = bitmap.height;
    canvas.getContext("2d")?.drawImage(bitmap, 0, 0);
    bitmap.close();
    this.between = this.picture ? (at - this.came) / 1000 : 0;
    this.picture = picture;
    this.came = at;
    if (this.now.look !== "frozen") this.without = false;
  }

  /** Drive on without it. */
  close(): void {
    this.without = true;
  }

  /** Why driving is locked; empty: a camera that never was, or is done without, locks nothing. */
  get locks(): string {
    const { look, said } = this.now;
    return look === "frozen" && !this.without ? `The camera has been frozen for ${said.split(", ")[1]}. Driving is locked.` : "";
  }

  private get now(): { look: Look; said: string } {
    if (!this.picture) return lookOf(null);
    const silent = Math.max(0, (clock() - this.came) / 1000);
    const since = (ms: number | null) => (ms === null ? null : ms / 1000 + silent);
    return lookOf({ most: since(this.picture.most_ms), least: since(this.picture.least_ms), silent, between: this.between });
  }

  /** The console locks as well, for a while: until then nobody can drive without it. */
  show(locked: boolean): void {
    const { look, said } = this.now;
    const pane = element("camera");
    const shown = this.without ? "none" : look;
    if (pane.dataset.look !== shown) pane.dataset.look = shown;
    emphasise("camera-age", this.without ? `${said} · driving without it` : said);
    element("camera-close").hidden = shown !== "frozen" || locked;
  }
}
