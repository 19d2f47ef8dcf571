// The page's post office, a worker of its own: the socket, and what is held down said again while the page draws.
// It comes back by itself, never says anything twice that is not held down, and hands on the newest, never a queue.
import { decode, encode } from "@msgpack/msgpack";
import { PERIOD_MS, Repeat } from "./repeat.ts";
import { type CameraTold, clock, type FrameTold, type News, type Order, type Picture, type Said, type Steer, type Told } from "./told.ts";

const AGAIN_MS = 700;

const repeat = new Repeat<Steer>();
let socket: WebSocket | null = null;
let opening: { url: string; build: string; token: string } | null = null;
let final = false;
let n = 0;
let stamp: number | undefined;

/** The newest of its kind; one at a time is with the page. */
class Latest<T extends FrameTold | Picture> {
  private newest: [T, number] | null = null;
  private out = false;

  constructor(private readonly dropped: (told: T) => void) {}

  take(told: T, at: number): void {
    if (this.newest) this.dropped(this.newest[0]);
    this.newest = [told, at];
    this.give();
  }

  drawn(): void {
    this.out = false;
    this.give();
  }

  private give(): void {
    if (this.out || !this.newest) return;
    const [told, at] = this.newest;
    this.newest = null;
    this.out = true;
    tell({ do: "heard", told, at }, told.kind === "picture" && told.bitmap ? [told.bitmap] : []);
  }
}

const frames = new Latest<FrameTold>(() => undefined);
const pictures = new Latest<Picture>((picture) => picture.bitmap?.close());

function tell(news: News, transfer: Transferable[] = []): void {
  postMessage(news, { transfer });
}

function send(message: object): void {
  if (socket?.readyState !== WebSocket.OPEN || final) return; // nothing waits for a connection, so that nothing old is done
  socket.send(encode(message));
}

function steer(said: Steer): void {
  const seen = stamp === undefined ? {} : { seen: stamp }; // older consoles give none, and want none
  send({ kind: "steer", n: ++n, t: performance.now(), ...said, ...seen });
  repeat.went(performance.now());
}

function say(said: Said): void {
  if (said.kind === "do") send({ kind: "do", n: ++n, what: said.what, to: said.to });
  else send({ ...said, n: ++n });
}

async function picture(told: CameraTold, at: number): Promise<void> {
  const { source, captured_age_ms: most_ms, captured_age_least_ms: least_ms = null, said = "" } = told;
  const found: Picture = { kind: "picture", bitmap: null, source, most_ms, least_ms, said };
  if (told.jpeg.length === 0) {
    tell({ do: "heard", told: found, at });
    return;
  }
  try {
    found.bitmap = await createImageBitmap(new Blob([told.jpeg as Uint8Array<ArrayBuffer>], { type: "image/jpeg" }));
    pictures.take(found, at);
  } catch {
    send({ kind: "pictured" }); // no picture: the one before grows old, and says so
  }
}

function heard(told: Told): void {
  const at = clock();
  if (told.kind === "camera") void picture(told, at);
  else if (told.kind === "frame") {
    stamp = told.stamp;
    frames.take(told, at);
  } else tell({ do: "heard", told, at });
}

function open(): void {
  if (!opening || final) return;
  const { url, build, token } = opening;
  const opened = new WebSocket(url);
  socket = opened;
  opened.binaryType = "arraybuffer";
  opened.onopen = () => {
    opened.send(encode({ kind: "hello", page: build, token }));
    tell({ do: "changed", open: true, code: 0, why: "" });
  };
  opened.onmessage = (event: MessageEvent<ArrayBuffer>) => heard(decode(event.data) as Told);
  opened.onclose = (event) => {
    repeat.forget();
    stamp = undefined;
    final ||= event.code >= 4000 && event.code < 4007;
    tell({ do: "changed", open: false, code: event.code, why: event.code >= 4000 ? event.reason : "" });
    if (!final) setTimeout(open, AGAIN_MS);
  };
}

addEventListener("message", (event: MessageEvent<Order>) => {
  const order = event.data;
  if (order.do === "open") {
    opening = order;
    open();
  } else if (order.do === "steer") {
    const age = clock() - order.at; // both clocks are one, but numbers of this one stay small
    const now = performance.now();
    if (repeat.take(order.steer, now - age, now)) steer(order.steer);
  } else if (order.do === "say") say(order.said);
  else if (order.do === "drawn") {
    (order.what === "frame" ? frames : pictures).drawn();
    if (order.what === "picture") send({ kind: "pictured" }); // only then the next one comes
  } else {
    final ||= order.do === "leave";
    repeat.forget();
    socket?.close();
  }
});

setInterval(() => {
  const again = repeat.next(performance.now());
  if (again) steer(again);
}, PERIOD_MS);
