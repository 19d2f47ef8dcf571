import assert from "node:assert/strict";
import { test } from "node:test";
import type { FrameTold, RobotState } from "./told.ts";
import { World } from "./world.ts";

const AHEAD = { linear: [0, 1, 0], angular: [0, 0, 0] } as const;

function after(mode: RobotState["mode"]): number {
  const world = new World();
  const state = { mode, position: [0, 0, 0], orientation: [1, 0, 0, 0], velocity: [0, 0, 0], joints: [], t_sample_ns: 0 };
  const report = { predicted: [0, 0, 0], predicted_orientation: [1, 0, 0, 0], desired: [0, 0, 0], inflation: 0, sigma: 0 };
  world.hear({ state, report, age: 0, path: [], locked: "", holds: true } as unknown as FrameTold, 0);
  world.wants({ linear: [...AHEAD.linear], angular: [...AHEAD.angular] }, "base", 1, [1, 0, 0, 0]);
  world.update(0.5, 0);
  return world.ghostAt.y;
}

test("the ghost leads by what is held down, and not where the robot has latched a stop", () => {
  assert.ok(after("run") > 0.02);
  assert.equal(after("stopped"), 0);
  assert.equal(after("estop"), 0);
});
