import assert from "node:assert/strict";
import { test } from "node:test";
import { type Place, SPEED, STEP_M, STEP_RAD, Step, TURN_SPEED } from "./step.ts";

function place(x = 0, angle = 0): Place {
  return { position: [x, 0, 0], orientation: [Math.cos(angle / 2), 0, 0, Math.sin(angle / 2)] };
}

/** Drive a step with commands that count `late` s later, a plan of ten a second. */
function driven(turns: boolean, late: number): number {
  const step = new Step(place());
  const dt = 0.005;
  const asked: number[] = Array(Math.round(late / dt)).fill(0);
  let at = 0;
  for (let t = 0; t < 6; t += dt) {
    asked.push(step.share(turns ? place(0, at) : place(at), !turns, turns) * (turns ? TURN_SPEED : SPEED));
    at += (asked.shift() ?? 0) * dt;
  }
  return at;
}

test("a step goes so far and holds, to a twentieth, though what is asked counts a tenth of a second later", () => {
  for (const late of [0, 0.05, 0.1]) {
    assert.ok(Math.abs(driven(false, late) - STEP_M) < STEP_M / 20);
    assert.ok(Math.abs(driven(true, late) - STEP_RAD) < STEP_RAD / 20);
  }
});

test("a step that is done stays done", () => {
  const step = new Step(place());
  assert.ok(step.share(place(), true, false) > 0);
  assert.equal(step.share(place(STEP_M), true, false), 0);
  assert.equal(step.share(place(), true, false), 0);
});
