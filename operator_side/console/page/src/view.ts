// What every way of drawing the world can do.
import type { Quaternion } from "./told.ts";

export interface View {
  /** Orientation of the view in base: x to the right, y ahead on the level, z up. */
  readonly view: Quaternion;
  /** Draw the world as it is by now. */
  draw(): void;
  /** Colours have changed. */
  theme(): void;
  show(shown: boolean): void;
}

export function css(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}
