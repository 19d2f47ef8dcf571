// The robot and what is around it in three dimensions. Works without WebGL by drawing nothing and saying so.
import {
  AmbientLight, BoxGeometry, CapsuleGeometry, CatmullRomCurve3, Color, ConeGeometry, CylinderGeometry, DirectionalLight,
  DoubleSide, GridHelper, Group, HemisphereLight, Mesh, MeshBasicMaterial, MeshStandardMaterial, Object3D, PerspectiveCamera,
  PlaneGeometry, Quaternion, Scene, SphereGeometry, TorusGeometry, TubeGeometry, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { ConvexGeometry } from "three/examples/jsm/geometries/ConvexGeometry.js";
import { Arm } from "./arm.ts";
import type { Axes, Frame, Vector } from "./hand.ts";
import type { FrameTold, Obstacle, Quaternion as Q, RobotTold, SceneTold } from "./wire.ts";

const LEAD = 0.22; // s: how far ahead of the prediction the ghost shows a key's wish, at once
const QUICK = 0.05; // s
const SPEED = 0.25; // m/s of a full share, where no command says more
const OLD = 1.0; // s
const ARROW = 0.7; // s: an arrow's length is the way of so long
const PACES: [number, number][] = [[0, 2], [0.03, 1], [0.08, 0.75], [0.16, 0.5]]; // s between frames, pixel ratio

export class View3D {
  private readonly renderer: WebGLRenderer | null;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(42, 1, 0.02, 20);
  private readonly controls: OrbitControls;
  private readonly confirmed = new Arm("#c9d1da", 1);
  private readonly ghost = new Arm("#6db9ee", 0.42);
  private readonly obstacles = new Group();
  private readonly targets = new Group();
  private readonly path = new Mesh(undefined, new MeshBasicMaterial({ color: "#6db9ee", depthTest: false, transparent: true }));
  private readonly stopRing = new Mesh(new TorusGeometry(0.018, 0.004, 8, 24), new MeshBasicMaterial({ color: "#6db9ee", depthTest: false, transparent: true }));
  private readonly plan = new Group();
  private readonly asked = new Arrow(0.003);
  private readonly done = new Arrow(0.006);
  private readonly distance = new Mesh(new CylinderGeometry(0.003, 0.003, 1, 8), new MeshBasicMaterial({ color: "#e8a317" }));
  private readonly shell = new Mesh(new SphereGeometry(1, 40, 24), new MeshBasicMaterial({ color: "#e8a317", transparent: true, opacity: 0.14, depthWrite: false, side: DoubleSide }));
  private grid = new GridHelper(2.4, 24);
  private told: FrameTold | null = null;
  private pathTold: Vector[] = [];
  private world: SceneTold | null = null;
  private robot: RobotTold | null = null;
  private readonly offset = new Vector3();
  private wish: { axes: Axes; frame: Frame; scale: number } | null = null;
  private toolKnown = false;
  private readonly fresh = new Color();
  private readonly old = new Color();
  private lastMs = 0;
  private calledMs = 0;
  private changedMs = 0;
  private slow = 0;
  private level = 0;

  constructor(private readonly canvas: HTMLCanvasElement, private readonly labels: Labels) {
    this.renderer = newRenderer(canvas);
    this.camera.up.set(0, 0, 1);
    this.camera.position.set(0.5, -1.5, 0.85); // from the robot's right: its reach is not behind itself
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.target.set(0.26, 0, 0.28);
    this.controls.enablePan = false;
    this.controls.minDistance = 0.5;
    this.controls.maxDistance = 4;
    this.controls.maxPolarAngle = 1.5;
    this.grid.rotateX(Math.PI / 2);
    const sun = new DirectionalLight("#ffffff", 2.2);
    sun.position.set(1, -2, 3);
    this.scene.add(new AmbientLight("#ffffff", 0.5), new HemisphereLight("#ffffff", "#777788", 1.1), sun, this.grid);
    this.scene.add(this.confirmed.group, this.ghost.group, this.obstacles, this.targets, this.plan);
    this.plan.add(this.path, this.stopRing);
    this.scene.add(this.asked.group, this.done.group, this.distance, this.shell);
    this.plan.renderOrder = 4; // never hidden: where it will go is what people drive by
    for (const each of [this.path, this.stopRing, this.distance, this.shell]) each.visible = false;
    this.theme();
    requestAnimationFrame((ms) => this.draw(ms));
  }

  get works(): boolean {
    return this.renderer !== null;
  }

  hear(told: FrameTold): void {
    this.told = told;
  }

  async robotIs(told: RobotTold): Promise<void> {
    this.robot = told;
    this.toolKnown = false;
    if (!told.model || !this.renderer) return;
    try {
      await this.confirmed.load(told.joints);
      this.ghost.copy(this.confirmed, told.joints);
    } catch {
      this.labels.say("robot", "this robot has no drawing: its tool is shown alone", "confirmed", null);
    }
  }

  sceneIs(told: SceneTold): void {
    this.world = told;
    clear(this.obstacles);
    clear(this.targets);
    for (const each of told.obstacles) this.obstacles.add(obstacleMesh(each));
    told.targets.forEach((at) => {
      const ring = new Mesh(new TorusGeometry(0.03, 0.004, 8, 32), new MeshBasicMaterial({ color: css("--go") }));
      ring.position.set(...at);
      this.targets.add(ring);
    });
  }

  wants(axes: Axes | null, frame: Frame, scale: number): void {
    this.wish = axes ? { axes, frame, scale } : null;
  }

  /** Orientation of the view in base: x to the right, y ahead on the level, z up. */
  get view(): Q {
    const ahead = this.controls.target.clone().sub(this.camera.position);
    const yaw = Math.atan2(-ahead.x, ahead.y);
    return [Math.cos(yaw / 2), 0, 0, Math.sin(yaw / 2)];
  }

  theme(): void {
    this.scene.background = new Color(css("--ground"));
    for (const each of [this.path, this.stopRing]) each.material.color.set(css("--plan"));
    this.ghost.material.color.set(css("--plan"));
    this.fresh.set(css("--arm"));
    this.old.set(css("--line"));
    this.asked.colour(css("--dim"));
    this.done.colour(css("--text"));
    for (const each of [this.distance, this.shell]) each.material.color.set(css("--slow"));
    const at = this.scene.children.indexOf(this.grid);
    if (at >= 0) this.scene.remove(this.grid);
    this.grid = new GridHelper(2.4, 24, css("--line"), css("--line"));
    this.grid.rotateX(Math.PI / 2);
    this.scene.add(this.grid);
    if (this.world) this.sceneIs(this.world);
  }

  private draw(ms: number): void {
    requestAnimationFrame((next) => this.draw(next));
    const since = (ms - this.calledMs) / 1000;
    this.calledMs = ms;
    this.pace(since, ms);
    const dt = (ms - this.lastMs) / 1000;
    if (dt < PACES[this.level]![0]) return;
    this.lastMs = ms;
    this.update(Math.min(0.25, dt));
    if (this.renderer) {
      this.resize(this.renderer);
      this.renderer.render(this.scene, this.camera);
    }
  }

  /** A slow renderer must not starve what listens to keys: it draws less often, and coarser. */
  private pace(since: number, ms: number): void {
    if (document.hidden || since > 1) return;
    this.slow += 0.08 * (since - this.slow);
    if (this.slow > 0.036 && this.level < PACES.length - 1 && ms - this.changedMs > 1200) {
      this.level += 1;
      this.changedMs = ms;
      this.slow = 0.02;
    }
  }

  private resize(renderer: WebGLRenderer): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const ratio = Math.min(PACES[this.level]![1], devicePixelRatio);
    if (this.canvas.width === Math.floor(width * ratio) && this.canvas.height === Math.floor(height * ratio)) return;
    renderer.setPixelRatio(ratio);
    renderer.setSize(width, height, false);
    this.camera.aspect = width / Math.max(1, height);
    this.camera.fov = this.camera.aspect < 1 ? 58 : 42;
    this.camera.updateProjectionMatrix();
  }

  private update(dt: number): void {
    const { told } = this;
    const state = told?.state;
    if (!told || !state) return;
    const age = told.age ?? 99;
    const position = new Vector3(...state.position);
    const orientation = quaternion(state.orientation);
    this.updateConfirmed(state.joints, { position, orientation }, age, dt);
    const report = told.report;
    const live = !told.locked && report !== null && age < OLD;
    this.ghost.group.visible = live;
    if (report && live) {
      const velocity = this.wishedVelocity(orientation);
      this.offset.lerp(velocity.multiplyScalar(LEAD), 1 - Math.exp(-dt / QUICK));
      const at = new Vector3(...report.predicted).add(this.offset);
      this.ghost.reach({ position: at, orientation: quaternion(report.predicted_orientation) });
      const apart = Math.max(0, ...this.ghost.values.map((q, k) => Math.abs(q - (this.confirmed.values[k] ?? q))));
      this.ghost.material.opacity = 0.5 * Math.min(1, apart / 0.03); // where they are one, the confirmed one is seen
      this.ghost.group.visible = apart > 0.002;
      this.labels.say("ghost", this.offset.length() > 0.004 ? "predicted, where it will be" : "", "predicted", this.project(at, 0, -44));
      this.asked.point(position, new Vector3(...report.desired), live);
      this.done.point(position, new Vector3(...report.filtered), live);
    } else {
      this.asked.point(position, new Vector3(), false);
      this.done.point(position, new Vector3(), false);
      this.labels.say("ghost", "", "predicted", null);
    }
    const base = new Vector3(0, 0, 0);
    this.labels.say("confirmed", told.age === null ? "" : `as it was ${age.toFixed(2)} s ago`, "confirmed", this.project(base, 0, 34));
    this.updatePath(told);
    this.updateTargets(told);
    this.updateDanger(told, position);
  }

  private updateConfirmed(joints: number[], pose: { position: Vector3; orientation: Quaternion }, age: number, dt: number): void {
    this.confirmed.colour(this.fresh.clone().lerp(this.old, Math.min(0.8, Math.max(0, (age - 0.25) / OLD))));
    if (!this.confirmed.isLoaded || joints.length === 0) return;
    if (!this.toolKnown) {
      this.confirmed.learnTool(joints, pose);
      this.ghost.copyTool(this.confirmed);
      this.ghost.set(joints);
      this.toolKnown = true;
    }
    const share = 1 - Math.exp(-dt / QUICK);
    this.confirmed.set(joints.map((value, k) => {
      const now = this.confirmed.values[k] ?? value;
      return now + share * (value - now);
    }));
  }

  private wishedVelocity(tool: Quaternion): Vector3 {
    if (!this.wish) return new Vector3();
    const { axes, frame, scale } = this.wish;
    const velocity = new Vector3(...axes.linear).clampLength(0, 1).multiplyScalar(SPEED * scale);
    if (frame === "tool") return velocity.applyQuaternion(tool);
    return frame === "view" ? velocity.applyQuaternion(quaternion(this.view)) : velocity;
  }

  private updatePath(told: FrameTold): void {
    if (told.path === this.pathTold) return;
    this.pathTold = told.path;
    const points = told.path.map((at) => new Vector3(...at)).filter((at, k, all) => k === 0 || at.distanceTo(all[k - 1] ?? at) > 1e-4);
    const end = points.at(-1);
    const length = points.reduce((sum, at, k) => sum + (k ? at.distanceTo(points[k - 1] ?? at) : 0), 0);
    const shown = end !== undefined && points.length > 1 && length > 0.004;
    this.path.visible = this.stopRing.visible = shown;
    if (shown) {
      this.path.geometry.dispose();
      this.path.geometry = new TubeGeometry(new CatmullRomCurve3(points), 4 * points.length, 0.005, 6);
      this.stopRing.position.copy(end);
    }
    this.stopRing.quaternion.copy(this.camera.quaternion);
  }

  private updateTargets(told: FrameTold): void {
    const next = told.report?.target_index ?? 0;
    this.targets.children.forEach((ring, k) => {
      ring.quaternion.copy(this.camera.quaternion);
      ring.visible = k === next;
    });
    const ring = this.targets.children[next];
    const count = this.targets.children.length;
    this.labels.say("target", ring ? `target ${next + 1} of ${count}` : count ? "all targets reached" : "", "target", ring ? this.project(ring.position, 0, -46) : null);
  }

  /** What binds: a shell as wide as what is kept, and a line with the distance. */
  private updateDanger(told: FrameTold, tool: Vector3): void {
    const id = told.guard?.obstacle || (told.holds ? told.report?.binding : "") || "";
    const mesh = this.obstacles.children.find((each) => each.name === id);
    this.shell.visible = this.distance.visible = mesh !== undefined;
    if (!mesh || !told.report || !told.state) {
      this.labels.say("distance", "", "distance", null);
      this.labels.say("keeps", "", "margin", null);
      return;
    }
    const keeps = (this.robot?.radius ?? 0) + told.report.inflation + told.report.sigma;
    const radius = boundingRadius(mesh);
    this.shell.position.copy(mesh.position);
    this.shell.scale.setScalar(radius + keeps);
    const from = (told.guard && this.confirmed.linkPoint(told.guard.part)) || tool;
    const towards = from.clone().sub(mesh.position);
    const to = mesh.position.clone().add(towards.setLength(Math.min(radius, towards.length())));
    this.distance.position.copy(from).lerp(to, 0.5);
    this.distance.scale.y = Math.max(1e-4, from.distanceTo(to));
    this.distance.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), to.clone().sub(from).normalize());
    const measured = told.guard ? told.guard.distance : told.state.clearance;
    this.labels.say("distance", `${(measured * 1000).toFixed(0)} mm`, "distance", this.project(this.distance.position, 8, 0));
    this.labels.say("keeps", `${id} · keeps ${(keeps * 1000).toFixed(0)} mm now`, "margin", this.project(mesh.position, 0, 60));
  }

  private project(at: Vector3, dx: number, dy: number): [number, number] | null {
    if (!this.renderer) return null;
    const seen = at.clone().project(this.camera);
    if (seen.z > 1) return null;
    return [((seen.x + 1) / 2) * this.canvas.clientWidth + dx, ((1 - seen.y) / 2) * this.canvas.clientHeight + dy];
  }
}

