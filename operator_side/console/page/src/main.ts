// The page: keys, buttons, sticks and gamepad in, the robot out. Whatever takes the page out of a person's hands lets go.
import { Arrival } from "./arrival.ts";
import { Camera } from "./camera.ts";
import { Controls } from "./controls.ts";
import { chosen, element, label, put } from "./dom.ts";
import { type Axes, type Frame, Hand } from "./hand.ts";
import { NetworkMenu } from "./network.ts";
import { Panel } from "./panel.ts";
import { pageReasons } from "./reason.ts";
import { Stage } from "./stage.ts";
import { type Place, Step } from "./step.ts";
import { clock, type FrameTold } from "./told.ts";
import { type Heard, Wire } from "./wire.ts";
import { World } from "./world.ts";

declare const BUILD: string;

const TICK_MS = 20;
const IDLE_MS = 60; // who says nothing for 200 counts as asleep
const SHOW_MS = 100;
const SILENT_MS = 500;
const BACK_MS = 3000;
const CUT_MS = 250;
const NOT_HEARD = "this page was not heard for a moment";
const CHANGED = "what a press does was changed";
const LATE_MS = 1500; // then its clocks are no good any more, as after a long sleep

const hand = new Hand();
const panel = new Panel();
const world = new World();
const stage = new Stage(world);
const camera = new Camera();
const arrival = new Arrival();
let told: FrameTold | null = null;
let toldAt = 0;
let lostSince = clock();
let refused = "";
let saidAt = 0;
let shownAt = 0;
let estopAt = -Infinity;
let cameBack = -Infinity;
let wasOpen = false;
let anew = true;
let lateSince = Infinity;
let step: Step | null = null;
let heardAt = -Infinity;
let received = false;
let cutAt = -Infinity;
let cutWhy = "";

const wire = new Wire(BUILD, hear, (open, why) => {
  letGo("the connection to the console changed");
  refused = why;
  if (open && wasOpen) cameBack = clock();
  wasOpen ||= open;
  anew = true;
  lateSince = clock();
  if (!open) lostSince = toldAt || lostSince;
});
const controls = new Controls(hand, { mine, mayBegin: () => chosen("mode") === "hold" || !hand.engaged, late, steer });
const networks = new NetworkMenu((said) => wire.say(said));

function hear(message: Heard, at: number): void {
  if (message.kind === "robot") {
    put("robot", message.name);
    void world.robotIs(message);
  } else if (message.kind === "scene") world.sceneIs(message);
  else if (message.kind === "picture") camera.hear(message, at);
  else {
    const first = anew;
    anew = false;
    const never = told === null;
    told = message;
    toldAt = at;
    if (never && !document.hidden && message.driver === 0) wire.do("take");
    if (first) tell(); // presses count only some time after the first word
    if (message.locked) letGo("driving was locked");
    else if (message.driver !== message.you) letGo("this page does not drive any more");
    if (!message.late || hand.engaged) lateSince = at;
    else if (at - lateSince > LATE_MS) wire.again();
    noticeCut(message);
    received = arrival.received(isHeard() ? hand.press : 0, message.report, message.state);
    world.hear(message, performance.now() - (clock() - at));
    controls.rumble(message.report);
    show();
  }
}

/** The console's watchdog lets go where this page is not heard; what is held here then counts no more, and it is said. */
function noticeCut(message: FrameTold): void {
  if (isHeard() || !hand.engaged || message.heard !== hand.press || message.locked) heardAt = clock();
  else if (clock() - heardAt > CUT_MS) {
    letGo(NOT_HEARD);
  }
}

function mine(): boolean {
  return told !== null && told.driver === told.you && told.counts !== false && !told.locked && !isSilent() && !camera.locks;
}

function isSilent(): boolean {
  return !wire.isOpen || clock() - toldAt > SILENT_MS;
}

function steer(begins: boolean): void {
  if (begins) step = chosen("mode") === "step" && told?.report ? new Step(predicted(told.report)) : null;
  tell();
  controls.light(isHeard(), received && isHeard());
}

function late(): void {
  cutAt = clock();
  cutWhy = NOT_HEARD;
}

function predicted(report: NonNullable<FrameTold["report"]>): Place {
  return { position: report.predicted, orientation: report.predicted_orientation };
}

function tell(): void {
  saidAt = clock();
  const frame = chosen("frame") as Frame;
  const axes = hand.axes(frame);
  const scale = scaleFor(axes);
  if (scale === 0 && hand.letGo()) cutWhy = "the step is done"; // it holds, though the key be down
  wire.steer({ engaged: hand.engaged, press: hand.press, ...axes, frame, view: stage.view, scale });
  world.wants(hand.engaged ? axes : null, frame, scale, stage.view);
}

function scaleFor({ linear, angular }: Axes): number {
  const wanted = Number(element<HTMLInputElement>("scale").value) / 100;
  if (!step || !hand.engaged || !told?.report) return wanted;
  const share = step.share(predicted(told.report), linear.some(Boolean), angular.some(Boolean));
  return Math.min(wanted, share);
}

/** For a reason that is said for as long as the hand does not notice, and a moment longer. */
function letGo(why: string): void {
  if (!hand.letGo()) return;
  cutAt = clock();
  cutWhy = why;
  steer(false);
}

function lookAway(): void {
  letGo("the page was out of your hands");
  hand.forgetKeys();
}

function estop(): void {
  letGo("the emergency stop");
  estopAt = clock();
  wire.do("estop");
  if (told) show();
}

function isHeard(): boolean {
  return told?.holds === true && told.heard === hand.press;
}

