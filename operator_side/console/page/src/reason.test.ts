import assert from "node:assert/strict";
import { test } from "node:test";
import { pageReasons } from "./reason.ts";
import type { Reason } from "./told.ts";

const NOTHING = { refused: "", silent: null, camera: "", back: false, hint: "", cut: "", inVain: false };
const reason = (pill: string): Reason => ({ pill, what: pill, clears: "" });
const pills = (found: Reason[]) => found.map((each) => each.pill);

test("what the console says stands, where the page knows nothing better", () => {
  assert.deepEqual(pills(pageReasons(NOTHING, [reason("run")])), ["run"]);
});

test("a console that is silent knows nothing any more", () => {
  assert.deepEqual(pills(pageReasons({ ...NOTHING, silent: 1.23 }, [reason("run")])), ["link lost"]);
});

test("a frozen camera comes before what moves, and after what stops", () => {
  const known = { ...NOTHING, camera: "The camera frozen, 3 s." };
  assert.deepEqual(pills(pageReasons(known, [reason("e-stop"), reason("ready")])), ["e-stop", "held", "ready"]);
});

test("a frozen camera is said once, where console and page both know of it", () => {
  const known = { ...NOTHING, camera: "The camera has been frozen for 3 s. Driving is locked." };
  const twice = { pill: "held", what: "The camera shows nothing new for 2.9 s. Driving is locked.", clears: "" };
  assert.deepEqual(pills(pageReasons(known, [reason("link lost"), twice])), ["link lost", "held"]);
});

test("what is held down and does not count any more is said for as long as it is held, with what to do", () => {
  const [first] = pageReasons({ ...NOTHING, cut: "this page was not heard for a moment", inVain: true }, [reason("ready")]);
  assert.deepEqual([first?.pill, first?.what], ["held", "Let go by itself: this page was not heard for a moment; let go and press anew."]);
  assert.match(pageReasons({ ...NOTHING, inVain: true }, [reason("ready")])[0]?.what ?? "", /does not count/);
});

test("why nobody can drive comes before what became of a press", () => {
  const frozen = { pill: "held", what: "The camera shows nothing new for 2.1 s. Driving is locked.", clears: "" };
  const [first] = pageReasons({ ...NOTHING, cut: "the camera showed nothing new", inVain: true }, [frozen]);
  assert.equal(first, frozen);
});
