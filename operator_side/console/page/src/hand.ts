// What a hand holds down, from keys and buttons: axes, and a number for each press. Knows no browser.

export type Act =
  | "left" | "right" | "forward" | "back" | "up" | "down"
  | "yaw+" | "yaw-" | "pitch+" | "pitch-" | "roll+" | "roll-";
export type Frame = "view" | "base" | "tool";
export type Vector = [number, number, number];

export interface Axes {
  linear: Vector;
  angular: Vector;
}

export class Hand {
  press = 0;
  private readonly held = new Map<string, Act>();

  /** A key or button goes down; one that is down already, and a key's repetition, is no press. */
  down(source: string, act: Act, repeated = false): boolean {
    if (repeated || this.held.has(source)) return false;
    this.held.set(source, act);
    this.press += 1;
    return true;
  }

  up(source: string): boolean {
    return this.held.delete(source);
  }

  /** All at once: what is still held down in truth counts again only once it was up. */
  letGo(): boolean {
    const held = this.held.size > 0;
    this.held.clear();
    return held;
  }

  get engaged(): boolean {
    return this.held.size > 0;
  }

  holds(act: Act): boolean {
    return [...this.held.values()].includes(act);
  }

  /** Shares -1..1 along the frame's axes: of the view x is right, y ahead, z up; of base and tool x is ahead. */
  axes(frame: Frame): Axes {
    const share = (plus: Act, minus: Act) => (this.holds(plus) ? 1 : 0) - (this.holds(minus) ? 1 : 0);
    const right = share("right", "left");
    const ahead = share("forward", "back");
    const pitch = share("pitch+", "pitch-");
    const roll = share("roll+", "roll-");
    const up = share("up", "down");
    const yaw = share("yaw+", "yaw-");
    if (frame === "view") return { linear: [right, ahead, up], angular: [pitch, roll, yaw] };
    return { linear: [ahead, 0 - right, up], angular: [roll, 0 - pitch, yaw] };
  }
}

export const KEYS: Record<string, Act> = {
  KeyA: "left", KeyD: "right", KeyW: "forward", KeyS: "back", KeyE: "up", KeyQ: "down",
  ArrowLeft: "yaw+", ArrowRight: "yaw-", ArrowUp: "pitch+", ArrowDown: "pitch-", KeyO: "roll+", KeyU: "roll-",
};
