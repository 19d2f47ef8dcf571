// What the page knows better than the console, in the same words as its reasons. Knows no browser.
import type { Reason } from "./told.ts";

export interface Known {
  /** Why the console sent this page away; empty: it did not. */
  refused: string;
  /** How long the console has been silent (s); null: it is not. */
  silent: number | null;
  /** Why the camera locks driving; empty: it does not. */
  camera: string;
  /** Whether the connection has just come back and nothing is held down. */
  back: boolean;
  /** What gamepad or step have to say; empty: nothing. */
  hint: string;
  /** Why what was held here was let go by itself, or did not begin; empty: it was not, or that is past. */
  cut: string;
  /** Whether something is still held down, and does not count any more. */
  inVain: boolean;
}

const WORSE = ["link lost", "e-stop", "stopped", "taken"];

/** In the order in which they count: why nobody can drive, before what became of a press. */
export function pageReasons(known: Known, told: Reason[]): Reason[] {
  if (known.refused) return [{ pill: "link lost", what: known.refused, clears: "See to that, then reload this page." }];
  if (known.silent !== null)
    return [
      {
        pill: "link lost",
        what: `The console is silent for ${known.silent.toFixed(1)} s. Driving is locked.`,
        clears: "It is found again by itself; then press anew.",
      },
    ];
  if (known.camera) told = told.filter((each) => !each.what.startsWith("The camera shows nothing new")); // said by the page itself
  const worse = told.filter((each) => WORSE.includes(each.pill) || each.what.endsWith("Driving is locked."));
  const rest = told.filter((each) => !worse.includes(each));
  const own: Reason[] = [];
  if (known.camera)
    own.push({
      pill: "held",
      what: known.camera,
      clears: "It unlocks by itself when the camera moves again, or drive without it; then press anew.",
    });
  const again =
    told.map(({ what }) => /^Connected again after [\d.]+ s\. /.exec(what)?.[0]).find(Boolean) ?? (known.back ? "Connected again. " : "");
  if (known.inVain)
    own.push({
      pill: "held",
      what: known.cut
        ? `${again}Let go by itself: ${known.cut}; let go and press anew.`
        : "What is held down does not count: let go and press anew.",
      clears: "Let go, and press anew.",
    });
  else if (known.cut) own.push({ pill: "held", what: `${again}Let go by itself: ${known.cut}.`, clears: "Press anew." });
  if (known.hint) own.push({ pill: "held", what: known.hint, clears: "" });
  const pill = told.some((each) => each.pill === "watching") ? "watching" : "ready";
  if (known.back) own.push({ pill, what: "Connected again. Nothing is driven until somebody presses anew.", clears: "" });
  return [...worse, ...own, ...rest];
}
