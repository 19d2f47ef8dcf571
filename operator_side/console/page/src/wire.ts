// The page's end of its post office (post.ts): what is said goes there, what is told comes from there.
import { clock, type Deed, type News, type Order, type Picture, type Said, type Steer, type Told } from "./told.ts";

const TOO_OLD = 4001;

export type Heard = Exclude<Told, { kind: "camera" }> | Picture;

export class Wire {
  isOpen = false;
  private readonly worker = new Worker("post.js", { type: "module" });

  constructor(
    build: string,
    private readonly heard: (told: Heard, at: number) => void,
    private readonly changed: (open: boolean, why: string) => void,
  ) {
    this.worker.onmessage = (event: MessageEvent<News>) => this.news(event.data);
    const url = `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/socket`;
    this.order({ do: "open", url, build, token: decodeURIComponent(location.hash.slice(1)) });
  }

  steer(steer: Steer): void {
    this.order({ do: "steer", steer, at: clock() });
  }

  do(what: Deed, to = 0): void {
    this.say({ kind: "do", what, to });
  }

  say(said: Said): void {
    this.order({ do: "say", said });
  }

  /** Begin anew, as after a long sleep: clocks of before count no more. */
  again(): void {
    this.order({ do: "again" });
  }

  /** For good. */
  leave(): void {
    this.order({ do: "leave" });
  }

  private order(order: Order): void {
    this.worker.postMessage(order);
  }

  private news(news: News): void {
    if (news.do === "heard") {
      const { kind } = news.told;
      this.heard(news.told, news.at);
      const drawn = kind === "frame" || (news.told.kind === "picture" && news.told.bitmap !== null);
      if (drawn) this.order({ do: "drawn", what: kind === "frame" ? "frame" : "picture" });
      return;
    }
    this.isOpen = news.open;
    if (news.code === TOO_OLD && !sessionStorage.getItem("reloaded")) {
      sessionStorage.setItem("reloaded", "1");
      location.reload();
      return;
    }
    this.changed(news.open, news.why);
  }
}
