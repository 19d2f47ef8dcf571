// The least of what the robot measured, whose it is, and what that part keeps. Knows no browser.
import { keptText, type MarginTold } from "./margin.ts";

interface StateTold {
  clearance: number;
  arm_clearance?: number | null;
}

interface GuardTold {
  part: string;
  distance: number;
  limit: number;
}

export interface Least {
  /** `tool`, `arm`, or the part of the arm where it is known. */
  part: string;
  /** m */
  value: number;
  /** What it is compared with (m): of the tool limit and margin, of the arm the limit alone; null: not known. */
  kept: number | null;
  limit: number | null;
  /** `tool 172`: the other figure (mm); empty: there is none. */
  other: string;
  isTool: boolean;
}

const SAME = 0.003; // m: the guard's part is the nearest one where it says the same distance

/** Of the sphere around the tool, and the whole arm where the robot computes it. */
export function leastOf(state: StateTold, report: MarginTold | null, guard: GuardTold | null): Least {
  const tool = state.clearance;
  const arm = state.arm_clearance ?? null;
  const limit = report?.limit ?? null;
  const whole = (metres: number) => (metres * 1000).toFixed(0);
  if (arm !== null && arm < tool) {
    const named = guard !== null && Math.abs(guard.distance - arm) < SAME;
    const own = named ? guard.limit : limit;
    return { part: named ? guard.part : "arm", value: arm, kept: own, limit: own, other: `tool ${whole(tool)}`, isTool: false };
  }
  const kept = report ? (limit ?? 0) + report.inflation + report.sigma : null;
  return { part: "tool", value: tool, kept, limit, other: arm === null ? "" : `arm ${whole(arm)}`, isTool: true };
}

/** What the bar's marks are. */
export function keptOf(least: Least, report: MarginTold): string {
  if (least.isTool) return keptText(report);
  if (report.limit == null || least.limit === null) return `tool ${keptText(report)}`;
  const margin = Math.round((report.inflation + report.sigma) * 1000);
  const limit = Math.round(report.limit * 1000);
  return `arm limit ${Math.round(least.limit * 1000)}; tool ${limit + margin} = limit + margin ${margin}`;
}
