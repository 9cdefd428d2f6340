// How is the wasm module loaded, once in a thread?

import init, { Device, Pack, Show } from "../../pkg/foveal.js";

let loaded: Promise<unknown> | null = null;

/** Loads and compiles the module; the second time it is there. */
export function loadWasm(): Promise<unknown> {
  loaded ??= init();
  return loaded;
}

/** Bits of what a step returns; `flag` of `crates/web/src/page_player.rs`. */
export const FLAG = { draw: 1, settled: 2, wants: 4, again: 8, ended: 16, hopeless: 32 } as const;

export { Device, Pack, Show };
