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

test("a grip is one press however it moves, and adds to keys up to a full share", () => {
  const hand = new Hand();
  assert.equal(hand.grip("stick", [0.5, 0, 0, 0, 0, 0]), true);
  hand.grip("stick", [0.7, 0, 0, 0, 0, 0]);
  assert.deepEqual([hand.press, hand.six[0]], [1, 0.7]);
  hand.down("KeyD", "right");
  assert.deepEqual([hand.press, hand.six[0]], [2, 1]);
});

test("a grip that was let go for its hand counts again only once it was up", () => {
  const hand = new Hand();
  hand.grip("stick", [1, 0, 0, 0, 0, 0]);
  hand.letGo();
  assert.equal(hand.grip("stick", [1, 0, 0, 0, 0, 0]), false);
  assert.equal(hand.engaged, false);
  hand.up("stick");
  assert.equal(hand.grip("stick", [1, 0, 0, 0, 0, 0]), true);
  assert.equal(hand.press, 2);
});

test("a grip that began when it might not count stays out", () => {
  const hand = new Hand();
  hand.refuse("stick");
  assert.equal(hand.grip("stick", [1, 0, 0, 0, 0, 0]), false);
  assert.deepEqual([hand.engaged, hand.press], [false, 0]);
});

test("two sources of one act are one, and the second goes on when the first is up", () => {
  const hand = new Hand();
  hand.down("KeyW", "forward");
  hand.down("pointer 1", "forward");
  assert.equal(hand.six[1], 1);
  hand.up("KeyW");
  assert.equal(hand.six[1], 1);
});

test("what is held down in vain is known until it is up, pressed anew or out of sight", () => {
  const hand = new Hand();
  hand.down("KeyW", "forward");
  assert.equal(hand.inVain, false);
  hand.letGo();
  assert.equal(hand.inVain, true);
  hand.up("KeyW");
  assert.equal(hand.inVain, false);
  hand.refuse("KeyW");
  assert.equal(hand.down("KeyW", "forward"), true);
  assert.equal(hand.inVain, false);
  hand.letGo();
  hand.forgetKeys();
  assert.equal(hand.inVain, false);
  hand.down("KeyW", "forward", true); // its repetition tells that it is down
  assert.deepEqual([hand.inVain, hand.engaged], [true, false]);
});
