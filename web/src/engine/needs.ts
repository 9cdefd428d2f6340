// What do the rows say that core asks for?

import type { Stretch } from "./bytes.ts";
import type { PictureWant } from "./decoders.ts";
import { ROW } from "./wasm.ts";

/** A page of the index. */
export interface PageNeed extends Stretch {
  readonly page: number;
}

/** A unit's chunk. */
export interface UnitNeed extends Stretch {
  readonly unit: number;
  /** The frame that is wanted of it; null where only its bytes are. */
  readonly want: PictureWant | null;
  readonly level: number;
}

/** A unit whose chunk is handed over as it is. */
export interface WholeNeed extends Stretch {
  readonly whole: number;
}

export type Need = PageNeed | UnitNeed | WholeNeed;

export function isPage(need: Need): need is PageNeed {
  return "page" in need;
}

export function isWhole(need: Need): need is WholeNeed {
  return "whole" in need;
}

/** Whether bytes are only fetched ahead, and nothing waits for them. */
export function isEarly(need: Need): boolean {
  return !isPage(need) && !isWhole(need) && need.want === null;
}

/** Rows as `crates/web/src/needs.rs` writes them. */
export function needsOf(rows: Float64Array): Need[] {
  const needs: Need[] = [];
  for (let at = 0; at + ROW <= rows.length; at += ROW) {
    const [kind, number, offset, bytes, frame, first, frames, width, height, level] = rows.subarray(
      at,
      at + ROW,
    ) as unknown as [
      number, number, number, number, number, number, number, number, number, number,
    ];
    if (kind === 0) {
      needs.push({ page: number, offset, bytes });
      continue;
    }
    if (kind === 3) {
      needs.push({ whole: number, offset, bytes });
      continue;
    }
    const want = { unit: number, frame, first, frames, width, height };
    needs.push({ unit: number, offset, bytes, level, want: kind === 1 ? want : null });
  }
  return needs;
}
