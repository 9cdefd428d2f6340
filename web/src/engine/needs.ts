// What does core ask for, and what is there to do for bytes that came?

import type { PictureWant } from "./decoders.ts";
import type { Want } from "./plan.ts";
import type { Pack, Show } from "./wasm.ts";

/** A stretch of the file that is needed; `Need` of `crates/web/src/stretches.rs`. */
export interface Need extends Want {
  /** Of a tile: the picture to decode of it. */
  readonly picture?: PictureWant;
  /** The unit of a tile that may be shown soon: its bytes wait in memory. */
  readonly ahead?: number;
}

/** What there is to do for a stretch that came; `Arrival` of `crates/web/src/stretches.rs`. */
export type Arrival =
  /** Nothing: it was taken, or cannot be had. */
  | "taken"
  /** It was taken, and says what is needed next. */
  | "more"
  /** It is damaged: fetch it again. */
  | "again"
  /** Decode it: where its access units begin, and where the last one ends. */
  | { readonly decode: readonly number[] };

/** What asks for stretches, first what matters most: a pack that opens, or one that plays. */
export type Source = Pack | Show;
