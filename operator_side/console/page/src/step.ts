// A step: one press moves so far and then holds, and less if it is let go before. Knows no browser.
// It is measured on the prediction, which knows all that was commanded: what the robot last said is late by the network.
import type { Vector } from "./hand.ts";

export type Quaternion = [number, number, number, number];

export interface Place {
  position: Vector;
  orientation: Quaternion;
}

/** Of a full share, where the operator's program has no other setting (m/s, rad/s). */
export const SPEED = 0.25;
export const TURN_SPEED = 0.6;
export const STEP_M = 0.01;
export const STEP_RAD = (5 * Math.PI) / 180;
const GAIN = 2.5; // 1/s: slow enough for a plan of ten a second not to go too far
const TOLERANCE = 0.03; // of a step
const LEAST = 0.12; // of a step a second, so that the last bit does not take for ever

export class Step {
  private done = false;

  constructor(private readonly from: Place) {}

  /** How much of the step is done at a place, 0 to 1 and more: of the way or of the turn, whichever is more. */
  progress(at: Place): number {
    const way = Math.hypot(...at.position.map((x, k) => x - (this.from.position[k] ?? 0)));
    return Math.max(way / STEP_M, angleBetween(this.from.orientation, at.orientation) / STEP_RAD);
  }

  /** The share of full speed to ask for there; 0: it is done, for good. */
  share(at: Place, moves: boolean, turns: boolean): number {
    const left = 1 - this.progress(at);
    this.done ||= left < TOLERANCE;
    if (this.done) return 0;
    const pace = GAIN * left + LEAST; // steps a second
    return Math.min(1, moves ? (pace * STEP_M) / SPEED : 1, turns ? (pace * STEP_RAD) / TURN_SPEED : 1);
  }
}

export function angleBetween(a: Quaternion, b: Quaternion): number {
  const dot = Math.abs(a.reduce((sum, x, k) => sum + x * (b[k] ?? 0), 0));
  return 2 * Math.acos(Math.min(1, dot));
}
