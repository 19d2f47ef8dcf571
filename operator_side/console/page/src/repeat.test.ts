import assert from "node:assert/strict";
import { test } from "node:test";
import { FRESH_MS, Repeat } from "./repeat.ts";

const HELD = { engaged: true, press: 1 };
const FREE = { engaged: false, press: 1 };

test("what is held is said again while the page is busy, but not for longer than is fresh", () => {
  const repeat = new Repeat();
  assert.equal(repeat.take(HELD, 0, 0), true);
  repeat.went(0);
  assert.equal(repeat.next(10), null);
  assert.equal(repeat.next(20), HELD);
  assert.equal(repeat.next(FRESH_MS), HELD);
  assert.equal(repeat.next(FRESH_MS + 1), null);
});

test("letting go goes at once and is not said again", () => {
  const repeat = new Repeat();
  repeat.take(HELD, 0, 0);
  repeat.went(0);
  assert.equal(repeat.take(FREE, 1, 1), true);
  assert.equal(repeat.next(30), null);
});

test("what was held too long ago is never said, and nothing of before after a break", () => {
  const repeat = new Repeat();
  assert.equal(repeat.take(HELD, 0, FRESH_MS + 1), false);
  repeat.take(HELD, 200, 200);
  repeat.forget();
  assert.equal(repeat.next(220), null);
});
