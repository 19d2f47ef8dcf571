import assert from "node:assert/strict";
import { test } from "node:test";
import { sliderShare, stickShares } from "./stick.ts";

test("a stick gives nothing near its middle and all at its rim, whatever the direction", () => {
  assert.deepEqual(stickShares(5, 3, 60), [0, 0]);
  assert.deepEqual(stickShares(60, 0, 60), [1, 0]);
  const [x, y] = stickShares(300, -400, 60);
  assert.deepEqual([x, y], [0.6, 0.8]);
});

test("shares grow with the way from the middle, without a jump", () => {
  const shares = Array.from({ length: 61 }, (_, d) => stickShares(d, 0, 60)[0]);
  for (const [k, share] of shares.entries())
    assert.ok(k === 0 || (share - (shares[k - 1] ?? 0) >= 0 && share - (shares[k - 1] ?? 0) < 0.03));
});

test("a slider has a sign", () => {
  assert.deepEqual([sliderShare(60, 60), sliderShare(-60, 60), sliderShare(0, 60)], [1, -1, 0]);
});
