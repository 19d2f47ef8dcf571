// The world in three dimensions.
import {
  AmbientLight,
  BoxGeometry,
  BufferAttribute,
  BufferGeometry,
  CapsuleGeometry,
  CatmullRomCurve3,
  Color,
  ConeGeometry,
  CylinderGeometry,
  DirectionalLight,
  DoubleSide,
  GridHelper,
  Group,
  HemisphereLight,
  Mesh,
  MeshBasicMaterial,
  MeshStandardMaterial,
  PerspectiveCamera,
  PlaneGeometry,
  Scene,
  ShaderMaterial,
  SphereGeometry,
  TorusGeometry,
  TubeGeometry,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { ConvexGeometry } from "three/examples/jsm/geometries/ConvexGeometry.js";
import { RoundedBoxGeometry } from "three/examples/jsm/geometries/RoundedBoxGeometry.js";
import type { Labels } from "./labels.ts";
import type { Thing } from "./shapes.ts";
import type { Quaternion as Q } from "./told.ts";
import { css, type View } from "./view.ts";
import type { Danger, World } from "./world.ts";

const ARROW = 0.7; // s: an arrow's length is the way of so long
const OLD = 1.0; // s
const UP = new Vector3(0, 1, 0);

export class View3D implements View {
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(42, 1, 0.02, 20);
  private readonly controls: OrbitControls;
  private readonly obstacles = new Group();
  private readonly targets = new Group();
  private readonly shells = new Group();
  private readonly path = flat(undefined);
  private readonly halo = flat(undefined, 0.75, false);
  private readonly steps = new Group();
  private readonly stopRing = flat(new TorusGeometry(0.022, 0.005, 8, 28));
  private readonly ghostTool = flat(new TorusGeometry(0.03, 0.003, 8, 24));
  private readonly trail = flat(new BufferGeometry(), 0.6);
  private readonly sphere = new Mesh(new SphereGeometry(1, 32, 20), rimmed(0.05, 0.55));
  private readonly asked = new Arrow(0.0036);
  private readonly done = new Arrow(0.0065);
  private readonly line = new Mesh(new CylinderGeometry(0.0035, 0.0035, 1, 8), new MeshBasicMaterial({ color: "#e8a317" }));
  private readonly dot = new SphereGeometry(0.0068, 12, 8);
  private grid = new GridHelper(2.4, 24);
  private finest = 2;
  private scenes = -1;
  private models = -1;
  private drawnPath: unknown = null;
  private readonly fresh = new Color();
  private readonly old = new Color();

  /** Raises where there is no WebGL. */
  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly labels: Labels,
    private readonly world: World,
  ) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, powerPreference: "high-performance" });
    this.camera.up.set(0, 0, 1);
    this.camera.position.set(0.52, -1.22, 0.72); // from the robot's right: its reach is not behind itself
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.target.set(0.27, 0, 0.25);
    this.controls.enablePan = false;
    this.controls.minDistance = 0.5;
    this.controls.maxDistance = 4;
    this.controls.maxPolarAngle = 1.5;
    this.controls.update(); // so that the first drag begins from what is seen
    this.line.material.depthTest = false;
    this.line.renderOrder = 4;
    const sun = new DirectionalLight("#ffffff", 2.2);
    sun.position.set(1, -2, 3);
    this.scene.add(new AmbientLight("#ffffff", 0.5), new HemisphereLight("#ffffff", "#777788", 1.1), sun, this.grid);
    this.scene.add(world.confirmed.group, world.ghost.group, this.obstacles, this.targets, this.shells, this.sphere, this.line);
    this.scene.add(this.trail, this.halo, this.path, this.steps, this.stopRing, this.ghostTool, this.asked.group, this.done.group);
    // Never hidden: where it will go is what people drive by.
    this.halo.renderOrder = 3;
    for (const each of [this.path, this.stopRing, this.ghostTool]) each.renderOrder = 4;
    this.theme();
  }

  get view(): Q {
    const ahead = this.controls.target.clone().sub(this.camera.position);
    const yaw = Math.atan2(-ahead.x, ahead.y);
    return [Math.cos(yaw / 2), 0, 0, Math.sin(yaw / 2)];
  }

  show(shown: boolean): void {
    this.canvas.hidden = !shown;
    this.controls.enabled = shown;
  }

  theme(): void {
    this.scene.background = new Color(css("--ground"));
    for (const each of [this.path, this.stopRing, this.ghostTool]) each.material.color.set(css("--plan"));
    this.world.ghost.material.color.set(css("--plan"));
    this.halo.material.color.set(css("--ground"));
    this.trail.material.color.set(css("--arm"));
    tint(this.sphere.material, css("--text"));
    this.fresh.set(css("--arm"));
    this.old.set(css("--line"));
    this.asked.colour(css("--dim"));
    this.done.colour(css("--text"));
    this.line.material.color.set(css("--slow"));
    this.scene.remove(this.grid);
    this.grid.dispose();
    this.grid = new GridHelper(2.4, 24, css("--grid"), css("--grid"));
    this.grid.rotateX(Math.PI / 2);
    this.scene.add(this.grid);
    this.scenes = -1;
  }

  draw(): void {
    this.resize();
    this.update();
    this.renderer.render(this.scene, this.camera);
    this.labels.show(this.world.words, (at) => this.project(at));
  }

  /** Fewer pixels, for who wants three dimensions though they come slowly. */
  coarsen(coarse = true): void {
    this.finest = coarse ? 0.6 : 2;
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const ratio = Math.min(this.finest, devicePixelRatio);
    if (this.canvas.width === Math.floor(width * ratio) && this.canvas.height === Math.floor(height * ratio)) return;
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / Math.max(1, height);
    const upright = this.camera.aspect < 1;
    this.camera.fov = upright ? 50 : 42;
    if (upright)
      this.camera.setViewOffset(width, height, 0.04 * width, 0.03 * height, width, height); // sticks lie below
    else this.camera.clearViewOffset();
    this.camera.updateProjectionMatrix();
  }

  private update(): void {
    const { world } = this;
    if (this.scenes !== world.scenes) this.setUp();
    if (this.models !== world.models) {
      this.models = world.models;
      this.scene.add(world.confirmed.group, world.ghost.group);
    }
    world.confirmed.colour(this.fresh.clone().lerp(this.old, Math.min(0.8, Math.max(0, (world.age - 0.25) / OLD))));
    world.ghost.group.visible = world.ghostSeen > 0 && world.ghostWhole;
    world.ghost.material.opacity = 0.5 * world.ghostSeen;
    this.ghostTool.visible = world.ghostSeen > 0 && !world.ghostWhole;
    this.ghostTool.position.copy(world.ghostAt);
    this.ghostTool.quaternion.copy(this.camera.quaternion);
    this.sphere.visible = world.tool !== null && world.radius > 0 && (world.bare || world.dangers.some((each) => each.binds));
    this.sphere.scale.setScalar(world.radius);
    if (world.tool) {
      this.sphere.position.copy(world.tool);
      this.asked.point(world.tool, world.asked);
      this.done.point(world.tool, world.done);
    }
    world.things.forEach((thing, k) => {
      const mesh = this.obstacles.children[k];
      mesh?.position.copy(thing.position);
      if (mesh instanceof Mesh) mesh.material.opacity = thing.shape.kind === "plane" ? 0.35 : thing.known ? 1 : 0.35;
    });
    this.targets.children.forEach((ring, k) => {
      ring.quaternion.copy(this.camera.quaternion);
      ring.visible = k === world.target;
    });
    this.updatePath();
    this.updateTrail();
    this.updateDangers();
  }

  private setUp(): void {
    this.scenes = this.world.scenes;
    clear(this.obstacles);
    clear(this.targets);
    for (const thing of this.world.things) this.obstacles.add(thingMesh(thing, css("--thing")));
    for (const at of this.world.targets) {
      const ring = new Mesh(new TorusGeometry(0.03, 0.004, 8, 32), new MeshBasicMaterial({ color: css("--go") }));
      ring.position.copy(at);
      this.targets.add(ring);
    }
  }

  private updatePath(): void {
    this.stopRing.quaternion.copy(this.camera.quaternion);
    const { told } = this.world;
    if (told?.path === this.drawnPath) return;
    this.drawnPath = told?.path;
    const points = this.world.path.filter((at, k, all) => k === 0 || at.distanceTo(all[k - 1] ?? at) > 1e-4);
    const end = points.at(-1);
    const shown = end !== undefined && points.length > 1;
    for (const each of [this.path, this.halo, this.steps, this.stopRing]) each.visible = shown;
    if (!shown) return;
    const curve = new CatmullRomCurve3(points);
    for (const [mesh, radius] of [
      [this.path, 0.004],
      [this.halo, 0.009],
    ] as const) {
      mesh.geometry.dispose();
      mesh.geometry = new TubeGeometry(curve, Math.min(60, 3 * points.length), radius, 6);
    }
    this.stopRing.position.copy(end);
    this.placeSteps(points);
  }

  /** A dot for each step of the plan: where they are close together it goes slowly. */
  private placeSteps(points: Vector3[]): void {
    while (this.steps.children.length < points.length) {
      const dot = new Mesh(this.dot, this.path.material);
      dot.renderOrder = 4;
      this.steps.add(dot);
    }
    this.steps.children.forEach((dot, k) => {
      const at = points[k];
      dot.visible = at !== undefined && k < points.length - 1;
      if (at) dot.position.copy(at);
    });
  }

  /** A ribbon that faces the eye: lines of WebGL are one pixel wide. */
  private updateTrail(): void {
    const points = this.world.trail;
    this.trail.visible = points.length > 1;
    if (!this.trail.visible) return;
    const places = new Float32Array(points.length * 6);
    const way = new Vector3();
    points.forEach(({ at }, k) => {
      way.copy((points[k + 1] ?? points[k])?.at ?? at).sub((points[k - 1] ?? points[k])?.at ?? at);
      const side = this.camera.position
        .clone()
        .sub(at)
        .cross(way)
        .setLength(0.0022 * (0.25 + (0.75 * k) / points.length));
      places.set([at.x + side.x, at.y + side.y, at.z + side.z, at.x - side.x, at.y - side.y, at.z - side.z], 6 * k);
    });
    const faces: number[] = [];
    for (let k = 0; k + 1 < points.length; k += 1) faces.push(2 * k, 2 * k + 1, 2 * k + 2, 2 * k + 1, 2 * k + 3, 2 * k + 2);
    this.trail.geometry.dispose();
    this.trail.geometry = new BufferGeometry();
    this.trail.geometry.setAttribute("position", new BufferAttribute(places, 3));
    this.trail.geometry.setIndex(faces);
  }

  private updateDangers(): void {
    const { dangers } = this.world;
    const wanted = new Set(dangers.map((each) => each.thing.id));
    for (const shell of [...this.shells.children]) if (!wanted.has(shell.name)) this.shells.remove(drop(shell));
    for (const danger of dangers) this.updateShell(danger);
    const first = dangers[0];
    this.line.visible = first?.binds === true;
    if (!first?.binds) return;
    this.line.position.copy(first.from).lerp(first.to, 0.5);
    this.line.scale.y = Math.max(1e-4, first.from.distanceTo(first.to));
    this.line.quaternion.setFromUnitVectors(UP, first.to.clone().sub(first.from).normalize());
  }

  private updateShell({ thing, keeps, binds }: Danger): void {
    const key = Math.round(keeps * 500); // made anew where it is 2 mm wider
    let shell = this.shells.children.find((each) => each.name === thing.id);
    if (shell?.userData.key !== key) {
      if (shell) this.shells.remove(drop(shell));
      const even = thing.shape.kind === "plane"; // it has no rim
      const material = even
        ? new MeshBasicMaterial({ color: css("--slow"), transparent: true, opacity: 0.04, depthWrite: false, side: DoubleSide })
        : tint(rimmed(0, 0), css("--slow"));
      shell = new Mesh(shellGeometry(thing, Math.max(0.001, keeps)), material);
      shell.name = thing.id;
      shell.userData.key = key;
      this.shells.add(shell);
    }
    if (!(shell instanceof Mesh)) return;
    if (shell.material instanceof ShaderMaterial) {
      shell.material.uniforms.inner = { value: binds ? 0.16 : 0.05 };
      shell.material.uniforms.rim = { value: binds ? 0.95 : 0.4 };
    } else if (shell.material instanceof MeshBasicMaterial) shell.material.opacity = binds ? 0.2 : 0.03; // always near
    shell.position.copy(thing.position);
    shell.quaternion.copy(thing.orientation);
  }

  private project(at: Vector3): [number, number] | null {
    const seen = at.clone().project(this.camera);
    if (seen.z > 1) return null;
    return [((seen.x + 1) / 2) * this.canvas.clientWidth, ((1 - seen.y) / 2) * this.canvas.clientHeight];
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

  point(from: Vector3, velocity: Vector3): void {
    const length = ARROW * velocity.length();
    this.group.visible = length > 0.004;
    if (!this.group.visible) return;
    this.group.position.copy(from);
    this.group.quaternion.setFromUnitVectors(UP, velocity.clone().normalize());
    this.shaft.scale.y = length;
    this.shaft.position.y = length / 2;
    this.head.position.y = length;
  }
}

