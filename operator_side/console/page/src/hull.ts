// Outlines of points on a screen. Knows no browser.

export type Point = [number, number];

/** The convex hull, in order (Andrew's monotone chain). */
export function hull(points: Point[]): Point[] {
  const sorted = [...points].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const half = (all: Point[]): Point[] => {
    const chain: Point[] = [];
    for (const p of all) {
      for (;;) {
        const [a, b] = chain.slice(-2);
        if (!a || !b || (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) > 0) break;
        chain.pop();
      }
      chain.push(p);
    }
    return chain.slice(0, -1);
  };
  const around = [...half(sorted), ...half(sorted.reverse())];
  return around.length > 0 ? around : points.slice(0, 1);
}
