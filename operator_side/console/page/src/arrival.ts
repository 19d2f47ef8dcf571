// Whether the robot has a press: whether it applies the first command that moves because of it, or one after. Knows no browser.
import type { Vector } from "./hand.ts";

interface CommandTold {
  session: number;
  seq: number;
  mode: string;
  desired: Vector;
  desired_angular: Vector;
}

export class Arrival {
  private press = 0;
  /** The newest command when the press began: it was sent before. */
  private before = 0;
  private command: { session: number; seq: number } | null = null;

  /** One instant: the press that the console holds for this page, 0: none; the newest command; what the robot applies. */
  received(press: number, sent: CommandTold | null, applied: { applied_session: number; applied_seq: number } | null): boolean {
    if (press !== this.press) {
      this.command = null;
      this.before = sent?.seq ?? 0;
    }
    this.press = press;
    if (!press || !sent || !applied) return false;
    const moves = sent.mode === "run" && [...sent.desired, ...sent.desired_angular].some((share) => share !== 0);
    if (moves && sent.seq > this.before && this.command?.session !== sent.session) this.command = { session: sent.session, seq: sent.seq };
    return this.command !== null && applied.applied_session === this.command.session && applied.applied_seq >= this.command.seq;
  }
}
