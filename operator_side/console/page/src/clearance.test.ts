import assert from "node:assert/strict";
import { test } from "node:test";
import { keptOf, leastOf } from "./clearance.ts";

const REPORT = { inflation: 0.02, sigma: 0.004, limit: 0.01 };

test("the arm is shown where it is nearer than the tool, and compared with its limit alone", () => {
  const least = leastOf({ clearance: 0.172, arm_clearance: 0.013 }, REPORT, null);
  assert.deepEqual([least.part, least.value, least.kept, least.other], ["arm", 0.013, 0.01, "tool 172"]);
  assert.equal(keptOf(least, REPORT), "arm limit 10; tool 34 = limit + margin 24");
});

test("a part that the guard names is named, where it says the same distance", () => {
  const state = { clearance: 0.172, arm_clearance: 0.013 };
  assert.equal(leastOf(state, REPORT, { part: "forearm_link", distance: 0.014, limit: 0.012 }).part, "forearm_link");
  assert.equal(leastOf(state, REPORT, { part: "forearm_link", distance: 0.05, limit: 0.012 }).part, "arm");
});

test("the tool is compared with limit and margin, and is all there is where no arm is measured", () => {
  const least = leastOf({ clearance: 0.05, arm_clearance: 0.06 }, REPORT, null);
  assert.deepEqual([least.part, least.other, Math.round((least.kept ?? 0) * 1000)], ["tool", "arm 60", 34]);
  assert.equal(keptOf(least, REPORT), "keeps 34 = limit 10 + margin 24");
  assert.deepEqual(leastOf({ clearance: 0.05, arm_clearance: null }, null, null).other, "");
});

test("a limit that nobody told is none, and not zero", () => {
  const report = { inflation: 0.02, sigma: 0.004, limit: null };
  const least = leastOf({ clearance: 0.172, arm_clearance: 0.013 }, report, null);
  assert.deepEqual([least.kept, least.limit], [null, null]);
  assert.equal(keptOf(least, report), "tool margin 24");
});