/** A skin that is seen at its rim, where it is looked at from the side: what it holds stays in sight. */
function rimmed(inner: number, rim: number): ShaderMaterial {
  return new ShaderMaterial({
    uniforms: { colour: { value: new Color() }, inner: { value: inner }, rim: { value: rim } },
    vertexShader: `varying vec3 across; varying vec3 towards;
      void main() {
        vec4 at = modelViewMatrix * vec4(position, 1.0);
        across = normalMatrix * normal;
        towards = -at.xyz;
        gl_Position = projectionMatrix * at;
      }`,
    fragmentShader: `uniform vec3 colour; uniform float inner; uniform float rim; varying vec3 across; varying vec3 towards;
      void main() {
        float side = 1.0 - abs(dot(normalize(across), normalize(towards)));
        gl_FragColor = vec4(colour, inner + (rim - inner) * smoothstep(0.45, 0.95, side));
        #include <colorspace_fragment>
      }`,
    transparent: true,
    depthWrite: false,
  });
}

function tint(material: ShaderMaterial, colour: string): ShaderMaterial {
  (material.uniforms.colour?.value as Color | undefined)?.set(colour);
  return material;
}

/** Of one colour everywhere; `tested`: hidden by what is before it. */
function flat(geometry: BufferGeometry | undefined, opacity = 1, tested = opacity < 1): Mesh<BufferGeometry, MeshBasicMaterial> {
  const mesh = new Mesh(geometry, new MeshBasicMaterial({ depthTest: tested, transparent: true, opacity, side: DoubleSide }));
  mesh.visible = false;
  mesh.frustumCulled = false;
  return mesh;
}

