// What a hand holds down, on keys, buttons, sticks and gamepads: axes, and a number for each press. Knows no browser.

export type Act = "left" | "right" | "forward" | "back" | "up" | "down" | "yaw+" | "yaw-" | "pitch+" | "pitch-" | "roll+" | "roll-";
export type Frame = "view" | "base" | "tool";
export type Vector = [number, number, number];
/** Shares -1..1: to the right, ahead, up; pitch, roll, yaw. */
export type Six = [number, number, number, number, number, number];

export interface Axes {
  linear: Vector;
  angular: Vector;
}

const SIX: Record<Act, [number, number]> = {
  right: [0, 1],
  left: [0, -1],
  forward: [1, 1],
  back: [1, -1],
  up: [2, 1],
  down: [2, -1],
  "pitch+": [3, 1],
  "pitch-": [3, -1],
  "roll+": [4, 1],
  "roll-": [4, -1],
  "yaw+": [5, 1],
  "yaw-": [5, -1],
};

export class Hand {
  press = 0;
  private readonly held = new Map<string, Act>();
  readonly grips: Map<string, Six> = new Map();
  private readonly refused = new Set<string>();

  /** A key or button goes down; one that is down already, and a key's repetition, is no press. */
  down(source: string, act: Act, repeated = false): boolean {
    if (this.held.has(source)) return false;
    if (repeated) {
      this.refused.add(source); // down in truth, though it does not count
      return false;
    }
    this.refused.delete(source);
    this.held.set(source, act);
    this.press += 1;
    return true;
  }

  /** A stick or gamepad is gripped, or moves while it is; one that was let go for it counts again only after `up`. */
  grip(source: string, six: Six): boolean {
    if (this.refused.has(source)) return false;
    if (!this.grips.has(source)) this.press += 1;
    this.grips.set(source, six);
    return true;
  }

  /** A key or grip that must not count, however long it lasts. */
  refuse(source: string): void {
    this.held.delete(source);
    this.grips.delete(source);
    this.refused.add(source);
  }

  up(source: string): boolean {
    this.refused.delete(source);
    return this.held.delete(source) || this.grips.delete(source);
  }

  /** All at once: what is still held down in truth counts again only once it was up. */
  letGo(): boolean {
    const held = this.engaged;
    for (const source of [...this.held.keys(), ...this.grips.keys()]) this.refuse(source);
    return held;
  }

  /** Where nobody hears whether a key goes up, as without the focus: what was down of them is not known any more. */
  forgetKeys(): void {
    for (const source of [...this.refused]) if (source in KEYS) this.refused.delete(source);
  }

  /** Whether something is held down that does not count, and nothing that does. */
  get inVain(): boolean {
    return this.refused.size > 0 && !this.engaged;
  }

  get engaged(): boolean {
    return this.held.size + this.grips.size > 0;
  }

  holds(act: Act): boolean {
    return [...this.held.values()].includes(act);
  }

  get six(): Six {
    const sum: Six = [0, 0, 0, 0, 0, 0];
    for (const act of new Set(this.held.values())) {
      const [axis, sign] = SIX[act];
      sum[axis] = (sum[axis] ?? 0) + sign;
    }
    for (const grip of this.grips.values()) for (const [k, share] of grip.entries()) sum[k] = (sum[k] ?? 0) + share;
    return sum.map((share) => Math.max(-1, Math.min(1, share))) as Six;
  }

  /** Shares -1..1 along the frame's axes: of the view x is right, y ahead, z up; of base and tool x is ahead. */
  axes(frame: Frame): Axes {
    const [right, ahead, up, pitch, roll, yaw] = this.six;
    if (frame === "view") return { linear: [right, ahead, up], angular: [pitch, roll, yaw] };
    return { linear: [ahead, 0 - right, up], angular: [roll, 0 - pitch, yaw] };
  }
}

export const KEYS: Record<string, Act> = {
  KeyA: "left",
  KeyD: "right",
  KeyW: "forward",
  KeyS: "back",
  KeyE: "up",
  KeyQ: "down",
  ArrowLeft: "yaw+",
  ArrowRight: "yaw-",
  ArrowUp: "pitch+",
  ArrowDown: "pitch-",
  KeyO: "roll+",
  KeyU: "roll-",
};