/** Words that stay beside things in the scene. */
export class Labels {
  private readonly spans = new Map<string, HTMLSpanElement>();

  constructor(private readonly parent: HTMLElement) {}

  say(name: string, text: string, kind: string, at: [number, number] | null): void {
    let span = this.spans.get(name);
    if (!span) {
      span = document.createElement("span");
      this.parent.append(span);
      this.spans.set(name, span);
    }
    span.className = kind;
    span.hidden = !text || !at;
    if (!text || !at) return;
    if (span.textContent !== text) span.textContent = text;
    const x = Math.max(4, Math.min(this.parent.parentElement!.clientWidth - span.offsetWidth - 4, at[0] - span.offsetWidth / 2));
    span.style.transform = `translate(${x.toFixed(0)}px, ${at[1].toFixed(0)}px)`;
  }
}

class Arrow {
  readonly group = new Group();
  private readonly material = new MeshBasicMaterial({ depthTest: false, transparent: true });
  private readonly shaft: Mesh;
  private readonly head: Mesh;

  constructor(radius: number) {
    this.shaft = new Mesh(new CylinderGeometry(radius, radius, 1, 10), this.material);
    this.head = new Mesh(new ConeGeometry(2.6 * radius, 6 * radius, 14), this.material);
    this.group.add(this.shaft, this.head);
    this.group.renderOrder = 3;
  }

