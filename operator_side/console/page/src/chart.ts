// Lines over time on a canvas.
import { css } from "./view.ts";

export interface Line {
  /** null: nothing is known then, and nothing is drawn. */
  values: (number | null)[];
  colour: string;
  filled: boolean;
}

const ROOM = 40; // px for the newest number

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
  const written: number[] = [];
  for (const { values, colour, filled } of lines) {
    pen.strokeStyle = pen.fillStyle = css(colour);
    pen.lineWidth = 2.5;
    trace(pen, xs, values, width - ROOM, y);
    if (filled && values.length > 1) {
      pen.lineTo((xs.at(-1) ?? 0) * (width - ROOM), height);
      pen.lineTo((xs[0] ?? 0) * (width - ROOM), height);
      pen.globalAlpha = 0.25;
      pen.fill();
      pen.globalAlpha = 1;
    }
    const last = values.at(-1);
    if (last === undefined || last === null) continue;
    pen.font = "600 13px system-ui, 'DejaVu Sans', sans-serif";
    let at = Math.max(12, Math.min(height - 3, y(last) + 4));
    for (const other of written) if (Math.abs(other - at) < 14) at = other > 26 ? other - 14 : other + 14;
    written.push(at);
    pen.fillText(last.toFixed(0), width - ROOM + 6, at);
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
