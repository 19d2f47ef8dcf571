// A gamepad with a deadman button: nothing moves without it, and a stick that is off its middle at the press refuses it. Knows no browser.
import type { Six, Vector } from "./hand.ts";
import { beyondDead } from "./stick.ts";

export interface PadState {
  id: string;
  axes: readonly number[];
  buttons: readonly { pressed: boolean; value: number }[];
}

export interface Grip {
  held: boolean;
  six: Six;
  /** For people; empty: nothing to say. */
  said: string;
}

export const UNREAD = "The gamepad is not read: this page has lost the focus. Click on it, then press the shoulder button anew.";
const DEADMEN = [4, 5]; // the shoulder buttons of the standard layout
const [DOWN, UP, ROLL_LEFT, ROLL_RIGHT] = [6, 7, 14, 15];
const DEAD = 0.15;
const REST: Six = [0, 0, 0, 0, 0, 0];

export class Pad {
  private was = true; // whatever is down when it is first seen was pressed before
  private held = false;
  private refused = "";
  private id = "";

  /** The newest state; null: none is there. */
  read(state: PadState | null): Grip {
    if (!state || state.id !== this.id) {
      const lost = this.id !== "" && !state;
      this.id = state?.id ?? "";
      this.forget();
      return { held: false, six: REST, said: lost ? "Gamepad unplugged: it holds." : "" };
    }
    const pressed = DEADMEN.some((button) => state.buttons[button]?.pressed);
    const six = sixOf(state);
    if (!pressed) this.refused = "";
    else if (!this.was && six.some((share) => share !== 0))
      this.refused = "Gamepad: a stick is off its middle. Let go of it, then press the shoulder button again.";
    const fresh = pressed && !this.was;
    const held = pressed && !this.refused && (fresh || this.held);
    this.was = pressed;
    this.held = held;
    return { held, six: held ? six : REST, said: this.refused };
  }

  /** Nobody looks: it counts again only once its button was up. */
  forget(): void {
    this.was = true;
    this.held = false;
    this.refused = "";
  }
}

function sixOf({ axes, buttons }: PadState): Six {
  const stick = (k: number) => curved(axes[k] ?? 0);
  const button = (k: number) => beyondDead(buttons[k]?.value ?? 0, 0.05);
  const six: Six = [stick(0), -stick(1), button(UP) - button(DOWN), -stick(3), button(ROLL_RIGHT) - button(ROLL_LEFT), -stick(2)];
  return six.map((share) => share || 0) as Six; // no -0
}

/** Fine in the middle, all at the rim. */
function curved(share: number): number {
  const beyond = beyondDead(Math.abs(share), DEAD);
  return Math.sign(share) * beyond * beyond;
}

/** How hard to rumble, 0 to 1: the share of what is asked (m/s) that is not done. */
export function rumble(asked: Vector, done: Vector): number {
  const much = Math.hypot(...asked);
  if (much < 0.005) return 0;
  return Math.min(1, Math.hypot(...asked.map((x, k) => x - (done[k] ?? 0))) / much);
}
