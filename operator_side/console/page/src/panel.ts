// What is read: pill and sentence, numbers, half a minute of history.
import { chart } from "./chart.ts";
import { keptOf, type Least, leastOf } from "./clearance.ts";
import { element, emphasise, put } from "./dom.ts";
import { marginText } from "./margin.ts";
import type { FrameTold, Reason } from "./told.ts";

const HISTORY_MS = 30_000;
const FULL = 0.2; // m: the bar's length
const SPOKEN_MS = 4000; // numbers change all the time: who listens hears a new pill at once, and new numbers now and then

interface Past {
  at: number;
  /** null: it was not known then. */
  clearance: number | null;
  kept: number | null;
  limit: number | null;
  /** null: none is known. */
  trip: number | null;
}

const millimetres = (metres: number | null): number | null => (metres === null ? null : metres * 1000);

/** Whose clearance it is, to what where that is known; or how old it is. */
function clearanceText(least: Least, nearest: string, age: number | null): string {
  if (age !== null) return `mm ${least.part}, ${age.toFixed(0)} s ago`;
  const to = nearest && least.isTool ? ` to ${nearest}` : "";
  return `mm ${least.part}${to}${least.other ? ` · ${least.other}` : ""}`;
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
    emphasise("sentence", first.what);
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

  /** `nearest` is the obstacle that the tool's clearance is to, `silent` for how long the console has been (s); null: it is not. */
  show(told: FrameTold, nearest: string, silent: number | null): void {
    const { state, report } = told;
    const least = state ? leastOf(state, report, told.guard) : null;
    put("clearance", least ? (least.value * 1000).toFixed(0) : "–");
    // At the same moment as a pill says so: numbers of before are no news.
    const lost = told.locked !== "" || silent !== null || told.reasons.some((each) => each.pill === "link lost");
    const age = told.age === null ? null : told.age + (silent ?? 0);
    element("read").classList.toggle("old", lost);
    put("clearance-of", least ? clearanceText(least, nearest, lost ? age : null) : "mm");
    put("kept", report && least ? keptOf(least, report) : "keeps –");
    const parts = report && state ? marginText(report) : "";
    put("margin", parts.includes("=") ? parts : "");
    this.bar(least);
    put("speed", state ? Math.hypot(...state.velocity).toFixed(2) : "–");
    const before = lost && age !== null ? `${age.toFixed(0)} s ago` : null;
    put("asked", before ?? (report && state ? `of ${Math.hypot(...report.desired).toFixed(2)}` : "of –"));
    this.link(told, lost, before);
    this.remember(told, least, lost);
  }

  /** How far it is, over what must be kept: the limit, and the margin beyond it. */
  private bar(least: Least | null): void {
    const bar = element("bar");
    const [margin, fill, mark] = bar.children;
    const share = (metres: number) => `${Math.max(0, Math.min(100, (100 * metres) / FULL)).toFixed(1)}%`;
    if (fill instanceof HTMLElement) fill.style.width = share(least?.value ?? 0);
    if (margin instanceof HTMLElement) margin.style.width = share(least?.kept ?? 0);
    if (!(mark instanceof HTMLElement)) return;
    mark.hidden = least === null; // at the left end it would say that the limit is zero
    mark.style.left = share(least?.limit ?? 0);
  }

  private link(told: FrameTold, lost: boolean, before: string | null): void {
    const { report } = told;
    const trip = report?.rtt_mean ?? null;
    const word =
      lost || told.age === null ? "lost" : !report || trip === null ? "–" : trip > 0.15 || (report.loss ?? 0) > 0.05 ? "slow" : "good";
    put("link", word);
    const name = `big word ${word}`;
    if (element("link").className !== name) element("link").className = name;
    const ms = (value: number | null | undefined) => (value == null ? "–" : (value * 1000).toFixed(0));
    put(
      "numbers",
      report && told.state
        ? `${ms(report.rtt_mean)} ± ${ms(report.rtt_std)} ms\nloss ${report.loss === null ? "–" : `${(report.loss * 100).toFixed(1)} %`}${before ? `, ${before}` : ""}`
        : "nothing heard",
    );
  }

  private remember(told: FrameTold, least: Least | null, lost: boolean): void {
    const now = performance.now();
    if (least && told.report && !lost && now - (this.past.at(-1)?.at ?? 0) > 100) {
      this.past.push({ at: now, clearance: least.value, kept: least.kept, limit: least.limit, trip: told.report.rtt_mean });
    } else if (lost && this.past.at(-1)?.clearance != null) {
      const { kept, limit } = this.past[this.past.length - 1] as Past;
      this.past.push({ at: now, clearance: null, kept, limit, trip: null }); // nothing is drawn over what nobody heard
    }
    this.past = this.past.filter((each) => now - each.at < HISTORY_MS);
    if (now - this.drawn < 200) return;
    this.drawn = now;
    const ages = this.past.map((p) => 1 - (now - p.at) / HISTORY_MS);
    const clearances = this.past.map((p) => millimetres(p.clearance));
    const most = Math.max(60, 1.1 * Math.min(300, Math.max(0, ...clearances.map((each) => each ?? 0))));
    chart(element<HTMLCanvasElement>("clearances"), ages, most, [
      { values: this.past.map((p) => millimetres(p.kept)), colour: "--slow", filled: true, silent: lost },
      { values: this.past.map((p) => millimetres(p.limit)), colour: "--stop", filled: false, silent: true },
      { values: clearances, colour: "--text", filled: false },
    ]);
    const trips = this.past.map((p) => (p.trip === null ? null : p.trip * 1000));
    const longest = Math.max(50, 1.2 * Math.max(0, ...trips.map((trip) => trip ?? 0)));
    chart(element<HTMLCanvasElement>("trips"), ages, longest, [{ values: trips, colour: "--plan", filled: false }]);
  }
}
