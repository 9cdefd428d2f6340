// How do tiles that are picture files become planes?

import type { DecoderEvents, PictureWant } from "./decoders.ts";
import { Buffers, planeBytes, planesOf } from "./planes.ts";

/** Pictures that are decoded at once. */
const MOST = 8;

/** Decodes JPEG and PNG tiles; the same calls as {@link Decoders}. */
export class Stills {
  readonly buffers = new Buffers();
  ms = 0;
  readonly #type: string;
  readonly #events: DecoderEvents;
  #wants: readonly PictureWant[] = [];
  #under = new Set<string>();
  #closed = false;

  constructor(codec: string, events: DecoderEvents) {
    this.#type = `image/${codec}`;
    this.#events = events;
  }

  want(wants: readonly PictureWant[]): void {
    this.#wants = wants;
    this.go();
  }

  go(): void {
    for (const want of this.#wants) {
      const name = `${want.unit}:${want.frame}`;
      if (this.#closed || this.#under.size >= MOST) return;
      if (this.#under.has(name)) continue;
      const data = this.#events.chunk(want.unit)?.[want.frame - want.first];
      if (!data) continue;
      this.#under.add(name);
      const began = performance.now();
      const done = () => {
        this.#under.delete(name);
        this.#wants = this.#wants.filter((other) => other !== want);
        const passed = performance.now() - began;
        this.ms += (passed - this.ms) * (this.ms === 0 ? 1 : 0.1);
      };
      void this.#decode(data, want).then(
        (planes) => {
          done();
          if (!this.#closed) this.#events.picture(want, 1, planes);
          this.go();
        },
        (error: unknown) => {
          done();
          if (!this.#closed) this.#events.failed(want, String(error));
          this.go();
        },
      );
    }
  }

  close(): void {
    this.#closed = true;
  }

  async #decode(data: Uint8Array, want: PictureWant): Promise<Uint8Array> {
    const decoder = new ImageDecoder({
      data: data.slice(),
      type: this.#type,
      colorSpaceConversion: "none",
    });
    try {
      const { image } = await decoder.decode();
      try {
        if (this.#type === "image/png") return await this.#stacked(image, want);
        return await planesOf(image, want.width, want.height, this.buffers);
      } finally {
        image.close();
      }
    } finally {
      decoder.close();
    }
  }

  /** The planes of a grey picture whose rows are those of Y, then U, then V. */
  async #stacked(image: VideoFrame, want: PictureWant): Promise<Uint8Array> {
    const { width, height } = want;
    const columns = image.codedWidth;
    const rgba = new Uint8Array(columns * image.codedHeight * 4);
    await image.copyTo(rgba, { format: "RGBA", layout: [{ offset: 0, stride: columns * 4 }] });
    const out = this.buffers.take(planeBytes(width, height));
    const half = [(width + 1) >> 1, (height + 1) >> 1] as const;
    let [row, write] = [0, 0];
    for (const [w, h] of [[width, height] as const, half, half]) {
      for (let y = 0; y < h; y++, row++) {
        for (let x = 0; x < w; x++) out[write++] = rgba[(row * columns + x) * 4] as number;
      }
    }
    return out;
  }
}
