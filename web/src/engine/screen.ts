// How large does the screen appear to its viewer?

import type { EngineOptions } from "./api.ts";
import type { HostOptions } from "./calls.ts";

/** A desk: 24 inches at 0.6 m, as natively. */
const DESK = { diagonal_inches: 24, distance_m: 0.6 };
/** A tablet, and a phone in the hand. */
const TABLET = { diagonal_inches: 11, distance_m: 0.4 };
const PHONE = { diagonal_inches: 6.2, distance_m: 0.3 };

/** The screen that the page says, or what this device's most likely is. */
export function screenOf(options: EngineOptions): Pick<HostOptions, "screen" | "screenSize"> {
  const ratio = globalThis.devicePixelRatio || 1;
  const { width, height } = globalThis.screen;
  if (options.screen) {
    const { pixels, diagonalInches, distanceM } = options.screen;
    const screen = { diagonal_inches: diagonalInches, distance_m: distanceM };
    return { screenSize: pixels, screen };
  }
  const screenSize = [Math.round(width * ratio), Math.round(height * ratio)] as const;
  const byTouch = matchMedia("(pointer: coarse)").matches;
  const small = Math.min(width, height) < 600;
  return { screenSize, screen: byTouch ? (small ? PHONE : TABLET) : DESK };
}