function reasons(): FrameTold["reasons"] {
  return pageReasons(
    {
      refused,
      silent: isSilent() ? (clock() - (toldAt || lostSince)) / 1000 : null,
      camera: camera.locks,
      back: clock() - cameBack < BACK_MS && !hand.engaged,
      hint: controls.said,
      ...lapse(),
    },
    told?.reasons ?? [],
  );
}

function lapse(): { cut: string; inVain: boolean } {
  if (hand.engaged) cutWhy = "";
  const inVain = hand.inVain && told?.driver === told?.you;
  if (!inVain && clock() - cutAt > BACK_MS) cutWhy = "";
  return { cut: cutWhy, inVain };
}

function show(): void {
  if (!told) return;
  shownAt = clock();
  panel.say(reasons());
  panel.show(told, world.nearest, isSilent() ? (clock() - toldAt) / 1000 : null);
  controls.light(isHeard(), received && isHeard());
  networks.show(told.networks);
  showRecording(told.recording);
  showStop(told);
  showSeat(told);
  showStale(told);
}

/** Lit only by a recorder that writes; one that does no more is said. */
function showRecording(writes: boolean | null | undefined): void {
  const shown = isSilent() ? null : (writes ?? null);
  element("recording").hidden = shown === null;
  element("recording").classList.toggle("on", shown === true);
  put("recording", shown ? "● rec" : "○ not recorded");
}

function showStop(told: FrameTold): void {
  const latched = told.state?.mode === "estop";
  const button = element("estop");
  // The press itself is shown at once, and for as long as the robot has not confirmed it.
  const asking = !latched && (told.stopping || clock() - estopAt < 500);
  button.classList.toggle("asked", asking);
  button.classList.toggle("latched", latched);
  label("estop", latched ? "LATCHED" : asking ? "Stopping …" : "E-STOP", latched ? "by the robot" : "Esc");
}

function showSeat(told: FrameTold): void {
  const driving = told.driver === told.you;
  const stopped = told.state?.mode === "estop" || told.state?.mode === "stopped";
  element("acknowledge").hidden = !(stopped && driving);
  element("act").classList.toggle("three", stopped && driving);
  const asked = told.asking.find(([number]) => number !== told.you);
  if (driving && asked) label("seat", "Hand over", `to ${asked[1]}, who asks`);
  else if (driving) label("seat", "Let go", "give up control");
  else if (told.driver)
    label("seat", told.asking.some(([n]) => n === told.you) ? "Asked …" : "Ask for control", `${told.driver_name} drives`);
  else label("seat", "Take control", "nobody drives");
  put("driver", driving ? "you drive" : told.driver ? `${told.driver_name} drives` : "nobody drives");
  element("driver").title = `this is page ${told.you} of those opened since the console began`;
}

function showStale(told: FrameTold): void {
  const why = isSilent() ? "no picture: the console is silent" : told.locked;
  element("view").classList.toggle("stale", why !== "");
  element("stale").hidden = !why;
  put("stale", why);
}

addEventListener("keydown", (event) => {
  if (event.code !== "Escape") return;
  event.preventDefault();
  if (!event.repeat) estop();
});
for (const name of ["blur", "pagehide", "freeze"]) addEventListener(name, lookAway);
addEventListener("pagehide", () => wire.leave());
addEventListener("pageshow", (event) => {
  if (event.persisted) location.reload(); // what a browser kept of a page that was left is old
});
document.addEventListener("visibilitychange", () => {
  if (document.hidden) lookAway();
});
element("estop").addEventListener("pointerdown", estop);
element("estop").addEventListener("click", estop);
element("acknowledge").addEventListener("click", () => wire.do("acknowledge"));
element("seat").addEventListener("click", () => {
  if (!told) return;
  const asked = told.asking.find(([number]) => number !== told?.you);
  if (told.driver !== told.you) wire.do("take");
  else if (asked) wire.do("give", asked[0]);
  else wire.do("release");
});
element("camera-close").addEventListener("click", () => camera.close());
element("pill").addEventListener("click", () => {
  const list = element("reasons");
  list.hidden = !list.hidden;
  element("pill").setAttribute("aria-expanded", String(!list.hidden));
});
for (const group of ["frames", "modes", "draw"]) element(group).addEventListener("change", () => letGo(CHANGED));
element("withs").addEventListener("change", () => {
  letGo(CHANGED);
  element("pads").dataset.with = chosen("with");
});
element("scale").addEventListener("input", () => put("scale-out", `${element<HTMLInputElement>("scale").value} %`));

function theme(light: boolean): void {
  document.documentElement.dataset.theme = light ? "light" : "dark";
  element("theme").setAttribute("aria-pressed", String(light));
  stage.theme();
}
const preferred = matchMedia("(prefers-color-scheme: light)");
preferred.addEventListener("change", () => theme(preferred.matches));
element("theme").addEventListener("click", () => theme(document.documentElement.dataset.theme !== "light"));
theme(preferred.matches);

const touch = matchMedia("(pointer: coarse)").matches ? "sticks" : "buttons";
element("pads").dataset.with = touch;
element<HTMLInputElement>(`with-${touch}`).checked = true;

setInterval(() => {
  controls.poll();
  if (hand.engaged && isSilent()) letGo(NOT_HEARD);
  else if (hand.engaged && camera.locks) letGo("the camera showed nothing new");
  if (hand.engaged || clock() - saidAt > IDLE_MS) tell();
  camera.show(told !== null && told.locked !== "");
  if (clock() - shownAt < SHOW_MS) return;
  shownAt = clock();
  if (told) show();
  else panel.say(reasons());
}, TICK_MS);
