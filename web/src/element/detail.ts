// How much detail is asked for, as attributes and addresses say it?

import type { EngineOptions, Target } from "../engine/api.ts";

/** Attributes of the element, and parameters of a page's address. */
export const DETAIL = ["target", "slope"] as const;

/** Either of them, or neither. */
export type Detail = Pick<EngineOptions, "target" | "slope">;

/** What each of them may be; as in crates/core/src/content/asked.rs. */
const RANGES = { target: [1, 9.99], slope: [0, 1] } as const;

/** The detail that texts say; `refused` hears a sentence for each that says none. */
export function detailOf(
  text: (name: (typeof DETAIL)[number]) => string | null,
  refused: (sentence: string) => void,
): Detail {
  const [target, slope] = [text("target"), text("slope")];
  if (target !== null && slope !== null) {
    refused("target and slope are both given; give one of them, as each says how much is shown.");
    return {};
  }
  if (target === "none") return { target };
  if (target !== null) {
    const jod = numberOf(target, RANGES.target);
    if (jod !== null) return { target: jod satisfies Target };
    refused(`target is ${said(target)}; give a score of 1 to 9.99, or none.`);
  }
  if (slope !== null) {
    const degrees = numberOf(slope, RANGES.slope);
    if (degrees !== null) return { slope: degrees };
    refused(`slope is ${said(slope)}; give 0 to 1 degree a degree.`);
  }
  return {};
}

function numberOf(text: string, [least, most]: readonly [number, number]): number | null {
  const number = text.trim() === "" ? Number.NaN : Number(text);
  return number >= least && number <= most ? number : null;
}

const said = (text: string): string => (text === "" ? "empty" : text);
