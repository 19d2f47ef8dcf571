// Keys, buttons, sticks and gamepad into the hand. What is held when it may not count does not count later either.
import { element } from "./dom.ts";
import { Pad, rumble, UNREAD } from "./gamepad.ts";
import { type Act, type Hand, KEYS, type Six } from "./hand.ts";
import { sliderShare, stickShares } from "./stick.ts";
import type { Report } from "./told.ts";

const RUMBLE_MS = 120;
const SAID_MS = 5000;
const OLD_MS = 250;

export interface Seat {
  /** Whether this page drives, and may now. */
  mine(): boolean;
  /** Whether another press may begin beside those that are held. */
  mayBegin(): boolean;
  /** A press came too late to count. */
  late(): void;
  /** What is held has changed. */
  steer(begins: boolean): void;
}

export class Controls {
  /** What the gamepad has to say; empty: nothing. */
  said = "";
  private readonly pad = new Pad();
  private saidAt = 0;
  /** Whether the page has lost its focus. */
  private away = false;
  private rumbledAt = 0;

  constructor(
    private readonly hand: Hand,
    private readonly seat: Seat,
  ) {
    addEventListener("blur", () => (this.away = true));
    addEventListener("focus", () => (this.away = false));
    addEventListener("pointerdown", () => (this.away = false));
    addEventListener("keydown", (event) => this.key(event));
    addEventListener("keyup", (event) => this.release(event.code));
    for (const button of document.querySelectorAll<HTMLButtonElement>("[data-act]")) this.button(button);
    for (const stick of document.querySelectorAll<HTMLElement>("[data-stick]")) this.stick(stick);
  }

  /** Read the gamepad: called often. */
  poll(): void {
    if (document.hidden || this.away) {
      this.pad.forget(); // what is down when somebody looks again was pressed before
      this.release("gamepad");
      this.said = !document.hidden && this.seat.mine() && plugged() ? UNREAD : "";
      return;
    }
    const found = plugged();
    const { held, six, said } = this.pad.read(found);
    const now = performance.now();
    if (said) this.saidAt = now;
    if (said || found || now - this.saidAt > SAID_MS) this.said = said;
    if (held) this.grip("gamepad", six);
    else this.release("gamepad");
  }

  /** Let the gamepad tell by hand how much of what is asked is not done. */
  rumble(report: Report | null): void {
    const strength = report && this.hand.engaged ? rumble(report.desired, report.filtered) : 0;
    const now = performance.now();
    if (strength < 0.05 || now - this.rumbledAt < RUMBLE_MS * 0.8) return;
    const pad = plugged();
    if (!pad?.vibrationActuator) return;
    this.rumbledAt = now;
    void pad.vibrationActuator
      .playEffect("dual-rumble", { duration: RUMBLE_MS, strongMagnitude: strength, weakMagnitude: strength / 2 })
      .catch(() => undefined); // one that cannot is no reason to stop
  }

  private key(event: KeyboardEvent): void {
    const act = KEYS[event.code];
    if (!act || event.ctrlKey || event.metaKey || event.altKey) return;
    const { target } = event;
    if (target instanceof HTMLSelectElement) return; // keys choose in it
    if (target instanceof HTMLInputElement && event.code.startsWith("Arrow")) return; // they move the slider
    event.preventDefault();
    if (performance.now() - event.timeStamp > OLD_MS) {
      if (event.repeat) return;
      this.hand.refuse(event.code); // held up, as by a sleep: nobody may press it now
      this.seat.late();
      return;
    }
    this.press(event.code, act, event.repeat);
  }

  private press(source: string, act: Act, repeated: boolean): void {
    const may = repeated || (this.seat.mine() && this.seat.mayBegin()); // a repetition is no press, but tells what is down
    if (!may) this.hand.refuse(source);
    else if (this.hand.down(source, act, repeated)) this.seat.steer(true);
  }

  private grip(source: string, six: Six): void {
    const { press, engaged } = this.hand;
    if (!this.seat.mine()) this.hand.refuse(source);
    else if ((engaged || this.seat.mayBegin()) && this.hand.grip(source, six)) this.seat.steer(this.hand.press !== press);
  }

