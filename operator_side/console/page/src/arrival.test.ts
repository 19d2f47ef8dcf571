import assert from "node:assert/strict";
import { test } from "node:test";
import { Arrival } from "./arrival.ts";
import type { Vector } from "./hand.ts";

const still = { session: 7, seq: 10, mode: "hold", desired: [0, 0, 0] as Vector, desired_angular: [0, 0, 0] as Vector };
const moving = { ...still, seq: 11, mode: "run", desired: [0.1, 0, 0] as Vector };
const applies = (applied_seq: number, applied_session = 7) => ({ applied_seq, applied_session });

test("a press is there once the robot applies the first command that moves because of it", () => {
  const arrival = new Arrival();
  assert.equal(arrival.received(1, still, applies(10)), false);
  assert.equal(arrival.received(1, moving, applies(10)), false);
  assert.equal(arrival.received(1, { ...moving, seq: 15 }, applies(11)), true);
});

test("a new press is not there because the one before was", () => {
  const arrival = new Arrival();
  arrival.received(1, still, applies(10));
  assert.equal(arrival.received(1, moving, applies(11)), true);
  assert.equal(arrival.received(0, moving, applies(12)), false);
  assert.equal(arrival.received(2, { ...moving, seq: 20 }, applies(12)), false);
  assert.equal(arrival.received(2, { ...moving, seq: 21 }, applies(20)), false);
  assert.equal(arrival.received(2, { ...moving, seq: 25 }, applies(21)), true);
});

test("what another operator's command has is nothing of ours", () => {
  const arrival = new Arrival();
  arrival.received(1, still, applies(99, 8));
  assert.equal(arrival.received(1, moving, applies(99, 8)), false);
});
