// What does the element report to the page that holds it?

import type { EngineEvents, EngineProblem, PackFacts, Stats } from "../engine/api.ts";
import { isProblem } from "../engine/problem.ts";

/** Events of the element and what their `detail` is. */
export interface FovealViewEvents {
  /** The pack is understood. */
  ready: PackFacts;
  /** The first picture is there, after so many seconds. */
  picture: number;
  /** All that is wanted in view is shown. */
  settled: Stats;
  /** Twice a second while something changes. */
  stats: Stats;
  /** Something cannot be shown; `message` is a sentence for people. */
  problem: EngineProblem;
  /** The host has another file under this address now. */
  changed: string;
  lost: EngineEvents["lost"];
  restored: EngineEvents["restored"];
  play: number;
  pause: number;
  ended: number;
  /** The gaze's sender is heard, or not any more. */
  gazeconnection: boolean;
  /** A headset was entered (true) or left. */
  headset: boolean;
}

/** How an event is reported. */
export type Tell = <K extends keyof FovealViewEvents>(name: K, detail: FovealViewEvents[K]) => void;

/** What was thrown, as a problem. */
export function problemOf(thrown: unknown): EngineProblem {
  if (isProblem(thrown)) return thrown;
  const message = thrown instanceof Error ? thrown.message : String(thrown);
  return { kind: "internal", message, fatal: true };
}
