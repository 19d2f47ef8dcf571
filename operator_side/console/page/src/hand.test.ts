import assert from "node:assert/strict";
import { test } from "node:test";
import { Hand } from "./hand.ts";

test("a press counts once, however often the key repeats", () => {
  const hand = new Hand();
  assert.equal(hand.down("KeyW", "forward"), true);
  assert.equal(hand.down("KeyW", "forward"), false);
  assert.equal(hand.down("KeyA", "left", true), false);
  assert.deepEqual([hand.press, hand.engaged], [1, true]);
  hand.up("KeyW");
  assert.equal(hand.engaged, false);
});

test("a key that was held while the page let go counts again only once it was up", () => {
  const hand = new Hand();
  hand.down("KeyW", "forward");
  assert.equal(hand.letGo(), true);
  assert.equal(hand.down("KeyW", "forward", true), false);
  assert.equal(hand.engaged, false);
  hand.up("KeyW");
  assert.equal(hand.down("KeyW", "forward"), true);
  assert.equal(hand.press, 2);
});

test("opposite keys cancel, and frames have their axes", () => {
  const hand = new Hand();
  hand.down("KeyW", "forward");
  hand.down("KeyD", "right");
  hand.down("ArrowLeft", "yaw+");
  assert.deepEqual(hand.axes("view"), { linear: [1, 1, 0], angular: [0, 0, 1] });
  assert.deepEqual(hand.axes("base"), { linear: [1, -1, 0], angular: [0, 0, 1] });
  hand.down("KeyA", "left");
  assert.deepEqual(hand.axes("base").linear, [1, 0, 0]);
});
