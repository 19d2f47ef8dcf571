// Obstacles' shapes: where their surface is nearest to a point, and the corners that show their outline.
import { Matrix4, Mesh, Quaternion, Triangle, Vector3 } from "three";
import { ConvexGeometry } from "three/examples/jsm/geometries/ConvexGeometry.js";
import type { Obstacle, Quaternion as Q, SceneTold, Shape } from "./told.ts";

const PLANE_HALF = 1.2; // m of a plane that are drawn
const HEARD_FOR = 1.5; // s: scenes come once a second

/** An obstacle where it is by now. */
export class Thing {
  readonly position = new Vector3();
  readonly orientation: Quaternion;
  readonly corners: Vector3[];
  private readonly triangles: Triangle[] = [];
  /** Whether its place is measured or follows from one that is not old; else it may be elsewhere. */
  known = true;

  constructor(readonly told: Obstacle) {
    this.position.set(...told.position);
    this.orientation = quaternion(told.orientation);
    this.corners = cornersOf(told.shape);
    if (told.shape.kind === "mesh") this.triangles = trianglesOf(this.corners);
  }

  get id(): string {
    return this.told.id;
  }

  get shape(): Shape {
    return this.told.shape;
  }

  /** To where it is `seconds` after the scene was sampled: straight on, but never off the path of one that shuttles. */
  goTo(seconds: number): void {
    const { position, velocity, path } = this.told;
    const moves = velocity.some((v) => v !== 0) || (path?.length ?? 0) > 0;
    this.known = !moves || seconds <= HEARD_FOR;
    const ahead = Math.max(0, Math.min(HEARD_FOR, seconds));
    this.position.set(...position).addScaledVector(new Vector3(...velocity), ahead);
    if (!path?.length) return;
    const points = path.map((at) => new Vector3(...at));
    const low = points.reduce((all, at) => all.min(at), new Vector3(1e9, 1e9, 1e9));
    const high = points.reduce((all, at) => all.max(at), new Vector3(-1e9, -1e9, -1e9));
    this.position.clamp(low, high);
  }

  /** The point of its surface that is nearest to a point outside, and how far that is (m). */
  nearest(point: Vector3): { at: Vector3; distance: number } {
    const inverse = this.orientation.clone().invert();
    const own = point.clone().sub(this.position).applyQuaternion(inverse);
    const at = this.nearestOwn(own);
    const distance = at.distanceTo(own);
    return { at: at.applyQuaternion(this.orientation).add(this.position), distance };
  }

  private nearestOwn(own: Vector3): Vector3 {
    const { kind, radius = 0.05, half_length = 0.1, half_extents = [0.1, 0.1, 0.1] } = this.shape;
    if (kind === "plane") return new Vector3(own.x, own.y, 0);
    if (kind === "box") return own.clone().clamp(new Vector3(...half_extents).negate(), new Vector3(...half_extents));
    if (kind === "mesh") return this.nearestOfTriangles(own);
    const middle = new Vector3(0, 0, kind === "capsule" ? Math.max(-half_length, Math.min(half_length, own.z)) : 0);
    const out = own.clone().sub(middle);
    return middle.add(out.lengthSq() > 0 ? out.setLength(radius) : new Vector3(radius, 0, 0));
  }

  private nearestOfTriangles(own: Vector3): Vector3 {
    let best = new Vector3();
    let least = Infinity;
    const found = new Vector3();
    for (const triangle of this.triangles) {
      triangle.closestPointToPoint(own, found);
      if (found.distanceToSquared(own) >= least) continue;
      least = found.distanceToSquared(own);
      best = found.clone();
    }
    return best;
  }

  /** The corners of its outline in base; those of round shapes lie a radius further in (`round`). */
  get outline(): Vector3[] {
    const place = new Matrix4().compose(this.position, this.orientation, new Vector3(1, 1, 1));
    return this.corners.map((corner) => corner.clone().applyMatrix4(place));
  }

  /** What round shapes have around their corners (m). */
  get round(): number {
    return this.shape.kind === "sphere" || this.shape.kind === "capsule" ? (this.shape.radius ?? 0.05) : 0;
  }
}

export function thingsOf(scene: SceneTold): Thing[] {
  return scene.obstacles.map((each) => new Thing(each));
}

function cornersOf({ kind, half_length = 0.1, half_extents = [0.1, 0.1, 0.1], vertices = [] }: Shape): Vector3[] {
  if (kind === "mesh") return vertices.map((at) => new Vector3(...at));
  if (kind === "capsule") return [new Vector3(0, 0, -half_length), new Vector3(0, 0, half_length)];
  if (kind === "sphere") return [new Vector3()];
  const [x, y, z] = kind === "plane" ? [PLANE_HALF, PLANE_HALF, 0] : half_extents;
  const heights = z > 0 ? [-z, z] : [0];
  return heights.flatMap((up) => [new Vector3(-x, -y, up), new Vector3(x, -y, up), new Vector3(x, y, up), new Vector3(-x, y, up)]);
}

function trianglesOf(corners: Vector3[]): Triangle[] {
  const places = new Mesh(new ConvexGeometry(corners)).geometry.getAttribute("position");
  const found: Triangle[] = [];
  for (let k = 0; k + 2 < places.count; k += 3) {
    const [a, b, c] = [0, 1, 2].map((j) => new Vector3().fromBufferAttribute(places, k + j));
    if (a && b && c) found.push(new Triangle(a, b, c));
  }
  return found;
}

export function quaternion([w, x, y, z]: Q): Quaternion {
  return new Quaternion(x, y, z, w);
}
