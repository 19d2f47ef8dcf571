// What is read: pill and sentence, numbers, half a minute of history.
import type { FrameTold, Reason } from "./wire.ts";
import { css } from "./scene.ts";

const HISTORY_MS = 30_000;
const FULL = 0.2; // m: the bar's length

interface Past {
  at: number;
  clearance: number;
  margin: number;
  /** null: none is known. */
  trip: number | null;
}

export function element<T extends HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no ${id}`);
  return found as T;
}

function put(id: string, text: string): void {
  const at = element(id);
  if (at.textContent !== text) at.textContent = text;
}

export class Panel {
  private past: Past[] = [];
  private drawn = 0;

  /** The first reason is the pill; all are behind it. */
  say(reasons: Reason[]): void {
    const first = reasons[0] ?? { pill: "link lost", what: "", clears: "" };
    const pill = element("pill");
    put("pill", first.pill);
    if (pill.dataset.pill !== first.pill) pill.dataset.pill = first.pill;
    put("sentence", first.what);
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

  show(told: FrameTold): void {
    const { state, report } = told;
    const margin = report ? report.inflation + report.sigma : 0;
    const clearance = state?.clearance ?? null;
    put("clearance", clearance === null ? "–" : (clearance * 1000).toFixed(0));
    put("clearance-of", `mm${report?.binding ? ` to ${report.binding}` : ""} · margin ${(margin * 1000).toFixed(0)}`);
    const bar = element("bar");
    bar.classList.toggle("tight", clearance !== null && clearance < margin + 0.01);
    const [fill, mark] = bar.children as unknown as [HTMLElement, HTMLElement];
    fill.style.width = `${Math.max(0, Math.min(100, (100 * (clearance ?? 0)) / FULL))}%`;
    mark.style.left = `${Math.min(99, (100 * margin) / FULL)}%`;
    put("speed", state ? Math.hypot(...state.velocity).toFixed(2) : "–");
    put("asked", report ? `of ${Math.hypot(...report.desired).toFixed(2)}` : "of –");
    this.link(told);
    this.remember(told, margin);
  }

  private link(told: FrameTold): void {
    const { report } = told;
    const lost = told.locked !== "" || told.age === null;
    const trip = report?.rtt_mean ?? null;
    const word = lost ? "lost" : !report || trip === null ? "–" : trip > 0.15 || report.loss > 0.05 ? "slow" : "good";
    put("link", word);
    element("link").className = `big word ${word}`;
    const ms = (value: number | null | undefined) => (value == null ? "–" : (value * 1000).toFixed(0));
    put("numbers", report ? `${ms(report.rtt_mean)} ± ${ms(report.rtt_std)} ms\nloss ${(report.loss * 100).toFixed(1)} %` : "–");
  }

  private remember(told: FrameTold, margin: number): void {
    const now = performance.now();
    if (told.state && told.report && now - (this.past.at(-1)?.at ?? 0) > 100) {
      this.past.push({ at: now, clearance: told.state.clearance, margin, trip: told.report.rtt_mean });
      this.past = this.past.filter((each) => now - each.at < HISTORY_MS);
    }
    if (now - this.drawn < 200) return;
    this.drawn = now;
    const lines = { margin: this.past.map((p) => p.margin * 1000), clearance: this.past.map((p) => p.clearance * 1000) };
    const ages = this.past.map((p) => 1 - (now - p.at) / HISTORY_MS);
    const most = Math.max(60, Math.min(300, ...[Math.max(0, ...lines.clearance)]));
    chart("clearances", ages, most, [[lines.margin, css("--slow"), true], [lines.clearance, css("--text"), false]]);
    const trips = this.past.map((p) => (p.trip === null ? null : p.trip * 1000));
    chart("trips", ages, Math.max(50, 1.2 * Math.max(0, ...trips.map((trip) => trip ?? 0))), [[trips, css("--plan"), false]]);
  }
}

/** Lines over time; where a value is null nothing is known, and nothing is drawn. */
function chart(id: string, xs: number[], most: number, lines: [(number | null)[], string, boolean][]): void {
  const canvas = element<HTMLCanvasElement>(id);
  const ratio = devicePixelRatio;
  const { clientWidth: width, clientHeight: height } = canvas;
  if (width === 0) return;
  canvas.width = width * ratio;
  canvas.height = height * ratio;
  const pen = canvas.getContext("2d");
  if (!pen) return;
  pen.scale(ratio, ratio);
  const y = (value: number) => height - 2 - (Math.max(0, Math.min(most, value)) / most) * (height - 6);
  for (const [values, colour, filled] of lines) {
    pen.beginPath();
    let drawing = false;
    values.forEach((value, k) => {
      const x = (xs[k] ?? 0) * (width - 40);
      if (value !== null && drawing) pen.lineTo(x, y(value));
      else if (value !== null) pen.moveTo(x, y(value));
      drawing = value !== null;
    });
    pen.strokeStyle = pen.fillStyle = colour;
    pen.lineWidth = 2.5;
    pen.stroke();
    if (filled && values.length > 1) {
      pen.lineTo((xs.at(-1) ?? 0) * (width - 40), height);
      pen.lineTo((xs[0] ?? 0) * (width - 40), height);
      pen.globalAlpha = 0.25;
      pen.fill();
      pen.globalAlpha = 1;
    }
    const last = values.at(-1);
    if (last !== undefined && last !== null) {
      pen.font = "600 13px system-ui, 'DejaVu Sans', sans-serif";
      pen.fillText(last.toFixed(0), width - 34, Math.max(12, Math.min(height - 3, y(last) + 4)));
    }
  }
}
