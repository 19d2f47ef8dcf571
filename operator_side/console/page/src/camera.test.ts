import assert from "node:assert/strict";
import { test } from "node:test";
import { lookOf } from "./camera.ts";

const SEEN = { most: 0.08, least: 0.02, silent: 0.01, between: 0.05 };

test("a picture ages by itself: fresh, dim, frozen", () => {
  assert.deepEqual(lookOf(null), { look: "none", said: "no camera" });
  assert.deepEqual(lookOf(SEEN), { look: "fresh", said: "camera ≤ 80 ms old" });
  assert.equal(lookOf({ ...SEEN, most: 0.6 }).look, "dim");
  assert.deepEqual(lookOf({ ...SEEN, most: 3.3, least: 3.2, silent: 3.1 }), { look: "frozen", said: "camera frozen, 3 s" });
  assert.equal(lookOf({ ...SEEN, least: 1.1, most: 1.2 }).look, "frozen"); // old when it comes
});

test("an age that nobody measured is not claimed", () => {
  assert.equal(lookOf({ ...SEEN, most: null, least: null }).said, "camera ≥ 10 ms old");
});

test("a slow camera between two of its pictures is not frozen", () => {
  assert.equal(lookOf({ most: 1.4, least: 1.3, silent: 1.2, between: 1 }).look, "dim");
  assert.equal(lookOf({ most: 2.8, least: 2.7, silent: 2.6, between: 1 }).look, "frozen");
});
