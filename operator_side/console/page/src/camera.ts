// The camera's pane: the newest picture, its age by the page's own count, and what is to be done where it froze.
import { element, put } from "./dom.ts";
import { clock, type Picture } from "./told.ts";

export const DIM_S = 0.5;
export const FROZEN_S = 1.0;

export type Look = "none" | "fresh" | "dim" | "frozen";

/** How a picture of an age (s) is to look, and what is said of it; null: none ever came. Knows no browser. */
export function lookOf(age: number | null, known: boolean): { look: Look; said: string } {
  if (age === null) return { look: "none", said: "no camera" };
  if (age > FROZEN_S) return { look: "frozen", said: `camera frozen, ${age.toFixed(0)} s` };
  const said = known ? `${(age * 1000).toFixed(0)} ms old` : `at least ${(age * 1000).toFixed(0)} ms old`;
  return { look: age > DIM_S ? "dim" : "fresh", said: `camera · ${said}` };
}

export class Camera {
  private captured: number | null = null;
  private known = false;
  /** The person drives on without it, until it moves again. */
  private without = false;

  hear(picture: Picture, at: number): void {
    const canvas = element<HTMLCanvasElement>("camera-picture");
    const { bitmap } = picture;
    if (canvas.width !== bitmap.width) canvas.width = bitmap.width;
    if (canvas.height !== bitmap.height) canvas.height = bitmap.height;
    canvas.getContext("2d")?.drawImage(bitmap, 0, 0);
    bitmap.close();
    this.known = picture.age_ms !== null;
    this.captured = at - (picture.age_ms ?? 0);
    if (clock() - this.captured <= FROZEN_S * 1000) this.without = false;
  }

  /** Drive on without it. */
  close(): void {
    this.without = true;
  }

  /** Why driving is locked; empty: a camera that never was, or is done without, locks nothing. */
  get locks(): string {
    const { look, said } = lookOf(this.age, this.known);
    return look === "frozen" && !this.without ? `The ${said}. Driving is locked.` : "";
  }

  private get age(): number | null {
    return this.captured === null ? null : Math.max(0, (clock() - this.captured) / 1000);
  }

  show(): void {
    const { look, said } = lookOf(this.age, this.known);
    const pane = element("camera");
    const shown = this.without ? "none" : look;
    if (pane.dataset.look !== shown) pane.dataset.look = shown;
    put("camera-age", this.without ? `${said} · driving without it` : said);
    element("camera-close").hidden = shown !== "frozen";
  }
}
