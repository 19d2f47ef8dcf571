// Whether frames come fast enough for three dimensions. Knows no browser.

export const SLOW_FPS = 20;
export const SLOW_FOR_MS = 2000;
const GAP_MS = 3000; // longer: the page was hidden or asleep, which says nothing

export class Pace {
  private times: number[] = [];
  private slowSince: number | null = null;

  /** Frames a second over the last second or so; 0: not known yet. */
  get fps(): number {
    const first = this.times[0];
    const last = this.times.at(-1);
    return first === undefined || last === undefined || last === first ? 0 : ((this.times.length - 1) * 1000) / (last - first);
  }

  /** A frame is drawn at `now` (ms); returns whether they have been slow for long enough. */
  frame(now: number): boolean {
    const last = this.times.at(-1);
    if (last !== undefined && now - last > GAP_MS) this.reset();
    this.times.push(now);
    while (this.times.length > 2 && now - (this.times[0] ?? now) > 1000) this.times.shift();
    if (this.times.length < 2 || this.fps >= SLOW_FPS) this.slowSince = null;
    else this.slowSince ??= this.times[0] ?? now;
    return this.slowSince !== null && now - this.slowSince >= SLOW_FOR_MS;
  }

  reset(): void {
    this.times = [];
    this.slowSince = null;
  }
}
