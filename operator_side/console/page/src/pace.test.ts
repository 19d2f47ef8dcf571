import assert from "node:assert/strict";
import { test } from "node:test";
import { Pace } from "./pace.ts";

function slowAfter(period: number, until = 10_000): number | null {
  const pace = new Pace();
  for (let t = 0; t < until; t += period) if (pace.frame(t)) return t;
  return null;
}

test("under twenty frames a second for two seconds is slow, one in between is not", () => {
  const after = slowAfter(1000 / 15);
  assert.ok(after !== null && after > 1900 && after < 2600);
  assert.equal(slowAfter(1000 / 25), null);
  const veryslow = slowAfter(900);
  assert.ok(veryslow !== null && veryslow <= 2700);
});

test("a page that slept was not slow", () => {
  const pace = new Pace();
  for (const t of [0, 16, 33, 50, 66, 60_000, 60_016, 60_033, 60_050]) assert.equal(pace.frame(t), false);
});
