// What makes the margin as large as it is, in words that add up. Knows no browser.

export interface MarginTold {
  inflation: number;
  sigma: number;
  limit?: number | null;
  margin_parts?: Record<string, number>;
}

const WORDS: Record<string, string> = { floor: "least", delay: "delay", jitter: "jitter", lag: "lag" };

/** The margin (m) and its parts, largest last; what is above the floor of an adaptive margin is the network's. */
export function marginParts(report: MarginTold): { total: number; parts: [string, number][] } {
  const total = report.inflation + report.sigma;
  const told = report.margin_parts ?? {};
  const parts: [string, number][] = [];
  for (const [name, value] of Object.entries(told)) {
    const word = WORDS[name];
    if (word && value > 0) parts.push([word, Math.min(value, total)]);
  }
  const rest = total - parts.reduce((sum, [, value]) => sum + value, 0);
  if (rest > 5e-4 && ("innovation" in told || "spread" in told)) parts.push(["network", rest]);
  else if (rest > 5e-4 && parts.length > 0) parts.push(["other", rest]);
  return { total, parts };
}

/** `keeps 34 = limit 10 + margin 24`, in mm. */
export function keptText(report: MarginTold): string {
  const margin = Math.round((report.inflation + report.sigma) * 1000);
  if (report.limit == null) return `margin ${margin}`;
  const limit = Math.round(report.limit * 1000);
  return `keeps ${limit + margin} = limit ${limit} + margin ${margin}`;
}

/** `margin 24 = 10 least + 9 network + 5 lag`, in mm: whole ones that add up. */
export function marginText(report: MarginTold): string {
  const { total, parts } = marginParts(report);
  const sum = Math.round(total * 1000);
  if (parts.length < 2) return `margin ${sum}${parts[0] && parts[0][0] === "network" ? ", all network" : ""}`;
  const whole = parts.map(([word, value]): [string, number] => [word, Math.round(value * 1000)]);
  const off = sum - whole.reduce((all, [, value]) => all + value, 0);
  const most = whole.reduce((best, each) => (each[1] > best[1] ? each : best));
  most[1] += off; // what rounding took, from the largest
  const seen = whole.filter(([, value]) => value > 0);
  if (seen.length < 2) return `margin ${sum}`;
  return `margin ${sum} = ${seen.map(([word, value]) => `${value} ${word}`).join(" + ")}`;
}
