// What is read: pill and sentence, numbers, half a minute of history.
import { chart } from "./chart.ts";
import { element, put } from "./dom.ts";
import { marginText } from "./margin.ts";
import type { FrameTold, Reason } from "./told.ts";

const HISTORY_MS = 30_000;
const FULL = 0.2; // m: the bar's length
const SPOKEN_MS = 4000; // numbers change all the time: who listens hears a new pill at once, and new numbers now and then

interface Past {
  at: number;
  clearance: number;
  margin: number;
  /** null: none is known. */
  trip: number | null;
}

export class Panel {
  private past: Past[] = [];
  private drawn = 0;
  private spoken = "";
  private spokenAt = -Infinity;

  /** The first reason is the pill; all are behind it. */
  say(reasons: Reason[]): void {
    const first = reasons[0] ?? { pill: "link lost", what: "", clears: "" };
    const pill = element("pill");
    put("pill", first.pill);
    if (pill.dataset.pill !== first.pill) pill.dataset.pill = first.pill;
    put("sentence", first.what);
    this.speak(first);
    const told = JSON.stringify(reasons);
    const list = element("reasons");
    if (list.dataset.told === told) return;
    list.dataset.told = told;
    list.replaceChildren(
      ...reasons.map((reason) => {
        const item = document.createElement("li");
        item.append(`${reason.pill}: ${reason.what}`);
        const clears = document.createElement("small");
        clears.textContent = reason.clears ? `What clears it: ${reason.clears}` : "Nothing needs to be done.";
        item.append(clears);
        return item;
      }),
    );
  }

  private speak({ pill, what }: Reason): void {
    const now = performance.now();
    if (pill === this.spoken && now - this.spokenAt < SPOKEN_MS) return;
    this.spoken = pill;
    this.spokenAt = now;
    put("spoken", `${pill}. ${what}`);
  }

  show(told: FrameTold): void {
    const { state, report } = told;
    const margin = report ? report.inflation + report.sigma : 0;
    const clearance = state?.clearance ?? null;
    put("clearance", clearance === null ? "–" : (clearance * 1000).toFixed(0));
    const old = told.locked !== "" && told.age !== null;
    element("read").classList.toggle("old", told.locked !== "");
    const of = report?.binding ? `mm to ${report.binding}` : "mm to the nearest";
    put("clearance-of", old ? `mm, ${told.age?.toFixed(0)} s ago` : of);
    put("margin", report && state ? marginText(report) : "margin –");
    const bar = element("bar");
    bar.classList.toggle("tight", clearance !== null && clearance < margin + 0.01);
    const [fill, mark] = bar.children;
    if (fill instanceof HTMLElement) fill.style.width = `${Math.max(0, Math.min(100, (100 * (clearance ?? 0)) / FULL))}%`;
    if (mark instanceof HTMLElement) mark.style.left = `${Math.min(99, (100 * margin) / FULL)}%`;
    put("speed", state ? Math.hypot(...state.velocity).toFixed(2) : "–");
    put("asked", report && state ? `of ${Math.hypot(...report.desired).toFixed(2)}` : "of –");
    this.link(told);
    this.remember(told, margin);
  }

  private link(told: FrameTold): void {
    const { report } = told;
    const lost = told.locked !== "" || told.age === null;
    const trip = report?.rtt_mean ?? null;
    const word = lost ? "lost" : !report || trip === null ? "–" : trip > 0.15 || (report.loss ?? 0) > 0.05 ? "slow" : "good";
    put("link", word);
    const name = `big word ${word}`;
    if (element("link").className !== name) element("link").className = name;
    const ms = (value: number | null | undefined) => (value == null ? "–" : (value * 1000).toFixed(0));
    put(
      "numbers",
      report && told.state
        ? `${ms(report.rtt_mean)} ± ${ms(report.rtt_std)} ms\nloss ${report.loss === null ? "–" : `${(report.loss * 100).toFixed(1)} %`}`
        : "nothing heard",
    );
  }

  private remember(told: FrameTold, margin: number): void {
    const now = performance.now();
    if (told.state && told.report && !told.locked && now - (this.past.at(-1)?.at ?? 0) > 100) {
      this.past.push({ at: now, clearance: told.state.clearance, margin, trip: told.report.rtt_mean });
      this.past = this.past.filter((each) => now - each.at < HISTORY_MS);
    }
    if (now - this.drawn < 200) return;
    this.drawn = now;
    const ages = this.past.map((p) => 1 - (now - p.at) / HISTORY_MS);
    const clearances = this.past.map((p) => p.clearance * 1000);
    const most = Math.max(60, Math.min(300, Math.max(0, ...clearances)));
    chart(element<HTMLCanvasElement>("clearances"), ages, most, [
      { values: this.past.map((p) => p.margin * 1000), colour: "--slow", filled: true },
      { values: clearances, colour: "--text", filled: false },
    ]);
    const trips = this.past.map((p) => (p.trip === null ? null : p.trip * 1000));
    const longest = Math.max(50, 1.2 * Math.max(0, ...trips.map((trip) => trip ?? 0)));
    chart(element<HTMLCanvasElement>("trips"), ages, longest, [{ values: trips, colour: "--plan", filled: false }]);
  }
}