function thingMesh(thing: Thing, colour: string): Mesh {
  const plane = thing.shape.kind === "plane";
  const material = new MeshStandardMaterial({ color: colour, roughness: 0.8, transparent: true, side: plane ? DoubleSide : undefined });
  const mesh = new Mesh(shellGeometry(thing, 0), material);
  mesh.quaternion.copy(thing.orientation);
  mesh.name = thing.id;
  return mesh;
}

/** The shape with `more` around it (m), in its own frame. */
function shellGeometry(thing: Thing, more: number): BufferGeometry {
  const { kind, radius = 0.05, half_length = 0.1, half_extents = [0.1, 0.1, 0.1] } = thing.shape;
  if (kind === "capsule") return new CapsuleGeometry(radius + more, 2 * half_length, 8, 20).rotateX(Math.PI / 2);
  if (kind === "plane") return new PlaneGeometry(2.4, 2.4).translate(0, 0, more);
  if (kind === "sphere") return new SphereGeometry(radius + more, 36, 24);
  if (kind === "mesh") return offset(new ConvexGeometry(thing.corners), more);
  const [x, y, z] = half_extents.map((half) => 2 * (half + more)) as [number, number, number];
  return more > 0 ? new RoundedBoxGeometry(x, y, z, 3, more) : new BoxGeometry(x, y, z);
}

/** Every face out by `more`: the faces of what is kept; its rounded edges are left open. */
function offset(geometry: BufferGeometry, more: number): BufferGeometry {
  const places = geometry.getAttribute("position");
  const normals = geometry.getAttribute("normal");
  for (let k = 0; k < places.count; k += 1)
    places.setXYZ(
      k,
      places.getX(k) + more * normals.getX(k),
      places.getY(k) + more * normals.getY(k),
      places.getZ(k) + more * normals.getZ(k),
    );
  return geometry;
}

function drop<T>(object: T): T {
  if (object instanceof Mesh) {
    object.geometry.dispose();
    object.material.dispose();
  }
  return object;
}

function clear(group: Group): void {
  group.traverse(drop);
  group.clear();
}
