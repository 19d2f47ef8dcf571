// Words that stay beside things in the scene, and make way for each other.
import type { Vector3 } from "three";
import { element } from "./dom.ts";
import type { Word } from "./world.ts";

const TOP = 44; // px: what is chosen lies there
const LEGEND = [162, 140] as const; // px, with the edge
const CAMERA = [152, 160] as const;
const UPRIGHT = matchMedia("(max-width: 760px)");

type Project = (at: Vector3) => [number, number] | null;

export class Labels {
  private readonly spans = new Map<string, { span: HTMLSpanElement; width: number; height: number }>();

  constructor(private readonly parent: HTMLElement) {}

  show(words: Word[], project: Project): void {
    const { clientWidth: width, clientHeight } = this.parent.parentElement ?? this.parent;
    const height = UPRIGHT.matches ? element("pads").offsetTop : clientHeight; // sticks fill the width of a phone
    const taken = [this.corner(width)];
    const shown = new Set<string>();
    for (const word of words) {
      const at = project(word.at);
      if (!at) continue;
      shown.add(word.name);
      const each = this.span(word);
      const x = Math.max(4, Math.min(width - each.width - 4, at[0] + word.dx - each.width / 2));
      let y = Math.max(TOP, Math.min(height - each.height - 4, at[1] + word.dy));
      for (const [left, top, right, bottom] of taken)
        if (x < right && x + each.width > left && y < bottom && y + each.height > top) y = bottom + 2;
      taken.push([x, y, x + each.width, y + each.height]);
      each.span.style.transform = `translate(${x.toFixed(0)}px, ${y.toFixed(0)}px)`;
    }
    for (const [name, { span }] of this.spans) span.hidden = !shown.has(name);
  }

  /** What lies over the picture at its upper right: the legend, on a phone the camera. */
  private corner(width: number): [number, number, number, number] {
    const camera = element("camera").dataset.look !== "none";
    const [across, down] = UPRIGHT.matches ? (camera ? CAMERA : [0, 0]) : LEGEND;
    return [width - across, 0, width, down];
  }

  private span(word: Word): { span: HTMLSpanElement; width: number; height: number } {
    let each = this.spans.get(word.name);
    if (!each) {
      each = { span: document.createElement("span"), width: 0, height: 0 };
      this.parent.append(each.span);
      this.spans.set(word.name, each);
    }
    const { span } = each;
    span.hidden = false;
    if (span.className !== word.kind) span.className = word.kind;
    if (span.textContent !== word.text) {
      const longer = span.textContent?.length !== word.text.length;
      span.textContent = word.text;
      if (longer || each.width === 0) {
        each.width = span.offsetWidth; // laid out anew only then: it costs
        each.height = span.offsetHeight;
      }
    }
    return each;
  }
}