  colour(colour: string): void {
    this.material.color.set(colour);
  }

  point(from: Vector3, velocity: Vector3, shown: boolean): void {
    const length = ARROW * velocity.length();
    this.group.visible = shown && length > 0.004;
    if (!this.group.visible) return;
    this.group.position.copy(from);
    this.group.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), velocity.clone().normalize());
    this.shaft.scale.y = length;
    this.shaft.position.y = length / 2;
    this.head.position.y = length;
  }
}

function obstacleMesh(obstacle: Obstacle): Object3D {
  const { shape } = obstacle;
  const material = new MeshStandardMaterial({ color: "#8b949e", roughness: 0.8 });
  let geometry;
  if (shape.kind === "box") geometry = new BoxGeometry(...(shape.half_extents ?? [0.1, 0.1, 0.1]).map((half) => 2 * half));
  else if (shape.kind === "capsule") {
    geometry = new CapsuleGeometry(shape.radius ?? 0.05, 2 * (shape.half_length ?? 0.1), 8, 20).rotateX(Math.PI / 2);
  } else if (shape.kind === "mesh") geometry = new ConvexGeometry((shape.vertices ?? []).map((at) => new Vector3(...at)));
  else if (shape.kind === "plane") geometry = new PlaneGeometry(2.4, 2.4);
  else geometry = new SphereGeometry(shape.radius ?? 0.05, 36, 24);
  if (shape.kind === "plane") Object.assign(material, { transparent: true, opacity: 0.35, side: DoubleSide });
  const mesh = new Mesh(geometry, material);
  mesh.name = obstacle.id;
  mesh.position.set(...obstacle.position);
  mesh.quaternion.copy(quaternion(obstacle.orientation));
  return mesh;
}

function boundingRadius(object: Object3D): number {
  if (!(object instanceof Mesh)) return 0.05;
  const geometry = object.geometry as { boundingSphere: { radius: number } | null; computeBoundingSphere(): void };
  if (!geometry.boundingSphere) geometry.computeBoundingSphere();
  return Math.min(1, geometry.boundingSphere?.radius ?? 0.05);
}

function clear(group: Group): void {
  group.traverse((each) => {
    if (each instanceof Mesh) each.geometry.dispose();
  });
  group.clear();
}

function quaternion([w, x, y, z]: Q): Quaternion {
  return new Quaternion(x, y, z, w);
}

function newRenderer(canvas: HTMLCanvasElement): WebGLRenderer | null {
  try {
    return new WebGLRenderer({ canvas, antialias: true, powerPreference: "high-performance" });
  } catch {
    return null;
  }
}

export function css(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}
