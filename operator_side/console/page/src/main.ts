// The page: keys and buttons in, the robot out. Whatever takes the page out of a person's hands lets go.
import { type Act, type Frame, Hand, KEYS } from "./hand.ts";
import { element, Panel } from "./panel.ts";
import { Labels, View3D } from "./scene.ts";
import { type FrameTold, type Told, Wire } from "./wire.ts";

declare const BUILD: string;

const SEND_MS = 20;
const IDLE_MS = 400;
const SILENT_MS = 500;
const GRACE_MS = 250;

const hand = new Hand();
const panel = new Panel();
const view = new View3D(element<HTMLCanvasElement>("scene"), new Labels(element("labels")));
let told: FrameTold | null = null;
let toldAt = 0;
let lostSince = performance.now();
let refused = "";
let saidAt = 0;
let estopAt = -Infinity;
let cameBack = -Infinity;
let wasOpen = false;

const wire = new Wire(BUILD, hear, (open, why) => {
  letGo();
  refused = why;
  if (open && wasOpen) cameBack = performance.now();
  wasOpen ||= open;
  if (!open) lostSince = toldAt || lostSince;
});

function hear(message: Told): void {
  if (message.kind === "robot") {
    element("robot").textContent = message.name;
    void view.robotIs(message);
  } else if (message.kind === "scene") view.sceneIs(message);
  else {
    const first = told === null;
    told = message;
    toldAt = performance.now();
    if (first && !document.hidden && message.driver === 0) wire.do("take");
    if (message.locked || message.driver !== message.you) letGo();
    if (message.late && !hand.engaged) wire.again();
    view.hear(message);
    show();
  }
}

function frame(): Frame {
  return (document.querySelector<HTMLInputElement>('input[name="frame"]:checked')?.value ?? "view") as Frame;
}

function scale(): number {
  return Number(element<HTMLInputElement>("scale").value) / 100;
}

function mine(): boolean {
  return told !== null && told.driver === told.you && !told.locked && !isSilent();
}

function isSilent(): boolean {
  return !wire.isOpen || performance.now() - toldAt > SILENT_MS;
}

function steer(): void {
  saidAt = performance.now();
  const axes = hand.axes(frame());
  wire.steer({ engaged: hand.engaged, press: hand.press, ...axes, frame: frame(), view: view.view, scale: scale() });
  view.wants(hand.engaged ? axes : null, frame(), scale());
  light();
}

function press(source: string, act: Act, repeated: boolean): void {
  if (mine() && hand.down(source, act, repeated)) steer();
}

function release(source: string): void {
  if (hand.up(source)) steer();
}

function letGo(): void {
  if (hand.letGo()) steer();
}

function estop(): void {
  letGo();
  estopAt = performance.now();
  wire.do("estop");
  light();
}

function light(): void {
  const heard = told !== null && told.holds && told.heard === hand.press;
  for (const button of document.querySelectorAll<HTMLElement>("[data-act]")) {
    const down = hand.holds(button.dataset.act as Act);
    button.classList.toggle("down", down);
    button.classList.toggle("heard", down && heard);
  }
  element("pads").classList.toggle("locked", !mine());
}

function show(): void {
  if (!told) return;
  panel.say(localReasons() ?? told.reasons);
  panel.show(told);
  light();
  const latched = told.state?.mode === "estop";
  const stopped = latched || told.state?.mode === "stopped";
  const button = element("estop");
  // The press itself is shown at once, and for as long as the robot has not confirmed it.
  const asking = !latched && (told.stopping || performance.now() - estopAt < 500);
  button.classList.toggle("asked", asking);
  button.classList.toggle("latched", latched);
  label("estop", latched ? "LATCHED" : asking ? "Stopping …" : "E-STOP", latched ? "by the robot" : "Esc");
  const driving = told.driver === told.you;
  element("acknowledge").hidden = !(stopped && driving);
  element("act").classList.toggle("three", stopped && driving);
  const asked = told.asking.find(([number]) => number !== told?.you);
  if (driving && asked) label("seat", `Hand over`, `to ${asked[1]}, who asks`);
  else if (driving) label("seat", "Let go", "give up control");
  else if (told.driver) label("seat", told.asking.some(([n]) => n === told?.you) ? "Asked …" : "Ask for control", `${told.driver_name} drives`);
  else label("seat", "Take control", "nobody drives");
  element("driver").textContent = driving ? "you drive" : told.driver ? `${told.driver_name} drives` : "nobody drives";
  const stale = element("stale");
  element("view").classList.toggle("stale", told.locked !== "" || isSilent());
  stale.hidden = !(told.locked || isSilent());
  if (!stale.hidden) stale.textContent = isSilent() ? "no picture: the console is silent" : told.locked;
  else if (!view.works) {
    stale.hidden = false;
    stale.textContent = "This browser has no WebGL: numbers and keys work, the picture does not.";
  }
}

