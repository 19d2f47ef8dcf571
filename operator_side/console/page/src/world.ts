// What is to be drawn, whoever draws it: arms, arrows, path, trail, obstacles where they are by now, and what binds.
import { Quaternion, Vector3 } from "three";
import { Arm } from "./arm.ts";
import type { Axes, Frame } from "./hand.ts";
import { quaternion, type Thing, thingsOf } from "./shapes.ts";
import { SPEED, TURN_SPEED } from "./step.ts";
import type { FrameTold, Quaternion as Q, RobotTold, SceneTold } from "./told.ts";

const LEAD = 0.22; // s: how far ahead of the prediction the ghost shows a key's wish, at once
const QUICK = 0.05; // s
const OLD = 1.0; // s
const TRAIL_S = 12;
const NEAR = 0.25; // m: the way of a second at full speed; what is farther than this beyond its margin cannot bind
const MOST_SHELLS = 6;
const SEEN = 0.004; // m: a shorter path is none
const WORTH_A_WORD = 0.03; // m: a committed path that is shorter ends where it begins

/** An obstacle that may bind: how much it keeps, and the line to it. */
export interface Danger {
  thing: Thing;
  keeps: number;
  binds: boolean;
  from: Vector3;
  to: Vector3;
}

/** A word beside a thing in the scene. */
export interface Word {
  name: string;
  text: string;
  kind: string;
  at: Vector3;
  dx: number;
  dy: number;
}

export class World {
  told: FrameTold | null = null;
  robot: RobotTold | null = null;
  readonly confirmed = new Arm("#c9d1da", 1);
  readonly ghost = new Arm("#6db9ee", 0.42);
  things: Thing[] = [];
  targets: Vector3[] = [];
  target = -1;
  /** Counts what is around it, and the arms: who draws makes them anew. */
  scenes = 0;
  models = 0;
  /** Of the picture that is drawn (s): since it came, and half a round trip. */
  age = 0;
  live = false;
  ghostSeen = 0;
  /** Whether the ghost is drawn as an arm: one was found whose tool is where it is predicted. */
  ghostWhole = false;
  tool: Vector3 | null = null;
  radius = 0;
  asked = new Vector3();
  done = new Vector3();
  path: Vector3[] = [];
  trail: { at: Vector3; ms: number }[] = [];
  dangers: Danger[] = [];
  words: Word[] = [];
  /** The obstacle that is nearest to the tool; empty: none. */
  nearest = "";
  /** Whether the robot has no drawing that could be loaded. */
  bare = false;
  private heardAt = 0;
  private sampled: number | null = null;
  private wish: { axes: Axes; frame: Frame; scale: number; view: Q } | null = null;
  private readonly offset = new Vector3();
  private readonly turn = new Vector3();
  private toolKnown = false;

  hear(told: FrameTold, ms: number): void {
    this.told = told;
    this.heardAt = ms;
  }

  async robotIs(told: RobotTold): Promise<void> {
    this.robot = told;
    this.radius = told.radius;
    this.toolKnown = false;
    this.bare = true;
    if (!told.model) return;
    try {
      await this.confirmed.load(told.joints);
      this.ghost.copy(this.confirmed, told.joints);
      this.bare = false;
      this.models += 1;
    } catch {
      this.bare = true; // its tool is shown alone, and it is said
    }
  }

  sceneIs(told: SceneTold): void {
    this.sampled = told.t_sample_ns ?? null;
    const same =
      JSON.stringify(told.obstacles.map((each) => [each.id, each.shape])) ===
      JSON.stringify(this.things.map((each) => [each.id, each.shape]));
    const things = thingsOf(told);
    const targets = JSON.stringify(told.targets);
    if (!same || JSON.stringify(this.targets.map((at) => at.toArray())) !== targets) this.scenes += 1;
    this.things = things;
    this.targets = told.targets.map((at) => new Vector3(...at));
  }

  wants(axes: Axes | null, frame: Frame, scale: number, view: Q): void {
    this.wish = axes ? { axes, frame, scale, view } : null;
  }

