import assert from "node:assert/strict";
import { test } from "node:test";
import { Matrix4, Quaternion, Vector3 } from "three";
import { URDFJoint, URDFRobot } from "urdf-loader/src/URDFClasses.js";
import { Arm, type Pose } from "./arm.ts";

const NAMES = ["a", "b", "c"];
const LINK = 0.4;
const ELBOW_UP = [0.6, -1.2, 0.3];

/** Three links in a plane. */
function planar(): URDFRobot {
  const robot = new URDFRobot();
  robot.joints = {};
  let parent: URDFRobot | URDFJoint = robot;
  for (const [k, name] of NAMES.entries()) {
    const joint: URDFJoint = new URDFJoint();
    joint.jointType = "revolute";
    joint.limit.lower = -3;
    joint.limit.upper = 3;
    joint.axis = new Vector3(0, 0, 1);
    joint.position.set(k ? LINK : 0, 0, 0);
    parent.add(joint);
    robot.joints[name] = joint;
    parent = joint;
  }
  return robot;
}

/** Where its tool is. */
function pose([a = 0, b = 0, c = 0]: number[]): Pose {
  const [x, y] = [a, a + b, a + b + c].reduce(([px, py], q) => [px + LINK * Math.cos(q), py + LINK * Math.sin(q)], [0, 0] as [
    number,
    number,
  ]);
  return { position: new Vector3(x, y, 0), orientation: new Quaternion().setFromRotationMatrix(new Matrix4().makeRotationZ(a + b + c)) };
}

function arm(): Arm {
  const made = new Arm("white", 1);
  made.adopt(planar(), NAMES);
  made.learnTool(ELBOW_UP, pose(ELBOW_UP));
  return made;
}

const off = (found: number[], wanted: number[]) => Math.max(...found.map((q, k) => Math.abs(q - (wanted[k] ?? 0))));

test("a ghost near the arm is the arm in the same posture, however it was drawn before", () => {
  const ghost = arm();
  const near = [0.65, -1.1, 0.25];
  ghost.set([-0.6, 1.2, 2.5]);
  assert.equal(ghost.reach(pose(near), ELBOW_UP), true);
  assert.ok(off(ghost.values, near) < 0.02, `${ghost.values}`);
});

test("a place that the arm does not reach gives no ghost of it", () => {
  assert.equal(arm().reach({ ...pose(ELBOW_UP), position: new Vector3(3, 0, 0) }, ELBOW_UP), false);
});