function label(id: string, bold: string, small: string): void {
  const [b, s] = element(id).children as unknown as [HTMLElement, HTMLElement];
  if (b.textContent !== bold) b.textContent = bold;
  if (s.textContent !== small) s.textContent = small;
}

/** What the page knows better than the console. */
function localReasons(): FrameTold["reasons"] | null {
  if (refused) return [{ pill: "link lost", what: refused, clears: "See to that, then reload this page." }];
  if (isSilent() && performance.now() - toldAt > SILENT_MS) {
    const seconds = ((performance.now() - (toldAt || lostSince)) / 1000).toFixed(1);
    return [{ pill: "link lost", what: `The console is silent for ${seconds} s. Driving is locked.`, clears: "It is found again by itself; then press anew." }];
  }
  if (performance.now() - cameBack < 3000 && told && !hand.engaged)
    return [{ pill: "ready", what: "Connected again. Nothing moves until you press anew.", clears: "" }, ...told.reasons];
  return null;
}

addEventListener("keydown", (event) => {
  if (event.code === "Escape") {
    event.preventDefault();
    if (!event.repeat) estop();
    return;
  }
  const act = KEYS[event.code];
  if (!act || event.ctrlKey || event.metaKey || event.altKey) return;
  if (event.target instanceof HTMLInputElement && event.code.startsWith("Arrow")) return; // they move the slider
  event.preventDefault();
  press(event.code, act, event.repeat);
});
addEventListener("keyup", (event) => release(event.code));
for (const name of ["blur", "pagehide", "freeze"]) addEventListener(name, letGo);
addEventListener("pagehide", () => wire.leave());
addEventListener("pageshow", (event) => {
  if (event.persisted) location.reload(); // what a browser kept of a page that was left is old
});
document.addEventListener("visibilitychange", () => {
  if (document.hidden) letGo();
});
for (const button of document.querySelectorAll<HTMLButtonElement>("[data-act]")) {
  const act = button.dataset.act as Act;
  button.addEventListener("pointerdown", (event) => {
    event.preventDefault();
    button.setPointerCapture(event.pointerId);
    press(`pointer ${event.pointerId}`, act, false);
  });
  for (const name of ["pointerup", "pointercancel", "lostpointercapture"] as const)
    button.addEventListener(name, (event) => release(`pointer ${event.pointerId}`));
  button.addEventListener("contextmenu", (event) => event.preventDefault());
  button.addEventListener("keydown", (event) => {
    if (event.code !== "Space" && event.code !== "Enter") return;
    event.preventDefault();
    press(`focus ${act}`, act, event.repeat);
  });
  for (const name of ["keyup", "blur"]) button.addEventListener(name, () => release(`focus ${act}`));
}
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
element("pill").addEventListener("click", () => {
  const list = element("reasons");
  list.hidden = !list.hidden;
  element("pill").setAttribute("aria-expanded", String(!list.hidden));
});
element("frames").addEventListener("change", letGo);
element("scale").addEventListener("input", () => {
  element("scale-out").textContent = `${element<HTMLInputElement>("scale").value} %`;
});
function theme(light: boolean): void {
  document.documentElement.dataset.theme = light ? "light" : "dark";
  view.theme();
}
element("theme").addEventListener("click", () => theme(document.documentElement.dataset.theme !== "light"));
theme(matchMedia("(prefers-color-scheme: light)").matches);

setInterval(() => {
  if (hand.engaged || performance.now() - saidAt > IDLE_MS) if (wire.isOpen) steer();
  if (performance.now() - toldAt > GRACE_MS && isSilent()) letGo();
  if (isSilent()) {
    const reasons = localReasons();
    if (reasons) panel.say(reasons);
    if (told) show();
  }
}, SEND_MS);