  /** Bring everything to this instant; `dt` s after the one before. */
  update(dt: number, ms: number): void {
    const { told } = this;
    this.words = [];
    const state = told?.state;
    if (!told || !state) return;
    const since = (told.age ?? 99) + (ms - this.heardAt) / 1000;
    const { report } = told;
    this.age = since + (report?.rtt_mean ?? 0) / 2;
    this.tool = new Vector3(...state.position);
    const orientation = quaternion(state.orientation);
    const live = !told.locked && since < OLD;
    this.live = live && report !== null;
    this.placeConfirmed(state.joints, { position: this.tool, orientation }, dt);
    this.ghostSeen = 0;
    if (report && this.live) {
      const place = this.aim(new Vector3(...report.predicted), quaternion(report.predicted_orientation), orientation, dt);
      this.placeGhost(place);
      this.asked.set(...report.desired);
      this.done.set(...state.velocity); // what the robot did, by its own measure: not what it was told
    } else {
      this.asked.set(0, 0, 0);
      this.done.set(0, 0, 0);
    }
    const old = report?.rtt_mean == null ? `heard ${since.toFixed(2)} s ago` : `as it was ≈ ${this.age.toFixed(2)} s ago`;
    if (told.age !== null) this.say("confirmed", old, "confirmed", new Vector3(), 0, 30);
    if (this.bare && this.robot) this.say("robot", "no drawing of this robot: its tool alone", "confirmed", this.tool, 0, 26);
    this.findPath(told);
    this.leaveTrail(ms);
    this.moveThings(state.t_sample_ns);
    this.findTarget(told);
    this.findDangers(told, live);
  }

  /** Whether the robot has latched a stop: then it follows no plan, and no wish. */
  private get stopped(): boolean {
    const mode = this.told?.state?.mode;
    return mode === "stopped" || mode === "estop";
  }

  /** Where the ghost goes: the prediction, and at once a little of what is wished, turning too. */
  private aim(at: Vector3, orientation: Quaternion, tool: Quaternion, dt: number): { position: Vector3; orientation: Quaternion } {
    const velocity = new Vector3();
    const spin = new Vector3();
    if (this.wish && !this.told?.stands && !this.stopped) {
      const { axes, frame, scale, view } = this.wish;
      velocity
        .set(...axes.linear)
        .clampLength(0, 1)
        .multiplyScalar(SPEED * scale);
      spin
        .set(...axes.angular)
        .clampLength(0, 1)
        .multiplyScalar(TURN_SPEED * scale);
      const turned = frame === "tool" ? tool : frame === "view" ? quaternion(view) : new Quaternion();
      velocity.applyQuaternion(turned);
      spin.applyQuaternion(turned);
    }
    const share = 1 - Math.exp(-dt / QUICK);
    this.offset.lerp(velocity.multiplyScalar(LEAD), share);
    this.turn.lerp(spin.multiplyScalar(LEAD), share);
    const angle = this.turn.length();
    const turned = angle > 1e-6 ? new Quaternion().setFromAxisAngle(this.turn.clone().divideScalar(angle), angle) : new Quaternion();
    return { position: at.add(this.offset), orientation: turned.multiply(orientation) };
  }

  private placeGhost(place: { position: Vector3; orientation: Quaternion }): void {
    this.ghostAt.copy(place.position);
    this.ghostWhole = this.ghost.isLoaded && this.ghost.reach(place, this.confirmed.values);
    if (!this.ghostWhole) {
      this.ghostSeen = 1; // the tool's place alone
    } else {
      const apart = Math.max(0, ...this.ghost.values.map((q, k) => Math.abs(q - (this.confirmed.values[k] ?? q))));
      this.ghostSeen = apart > 0.002 ? Math.min(1, apart / 0.03) : 0; // where they are one, the confirmed one is seen
    }
    if (this.told?.stands) this.say("ghost", "predicted; the robot does not follow", "predicted", place.position, -70, -52);
    else if (this.offset.length() > 0.004 || this.turn.length() > 0.01)
      this.say("ghost", "predicted", "predicted", place.position, -70, -52);
  }

  readonly ghostAt = new Vector3();

