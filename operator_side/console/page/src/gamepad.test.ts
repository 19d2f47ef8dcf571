import assert from "node:assert/strict";
import { test } from "node:test";
import { Pad, type PadState, rumble } from "./gamepad.ts";

const DEADMAN = 5;

function pad(axes: number[], pressed: number[] = [], id = "pad"): PadState {
  return {
    id,
    axes,
    buttons: Array.from({ length: 17 }, (_, k) => ({ pressed: pressed.includes(k), value: pressed.includes(k) ? 1 : 0 })),
  };
}

function ready(): Pad {
  const found = new Pad();
  found.read(pad([0, 0, 0, 0]));
  found.read(pad([0, 0, 0, 0]));
  return found;
}

test("nothing moves without the deadman button", () => {
  assert.equal(ready().read(pad([1, 1, 1, 1])).held, false);
});

test("with it the left stick moves and the right one turns", () => {
  const found = ready();
  assert.equal(found.read(pad([0, 0, 0, 0], [DEADMAN])).held, true);
  assert.deepEqual(found.read(pad([0, -1, 0, 0], [DEADMAN])).six, [0, 1, 0, 0, 0, 0]);
  assert.deepEqual(found.read(pad([0, 0, 1, 0], [DEADMAN])).six, [0, 0, 0, 0, 0, -1]);
  assert.deepEqual(found.read(pad([0, 0, 0, 0], [DEADMAN, 7])).six, [0, 0, 1, 0, 0, 0]);
});

test("a stick that is off its middle at the press refuses it until a new one", () => {
  const found = ready();
  assert.match(found.read(pad([0.4, 0, 0, 0], [DEADMAN])).said, /off its middle/);
  assert.equal(found.read(pad([0, 0, 0, 0], [DEADMAN])).held, false);
  found.read(pad([0, 0, 0, 0]));
  assert.equal(found.read(pad([0, 0, 0, 0], [DEADMAN])).held, true);
});

test("a button that is down when the gamepad is first seen, or seen again, is no press", () => {
  const found = new Pad();
  for (let k = 0; k < 3; k += 1) assert.equal(found.read(pad([0, 0, 0, 0], [DEADMAN])).held, false);
  const other = ready();
  other.read(pad([0, 0, 0, 0], [DEADMAN]));
  other.forget();
  assert.equal(other.read(pad([0, 0, 0, 0], [DEADMAN])).held, false);
});

test("unplugged means let go, is said, and another gamepad begins anew", () => {
  const found = ready();
  found.read(pad([0, 0, 0, 0], [DEADMAN]));
  const lost = found.read(null);
  assert.deepEqual([lost.held, /unplugged/.test(lost.said)], [false, true]);
  for (let k = 0; k < 2; k += 1) assert.equal(found.read(pad([0, 0, 0, 0], [DEADMAN], "other")).held, false);
});

test("it rumbles by the share that is not done", () => {
  assert.equal(rumble([0.2, 0, 0], [0.2, 0, 0]), 0);
  assert.equal(rumble([0.2, 0, 0], [0.1, 0, 0]), 0.5);
  assert.equal(rumble([0.2, 0, 0], [-0.2, 0, 0]), 1);
  assert.equal(rumble([0, 0, 0], [0.1, 0, 0]), 0);
});
