// A finger on a stick or slider as shares: nothing near the middle, all at the rim. Knows no browser.

const DEAD = 0.12; // share of the radius

/** Shares (x to the right, y up) of a finger at (dx, dy) px from a stick's middle, y down as on screens. */
export function stickShares(dx: number, dy: number, radius: number): [number, number] {
  const length = Math.hypot(dx, dy);
  const share = beyondDead(length / radius);
  return share === 0 ? [0, 0] : [(share * dx) / length, (0 - share * dy) / length];
}

/** Share of a finger at `d` px from a slider's middle. */
export function sliderShare(d: number, half: number): number {
  return Math.sign(d) * beyondDead(Math.abs(d) / half) || 0;
}

/** 0 up to `dead`, 1 from 1 on, straight between. */
export function beyondDead(share: number, dead = DEAD): number {
  return Math.max(0, Math.min(1, (share - dead) / (1 - dead)));
}
