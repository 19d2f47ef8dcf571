// What the console tells pages, and what they say.
import type { Frame, Vector } from "./hand.ts";
import type { Quaternion } from "./step.ts";

export type { Quaternion };

export interface RobotState {
  t_sample_ns: number;
  position: Vector;
  orientation: Quaternion;
  velocity: Vector;
  joints: number[];
  mode: "run" | "hold" | "stopped" | "estop";
  reason: string;
  clearance: number;
  /** Of the whole arm; null: not computed. */
  arm_clearance?: number | null;
  /** The command that it applies. */
  applied_session: number;
  applied_seq: number;
}

export interface Report {
  /** Of the command that was sent with it. */
  session: number;
  seq: number;
  mode: string;
  desired: Vector;
  filtered: Vector;
  desired_angular: Vector;
  angular: Vector;
  predicted: Vector;
  predicted_orientation: Quaternion;
  inflation: number;
  sigma: number;
  margin_parts: Record<string, number>;
  rtt_mean: number | null;
  rtt_std: number | null;
  loss: number | null;
  binding: string;
  /** What is kept without any margin (m); null: not known. */
  limit?: number | null;
  target_index: number;
  target_count: number;
}

export interface Guard {
  part: string;
  obstacle: string;
  distance: number;
  limit: number;
}

export interface Reason {
  pill: string;
  what: string;
  clears: string;
}

export interface Networks {
  names: string[];
  uplink: string;
  downlink: string;
  name: string;
  changeable: boolean;
  outage: boolean;
  /** Why the last change was not done. */
  refused: string;
}

export interface FrameTold {
  kind: "frame";
  state: RobotState | null;
  guard: Guard | null;
  report: Report | null;
  age: number | null;
  report_age: number | null;
  path: Vector[];
  reasons: Reason[];
  locked: string;
  you: number;
  driver: number;
  driver_name: string;
  asking: [number, string][];
  holds: boolean;
  /** Whether the robot does not do what is sent, for longer than the way there and its start-up explain. */
  stands?: boolean;
  /** An emergency stop was asked for, and the robot has not latched it yet. */
  stopping: boolean;
  heard: number;
  late: boolean;
  /** Of this frame; whoever steers says which one is its newest. */
  stamp?: number;
  /** Whether a press of this page would count now; left out by consoles that do not know. */
  counts?: boolean;
  networks?: Networks | null;
  /** Whether a recorder writes; unknown where it is left out. */
  recording?: boolean | null;
}

export interface Shape {
  kind: "sphere" | "capsule" | "box" | "plane" | "mesh";
  radius?: number;
  half_length?: number;
  half_extents?: Vector;
  vertices?: Vector[];
}

export interface Obstacle {
  id: string;
  position: Vector;
  velocity: Vector;
  orientation: Quaternion;
  shape: Shape;
  path?: Vector[];
}

export interface SceneTold {
  kind: "scene";
  /** When the obstacles were where they are said to be, on the robot's clock. */
  t_sample_ns?: number;
  obstacles: Obstacle[];
  targets: Vector[];
}

export interface RobotTold {
  kind: "robot";
  name: string;
  model: string;
  joints: string[];
  radius: number;
}

export interface CameraTold {
  kind: "camera";
  /** How old the picture was when it was sent, at most and at least; null: not known. */
  captured_age_ms: number | null;
  captured_age_least_ms?: number | null;
  /** What is wrong with the pictures; empty: nothing that is known. */
  said?: string;
  /** Empty where there is no new one. */
  jpeg: Uint8Array;
  width: number;
  height: number;
  source: string;
}

export type Told = FrameTold | SceneTold | RobotTold | CameraTold;

export interface Steer {
  engaged: boolean;
  press: number;
  linear: Vector;
  angular: Vector;
  frame: Frame;
  view: Quaternion;
  scale: number;
}

export type Deed = "estop" | "acknowledge" | "take" | "release" | "give";
export type Said = { kind: "do"; what: Deed; to: number } | { kind: "network"; name: string } | { kind: "outage"; seconds: number };

/** A camera's picture that is ready to be drawn, or what is said of it. */
export interface Picture {
  kind: "picture";
  /** null: no new one. */
  bitmap: ImageBitmap | null;
  source: string;
  most_ms: number | null;
  least_ms: number | null;
  said: string;
}

/** From page to worker. */
export type Order =
  | { do: "open"; url: string; build: string; token: string }
  | { do: "steer"; steer: Steer; at: number }
  | { do: "say"; said: Said }
  | { do: "drawn"; what: "frame" | "picture" }
  | { do: "again" }
  | { do: "leave" };

/** From worker to page; `at` is when it came (ms, `clock`). */
export type News =
  | { do: "heard"; told: Exclude<Told, CameraTold> | Picture; at: number }
  | { do: "changed"; open: boolean; code: number; why: string };

/** One clock for page and worker (ms). */
export function clock(): number {
  return performance.timeOrigin + performance.now();
}
