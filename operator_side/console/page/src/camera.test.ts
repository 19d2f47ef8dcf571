import assert from "node:assert/strict";
import { test } from "node:test";
import { lookOf } from "./camera.ts";

test("a picture ages by itself: fresh, dim, frozen", () => {
  assert.deepEqual(lookOf(null, true), { look: "none", said: "no camera" });
  assert.deepEqual(lookOf(0.08, true), { look: "fresh", said: "camera · 80 ms old" });
  assert.equal(lookOf(0.6, true).look, "dim");
  assert.deepEqual(lookOf(3.2, true), { look: "frozen", said: "camera frozen, 3 s" });
});

test("an age that nobody measured is not claimed", () => {
  assert.equal(lookOf(0.08, false).said, "camera · at least 80 ms old");
});
