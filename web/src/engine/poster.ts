// What is seen of a pack until the graphics device has drawn its first picture?
//
// The same picture, coarse and small, by the processor: it waits for no device.

import type { HostOptions } from "./calls.ts";
import { FLAG, Show } from "./wasm.ts";

/** Columns or rows that the processor draws at most. */
const MOST_SIDE = 480;

/** The size that the processor draws for a canvas of this size. */
export function softwareSize([width, height]: readonly [number, number]): [number, number] {
  const scale = Math.min(1, MOST_SIDE / Math.max(width, height));
  const side = (of: number) => Math.max(1, Math.round(of * scale));
  return [side(width), side(height)];
}

export class Poster {
  private constructor(
    readonly show: Show,
    private readonly canvas: OffscreenCanvas,
  ) {}

  /** Begins to show a pack by its beginning, what it needs besides that, and the options of
   *  {@link Show.open}. */
  static async open(
    head: Uint8Array,
    rest: Uint8Array,
    told: Readonly<Record<string, unknown>>,
    begin: HostOptions,
  ): Promise<Poster> {
    const size = softwareSize(begin.options.size);
    const canvas = new OffscreenCanvas(...size);
    const plain = { ...told, size, policy: "coarsest", software: true, paused: true, log: false };
    const show = await Show.open(canvas, head, rest, JSON.stringify(plain));
    if (begin.time > 0) show.seek(begin.time, 0);
    return new Poster(show, canvas);
  }

  /** Moves on to `now`; the picture, once what it shows has come. */
  step(now: number): ImageBitmap | null {
    if ((this.show.step(now) & FLAG.draw) === 0) return null;
    this.show.draw();
    return this.canvas.transferToImageBitmap();
  }
}
