// What the console says and is told, and the socket between: it comes back by itself and never says anything twice.
import { decode, encode } from "@msgpack/msgpack";
import type { Frame, Vector } from "./hand.ts";

export type Quaternion = [number, number, number, number];

export interface RobotState {
  position: Vector;
  orientation: Quaternion;
  velocity: Vector;
  joints: number[];
  mode: "run" | "hold" | "stopped" | "estop";
  reason: string;
  clearance: number;
}

export interface Report {
  desired: Vector;
  filtered: Vector;
  desired_angular: Vector;
  angular: Vector;
  predicted: Vector;
  predicted_orientation: Quaternion;
  inflation: number;
  sigma: number;
  rtt_mean: number | null;
  rtt_std: number | null;
  loss: number;
  binding: string;
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
  /** An emergency stop was asked for, and the robot has not latched it yet. */
  stopping: boolean;
  heard: number;
  late: boolean;
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
}

export interface SceneTold {
  kind: "scene";
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

export type Told = FrameTold | SceneTold | RobotTold;

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

const TOO_OLD = 4001;
const AGAIN_MS = 700;

export class Wire {
  private socket: WebSocket | null = null;
  private n = 0;
  private final = "";

  constructor(
    private readonly build: string,
    private readonly heard: (told: Told) => void,
    private readonly changed: (open: boolean, why: string) => void,
  ) {
    this.open();
  }

  get isOpen(): boolean {
    return this.socket?.readyState === WebSocket.OPEN;
  }

  steer(steer: Steer): void {
    this.send({ kind: "steer", n: ++this.n, t: performance.now(), ...steer });
  }

  do(what: Deed, to = 0): boolean {
    return this.send({ kind: "do", n: ++this.n, what, to });
  }

  /** Begin anew, as after a long sleep: clocks of before count no more. */
  again(): void {
    this.socket?.close();
  }

  /** For good. */
  leave(): void {
    this.final = "this page was left";
    this.socket?.close();
  }

  private send(message: object): boolean {
    if (!this.isOpen || this.final) return false; // nothing waits for a connection, so that nothing old is done
    this.socket?.send(encode(message, { forceIntegerToFloat: false }));
    return true;
  }

  private open(): void {
    const socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/socket`);
    this.socket = socket;
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      socket.send(encode({ kind: "hello", page: this.build, token: decodeURIComponent(location.hash.slice(1)) }));
      this.changed(true, "");
    };
    socket.onmessage = (event: MessageEvent<ArrayBuffer>) => this.heard(decode(event.data) as Told);
    socket.onclose = (event) => {
      if (event.code === TOO_OLD && !sessionStorage.getItem("reloaded")) {
        sessionStorage.setItem("reloaded", "1");
        location.reload();
        return;
      }
      this.final ||= event.code >= 4000 && event.code < 4007 ? event.reason : "";
      this.changed(false, event.code >= 4000 ? event.reason : "");
      if (!this.final) setTimeout(() => this.open(), AGAIN_MS);
    };
  }
}
