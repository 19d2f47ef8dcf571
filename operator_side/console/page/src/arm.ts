// An arm that is drawn: its URDF in one colour, and the inverse kinematics that a ghost needs.
import {
  Box3,
  type BufferGeometry,
  type Color,
  Group,
  LoadingManager,
  Matrix4,
  Mesh,
  MeshStandardMaterial,
  type Object3D,
  Quaternion,
  Vector3,
} from "three";
import URDFLoader, { type URDFJoint, type URDFRobot } from "urdf-loader";

const NEAR = 0.002; // m
const ALIKE = 0.01; // rad

export interface Pose {
  position: Vector3;
  orientation: Quaternion;
}

export class Arm {
  readonly group = new Group();
  readonly material: MeshStandardMaterial;
  private robot: URDFRobot | null = null;
  private joints: URDFJoint[] = [];
  private last: Object3D | null = null;
  private readonly tool = new Matrix4(); // of the tool, in the last joint's frame
  private hasTool = false;
  private bodies: [Mesh, Vector3[]][] = [];
  values: number[] = [];

  constructor(colour: string, opacity: number) {
    this.material = new MeshStandardMaterial({
      color: colour,
      transparent: opacity < 1,
      opacity,
      depthWrite: opacity === 1,
      roughness: 0.75,
      metalness: 0.1,
    });
  }

  async load(names: string[]): Promise<void> {
    const manager = new LoadingManager(); // of its own: the default one is shared
    const robot = await new Promise<URDFRobot>((done, failed) => {
      let found: URDFRobot | null = null;
      manager.onLoad = () => found && done(found);
      new URDFLoader(manager).load("robot/model.urdf", (each) => (found = each), undefined, failed);
    });
    robot.traverse((each) => {
      if (each instanceof Mesh) each.geometry.computeVertexNormals(); // those in the files are not all there
    });
    this.adopt(robot, names);
  }

  /** The same arm once more. */
  copy(other: Arm, names: string[]): void {
    if (other.robot) this.adopt(other.robot.clone(), names);
  }

  /** The outermost points of every body, in base: what an outline is made from. */
  hulls(): Vector3[][] {
    this.group.updateMatrixWorld(true);
    return this.bodies.map(([body, points]) => points.map((at) => at.clone().applyMatrix4(body.matrixWorld)));
  }

  /** Take this robot; the joints by their names, from the base on. */
  adopt(robot: URDFRobot, names: string[]): void {
    this.robot = robot;
    this.joints = names.map((name) => robot.joints[name]).filter((joint): joint is URDFJoint => joint !== undefined);
    this.last = this.joints.at(-1) ?? null;
    this.group.clear();
    this.group.add(robot);
    this.bodies = [];
    robot.traverse((each) => {
      if (!(each instanceof Mesh)) return;
      each.material = this.material;
      this.bodies.push([each, outermost(each.geometry)]);
    });
  }

  get isLoaded(): boolean {
    return this.last !== null;
  }

  colour(colour: Color): void {
    this.material.color.copy(colour);
  }

  set(values: number[]): void {
    this.values = [...values];
    for (const [k, joint] of this.joints.entries()) joint.setJointValue(values[k] ?? 0);
  }

  /** Where the tool is on the last link follows from one pose that was measured with its joints. */
  learnTool(values: number[], pose: Pose): void {
    if (!this.last) return;
    this.set(values);
    this.group.updateMatrixWorld(true);
    const measured = new Matrix4().compose(pose.position, pose.orientation, new Vector3(1, 1, 1));
    this.tool.copy(this.last.matrixWorld).invert().multiply(measured);
    this.hasTool = true;
  }

  copyTool(other: Arm): void {
    this.tool.copy(other.tool);
    this.hasTool = other.hasTool;
  }

  /** A point on a named link, for a line from it. */
  linkPoint(name: string): Vector3 | null {
    const link = this.robot?.links[name];
    if (!link) return null;
    const box = new Box3();
    link.children.forEach((child) => {
      if (!("isURDFJoint" in child)) box.expandByObject(child);
    });
    return box.isEmpty() ? link.getWorldPosition(new Vector3()) : box.getCenter(new Vector3());
  }