  private release(source: string): void {
    if (this.hand.up(source)) this.seat.steer(false);
  }

  private button(button: HTMLButtonElement): void {
    const act = button.dataset.act as Act;
    button.addEventListener("pointerdown", (event) => {
      event.preventDefault();
      button.setPointerCapture(event.pointerId);
      this.press(`pointer ${event.pointerId}`, act, false);
    });
    for (const name of ["pointerup", "pointercancel", "lostpointercapture"] as const)
      button.addEventListener(name, (event) => this.release(`pointer ${event.pointerId}`));
    button.addEventListener("contextmenu", (event) => event.preventDefault());
    button.addEventListener("keydown", (event) => {
      if (event.code !== "Space" && event.code !== "Enter") return;
      event.preventDefault();
      this.press(`focus ${act}`, act, event.repeat);
    });
    for (const name of ["keyup", "blur"]) button.addEventListener(name, () => this.release(`focus ${act}`));
  }

  private stick(stick: HTMLElement): void {
    const source = `stick ${stick.dataset.stick}`;
    const knob = stick.querySelector("i");
    let finger: number | null = null;
    const move = (event: PointerEvent) => {
      const box = stick.getBoundingClientRect();
      const [dx, dy] = [event.clientX - box.x - box.width / 2, event.clientY - box.y - box.height / 2];
      const [mostX, mostY] = [box.width / 2 - 18, box.height / 2 - 18];
      const far = Math.max(1, box.width === box.height ? Math.hypot(dx, dy) / mostX : 1);
      const clip = (d: number, most: number) => Math.max(-most, Math.min(most, d / far));
      if (knob) knob.style.transform = `translate(${clip(dx, Math.max(0, mostX)).toFixed(0)}px, ${clip(dy, mostY).toFixed(0)}px)`;
      this.grip(source, sixOf(stick.dataset.stick ?? "", dx, dy, mostY));
    };
    const end = (event: PointerEvent) => {
      if (event.pointerId !== finger) return;
      finger = null;
      if (knob) knob.style.transform = "";
      this.release(source);
    };
    stick.addEventListener("pointerdown", (event) => {
      event.preventDefault();
      if (finger !== null) return;
      finger = event.pointerId;
      stick.setPointerCapture(finger);
      this.hand.up(source); // a new touch, whatever became of the one before
      move(event);
    });
    stick.addEventListener("pointermove", (event) => {
      if (event.pointerId === finger) move(event);
    });
    for (const name of ["pointerup", "pointercancel", "lostpointercapture"] as const) stick.addEventListener(name, end);
    stick.addEventListener("contextmenu", (event) => event.preventDefault());
  }

  /** Which buttons and sticks show that they are down, that the console has heard it, and that the robot does it. */
  light(heard: boolean, received: boolean): void {
    for (const button of document.querySelectorAll<HTMLElement>("[data-act]")) {
      const down = this.hand.holds(button.dataset.act as Act);
      button.classList.toggle("down", down);
      button.classList.toggle("heard", down && heard);
      button.classList.toggle("received", down && received);
    }
    for (const stick of document.querySelectorAll<HTMLElement>("[data-stick]")) {
      const down = this.hand.grips.has(`stick ${stick.dataset.stick}`);
      stick.classList.toggle("down", down);
      stick.classList.toggle("heard", down && heard);
      stick.classList.toggle("received", down && received);
    }
    element("pads").classList.toggle("locked", !this.seat.mine());
  }
}

/** The gamepad that is there; null: none is. */
function plugged(): Gamepad | null {
  return navigator.getGamepads().find((each) => each?.connected) ?? null;
}

/** A stick's axes by its name. */
function sixOf(name: string, dx: number, dy: number, radius: number): Six {
  const [x, y] = stickShares(dx, dy, radius);
  if (name === "move") return [x, y, 0, 0, 0, 0];
  if (name === "turn") return [0, 0, 0, y, 0, 0 - x || 0];
  const share = sliderShare(0 - dy, radius);
  return name === "lift" ? [0, 0, share, 0, 0, 0] : [0, 0, 0, 0, share, 0];
}
