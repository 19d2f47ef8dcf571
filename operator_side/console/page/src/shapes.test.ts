import assert from "node:assert/strict";
import { test } from "node:test";
import { Vector3 } from "three";
import { hull } from "./hull.ts";
import { Thing } from "./shapes.ts";
import type { Shape } from "./told.ts";

const S = Math.SQRT1_2;
const CUBE: [number, number, number][] = [-1, 1].flatMap((x) =>
  [-1, 1].flatMap((y) => [-1, 1].map((z): [number, number, number] => [x / 10, y / 10, z / 10])),
);

function thing(shape: Shape, more: object = {}): Thing {
  return new Thing({ id: "it", position: [1, 0, 0], velocity: [0, 0, 0], orientation: [1, 0, 0, 0], shape, ...more });
}

test("the nearest point of each shape", () => {
  const at = (shape: Shape, more = {}) => thing(shape, more).nearest(new Vector3(0, 0, 0)).distance;
  const near = (found: number, wanted: number) => assert.ok(Math.abs(found - wanted) < 1e-6, `${found} is not ${wanted}`);
  near(at({ kind: "sphere", radius: 0.1 }), 0.9);
  near(at({ kind: "box", half_extents: [0.2, 1, 1] }), 0.8);
  near(at({ kind: "capsule", radius: 0.1, half_length: 0.5 }), 0.9);
  near(at({ kind: "capsule", radius: 0.1, half_length: 0.5 }, { orientation: [S, 0, S, 0] }), 0.4); // along x
  near(at({ kind: "mesh", vertices: CUBE }), 0.9);
  near(at({ kind: "plane" }, { position: [1, 0, -0.3] }), 0.3);
});

test("a mover goes on between scenes, and is no longer known where none comes", () => {
  const mover = thing({ kind: "sphere", radius: 0.1 }, { velocity: [0.1, 0, 0] });
  mover.goTo(0.5);
  assert.deepEqual([mover.position.x, mover.known], [1.05, true]);
  mover.goTo(9);
  assert.deepEqual([mover.position.x < 1.2, mover.known], [true, false]);
});

test("one that shuttles does not leave its path", () => {
  const mover = thing(
    { kind: "sphere", radius: 0.1 },
    {
      velocity: [0.1, 0, 0],
      path: [
        [0.9, 0, 0],
        [1.02, 0, 0],
      ],
    },
  );
  mover.goTo(1);
  assert.equal(mover.position.x, 1.02);
});

test("what stands is known for ever", () => {
  const still = thing({ kind: "sphere", radius: 0.1 });
  still.goTo(99);
  assert.equal(still.known, true);
});

test("a hull has the outermost points alone", () => {
  const found = hull([
    [0, 0],
    [2, 0],
    [2, 2],
    [0, 2],
    [1, 1],
    [1, 0],
  ]);
  assert.equal(found.length, 4);
});
