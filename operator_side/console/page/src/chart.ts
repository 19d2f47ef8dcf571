// Lines over time on a canvas.
import { css } from "./view.ts";

export interface Line {
  /** null: nothing is known then, and nothing is drawn. */
  values: (number | null)[];
  colour: string;
  filled: boolean;
  /** Whether its newest value is left out beside it. */
  silent?: boolean;
}

const ROOM = 40; // px for the newest number
const NUMBER = 13; // px: how high one is

export function chart(canvas: HTMLCanvasElement, xs: number[], most: number, lines: Line[]): void {
  const ratio = devicePixelRatio;
  const { clientWidth: width, clientHeight: height } = canvas;
  if (width === 0) return;
  canvas.width = width * ratio;
  canvas.height = height * ratio;
  const pen = canvas.getContext("2d");
  if (!pen) return;
  pen.scale(ratio, ratio);
  const y = (value: number) => height - 2 - (Math.max(0, Math.min(most, value)) / most) * (height - 6);
  pen.strokeStyle = css("--line");
  pen.strokeRect(0, height - 1, width - ROOM, 0);
  const written: { text: string; colour: string; at: number }[] = [];
  for (const { values, colour, filled, silent } of lines) {
    pen.strokeStyle = pen.fillStyle = css(colour);
    pen.lineWidth = silent ? 1.5 : 2.5;
    trace(pen, xs, values, width - ROOM, y);
    if (filled && values.length > 1) {
      pen.lineTo((xs.at(-1) ?? 0) * (width - ROOM), height);
      pen.lineTo((xs[0] ?? 0) * (width - ROOM), height);
      pen.globalAlpha = 0.25;
      pen.fill();
      pen.globalAlpha = 1;
    }
    const last = values.at(-1);
    if (!silent && last !== undefined && last !== null) written.push({ text: last.toFixed(0), colour: css(colour), at: y(last) + 4 });
  }
  pen.font = "600 13px system-ui, 'DejaVu Sans', sans-serif";
  written.sort((one, other) => one.at - other.at);
  for (const [k, each] of written.entries()) {
    const above = written[k - 1];
    const lowest = height - 3 - NUMBER * (written.length - 1 - k); // as many come below
    each.at = Math.min(lowest, Math.max(each.at, above ? above.at + NUMBER : 11));
    pen.fillStyle = each.colour;
    pen.fillText(each.text, width - ROOM + 6, each.at);
  }
}

function trace(pen: CanvasRenderingContext2D, xs: number[], values: (number | null)[], width: number, y: (value: number) => number): void {
  pen.beginPath();
  let drawing = false;
  values.forEach((value, k) => {
    const x = (xs[k] ?? 0) * width;
    if (value !== null && drawing) pen.lineTo(x, y(value));
    else if (value !== null) pen.moveTo(x, y(value));
    drawing = value !== null;
  });
  pen.stroke();
}
