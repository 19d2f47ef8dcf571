// What is said again while the page is busy drawing: only what is held down, and only for a moment. Knows no browser.

export const PERIOD_MS = 20;
/** Longer than this the page itself must have said it; then the console's own watchdog has the word. */
export const FRESH_MS = 100;

export class Repeat<T extends { engaged: boolean; press: number }> {
  private steer: T | null = null;
  private at = -Infinity;
  private sent = -Infinity;

  /** What the page says, and when it did (ms); returns whether it must go at once. */
  take(steer: T, at: number, now: number): boolean {
    const changed = !this.steer || this.steer.engaged !== steer.engaged || this.steer.press !== steer.press;
    this.steer = steer;
    this.at = at;
    if (!steer.engaged) return true;
    return now - at <= FRESH_MS && (changed || now - this.sent >= PERIOD_MS - 4);
  }

  /** What to say at `now`; null: nothing that counts. */
  next(now: number): T | null {
    if (!this.steer?.engaged || now - this.at > FRESH_MS || now - this.sent < PERIOD_MS - 4) return null;
    return this.steer;
  }

  went(now: number): void {
    this.sent = now;
  }

  /** Nothing of before counts. */
  forget(): void {
    this.steer = null;
  }
}
