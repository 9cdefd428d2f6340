// What is seen of a pack until the graphics device has drawn its first picture?
//
// The same picture, coarse and small, by the processor: it waits for no device.

import type { HostOptions } from "./calls.ts";
import { FLAG, type Pack, Show } from "./wasm.ts";

/** Columns or rows that the processor draws at most. */
const MOST_SIDE = 480;

/** The size that the processor draws for a canvas of this size. */
export function softwareSize([width, height]: readonly [number, number]): [number, number] {
  const scale = Math.min(1, MOST_SIDE / Math.max(width, height));
  const side = (of: number) => Math.max(1, Math.round(of * scale));
  return [side(width), side(height)];
}

export class Poster {
  readonly show: Show;
  readonly #canvas: OffscreenCanvas;

  /** Begins to show a pack with the options of {@link Show}. */
  constructor(pack: Pack, told: Readonly<Record<string, unknown>>, begin: HostOptions) {
    const size = softwareSize(begin.options.size);
    this.#canvas = new OffscreenCanvas(...size);
    const plain = { ...told, size, policy: "coarsest", poster: true, paused: true, log: false };
    this.show = new Show(this.#canvas, pack, undefined, JSON.stringify(plain));
    if (begin.time > 0) this.show.seek(begin.time, 0);
  }

  /** Moves on to `now`; the picture, once what it shows has come. */
  step(now: number): ImageBitmap | null {
    if ((this.show.step(now) & FLAG.draw) === 0) return null;
    this.show.draw();
    return this.#canvas.transferToImageBitmap();
  }
}