  /**
   * Turn the joints so that the tool comes to a pose, by damped least squares, always from the same joints: from where
   * they were drawn last they might end in another posture. False: it is not reached, and the arm is not there.
   */
  reach(wanted: Pose, values: number[], steps = 12): boolean {
    if (!this.last || !this.hasTool) return false;
    this.set(values);
    for (let k = 0; ; k += 1) {
      this.group.updateMatrixWorld(true);
      const at = new Matrix4().multiplyMatrices(this.last.matrixWorld, this.tool);
      const position = new Vector3();
      const orientation = new Quaternion();
      at.decompose(position, orientation, new Vector3());
      const error = [...wanted.position.clone().sub(position).toArray(), ...turnBetween(orientation, wanted.orientation)];
      if (Math.hypot(...error.slice(0, 3)) < NEAR && Math.hypot(...error.slice(3)) < ALIKE) return true;
      if (k >= steps) return false;
      const columns = this.joints.map((joint) => {
        const axis = joint.axis.clone().transformDirection(joint.matrixWorld);
        const from = new Vector3().setFromMatrixPosition(joint.matrixWorld);
        return [...axis.clone().cross(position.clone().sub(from)).toArray(), ...axis.toArray()];
      });
      const change = dampedSolution(columns, error, 0.02);
      this.set(this.values.map((value, index) => value + Math.max(-0.2, Math.min(0.2, change[index] ?? 0))));
    }
  }
}

/** Those vertices that lie farthest out in one of many directions. */
function outermost(geometry: BufferGeometry): Vector3[] {
  const places = geometry.getAttribute("position");
  const found = new Set<number>();
  for (let k = 0; k < 60; k += 1) {
    const z = 1 - (2 * k + 1) / 60; // evenly over the sphere, by the golden angle
    const [x, y] = [Math.cos(2.39996 * k) * Math.sqrt(1 - z * z), Math.sin(2.39996 * k) * Math.sqrt(1 - z * z)];
    let best = 0;
    let most = -Infinity;
    for (let j = 0; j < places.count; j += 1) {
      const out = x * places.getX(j) + y * places.getY(j) + z * places.getZ(j);
      if (out > most) [best, most] = [j, out];
    }
    found.add(best);
  }
  return [...found].map((j) => new Vector3().fromBufferAttribute(places, j));
}

function turnBetween(from: Quaternion, to: Quaternion): [number, number, number] {
  const q = to.clone().multiply(from.clone().invert());
  const sign = q.w < 0 ? -1 : 1;
  return [2 * sign * q.x, 2 * sign * q.y, 2 * sign * q.z];
}

/** Jᵀ (J Jᵀ + d² I)⁻¹ e, with J's columns and e of length 6. */
export function dampedSolution(columns: number[][], error: number[], damping: number): number[] {
  const n = error.length;
  const rows = Array.from({ length: n }, (_, i) =>
    Array.from({ length: n + 1 }, (_, j) =>
      j === n
        ? (error[i] ?? 0)
        : columns.reduce((sum, column) => sum + (column[i] ?? 0) * (column[j] ?? 0), 0) + (i === j ? damping * damping : 0),
    ),
  );
  for (let i = 0; i < n; i += 1) {
    // symmetric and positive definite: no pivots are needed
    const row = rows[i] ?? [];
    const pivot = row[i] ?? 1;
    for (let j = i; j <= n; j += 1) row[j] = (row[j] ?? 0) / pivot;
    rows.forEach((other, k) => {
      const factor = other[i] ?? 0;
      if (k !== i && factor !== 0) for (let j = i; j <= n; j += 1) other[j] = (other[j] ?? 0) - factor * (row[j] ?? 0);
    });
  }
  return columns.map((column) => column.reduce((sum, value, i) => sum + value * (rows[i]?.[n] ?? 0), 0));
}