  private placeConfirmed(joints: number[], pose: { position: Vector3; orientation: Quaternion }, dt: number): void {
    if (!this.confirmed.isLoaded || joints.length === 0) return;
    if (!this.toolKnown) {
      this.confirmed.learnTool(joints, pose);
      this.ghost.copyTool(this.confirmed);
      this.ghost.set(joints);
      this.toolKnown = true;
    }
    const share = 1 - Math.exp(-dt / QUICK);
    this.confirmed.set(
      joints.map((value, k) => {
        const now = this.confirmed.values[k] ?? value;
        return now + share * (value - now);
      }),
    );
  }

  /** The committed path, and a word at its end where that is somewhere else. */
  private findPath(told: FrameTold): void {
    const path = this.live && !this.stopped ? told.path.map((at) => new Vector3(...at)) : [];
    const length = path.reduce((sum, at, k) => sum + at.distanceTo(path[k - 1] ?? at), 0);
    this.path = length > SEEN ? path : [];
    const end = this.path.at(-1);
    const from = this.path[0];
    if (end && from && !told.stands && end.distanceTo(from) > WORTH_A_WORD) this.say("stop", "stops here", "predicted", end, 72, -12);
  }

  private leaveTrail(ms: number): void {
    const last = this.trail.at(-1);
    if (this.tool && (!last || last.at.distanceTo(this.tool) > 0.004)) this.trail.push({ at: this.tool.clone(), ms });
    while (this.trail[0] && ms - this.trail[0].ms > TRAIL_S * 1000) this.trail.shift();
  }

  /** To where they were when the arm was where it is drawn: one instant for all. */
  private moveThings(now: number): void {
    const seconds = this.sampled === null ? 0 : (now - this.sampled) * 1e-9;
    for (const thing of this.things) {
      thing.goTo(seconds);
      if (!thing.known)
        this.say(`unknown ${thing.id}`, `${thing.id}: not heard of for ${seconds.toFixed(1)} s`, "confirmed", thing.position, 0, 0);
    }
  }

  private findTarget(told: FrameTold): void {
    const count = this.targets.length;
    this.target = Math.min(told.report?.target_index ?? 0, count);
    const at = this.targets[this.target];
    if (at) this.say("target", `target ${this.target + 1} of ${count}`, "target", at, 0, -46);
  }

  /** What may bind: how much it keeps, from the robot's sphere or, where its guard acts, from the part that it names. */
  private findDangers(told: FrameTold, live: boolean): void {
    this.dangers = [];
    this.nearest = "";
    const { report, guard, state } = told;
    if (!report || !state || !this.tool || !live) return;
    const margin = (report.limit ?? 0) + report.inflation + report.sigma;
    const binding = guard?.obstacle || (told.holds ? report.binding : "");
    const found: (Danger & { gap: number })[] = [];
    let least = Infinity;
    for (const thing of this.things) {
      const binds = thing.id === binding;
      const part = binds && guard ? this.confirmed.linkPoint(guard.part) : null;
      const from = part ?? this.tool;
      const keeps = binds && guard ? guard.limit : margin;
      const { at, distance } = thing.nearest(from);
      const free = part ? thing.nearest(this.tool).distance : distance;
      if (free < least) [least, this.nearest] = [free, thing.id];
      const start = from.clone().sub(at);
      start.setLength(part && guard ? Math.max(0, guard.distance) : Math.max(0, distance - this.radius)).add(at);
      found.push({ thing, keeps, binds, from: start, to: at, gap: distance - this.radius - keeps });
    }
    found.sort((a, b) => Number(b.binds) - Number(a.binds) || a.gap - b.gap);
    this.dangers = found.filter((each) => each.binds || each.gap < NEAR).slice(0, MOST_SHELLS);
    const first = this.dangers[0];
    if (!first?.binds) return;
    const measured = first.from.distanceTo(first.to);
    this.say("distance", `${(measured * 1000).toFixed(0)} mm`, "distance", first.from.clone().lerp(first.to, 0.5), -34, 16);
    const place = first.thing.shape.kind === "plane" ? first.to : first.thing.position;
    this.say("keeps", `${first.thing.id} · keeps ${(first.keeps * 1000).toFixed(0)} mm`, "margin", place, 0, 60);
  }

  private say(name: string, text: string, kind: string, at: Vector3, dx: number, dy: number): void {
    this.words.push({ name, text, kind, at, dx, dy });
  }
}
