// Which colours does a screenshot have?

import { inflateSync } from "node:zlib";

type Rgb = readonly [number, number, number];

/** A picture of 8-bit RGB or RGBA, as browsers write screenshots. */
export class PNG {
  private constructor(
    readonly width: number,
    readonly height: number,
    private readonly channels: number,
    private readonly samples: Uint8Array,
  ) {}

  static parse(file: Buffer): PNG {
    const parts: Buffer[] = [];
    let [width, height, channels] = [0, 0, 0];
    for (let at = 8; at < file.length; ) {
      const length = file.readUInt32BE(at);
      const name = file.toString("latin1", at + 4, at + 8);
      const body = file.subarray(at + 8, at + 8 + length);
      if (name === "IHDR") {
        [width, height] = [body.readUInt32BE(0), body.readUInt32BE(4)];
        channels = body[9] === 6 ? 4 : 3;
      }
      if (name === "IDAT") parts.push(body);
      at += 12 + length;
    }
    const rows = inflateSync(Buffer.concat(parts));
    return new PNG(width, height, channels, unfiltered(rows, width * channels, height, channels));
  }

  /** Samples of red, green and blue that differ from those of RGBA pixels of the same size. */
  differing(rgba: Uint8Array): number {
    if (rgba.length !== this.width * this.height * 4) return Number.POSITIVE_INFINITY;
    let count = 0;
    for (let at = 0; at < this.width * this.height; at += 1) {
      for (let k = 0; k < 3; k += 1) {
        if (this.samples[at * this.channels + k] !== rgba[at * 4 + k]) count += 1;
      }
    }
    return count;
  }

  /** The colour at a place from 0 to 1, averaged over a square of 9 pixels. */
  at(x: number, y: number): Rgb {
    const [column, row] = [Math.round(x * (this.width - 1)), Math.round(y * (this.height - 1))];
    const sum = [0, 0, 0];
    let count = 0;
    for (let j = Math.max(0, row - 4); j <= Math.min(this.height - 1, row + 4); j += 1) {
      for (let i = Math.max(0, column - 4); i <= Math.min(this.width - 1, column + 4); i += 1) {
        const at = (j * this.width + i) * this.channels;
        for (let k = 0; k < 3; k += 1) sum[k] = (sum[k] ?? 0) + (this.samples[at + k] ?? 0);
        count += 1;
      }
    }
    const [r = 0, g = 0, b = 0] = sum.map((one) => one / count);
    return [r, g, b];
  }

  /** How much neighbouring pixels of a row differ round a place: what fine detail there is. */
  detail(x: number, y: number, reach = 24): number {
    const [column, row] = [Math.round(x * (this.width - 1)), Math.round(y * (this.height - 1))];
    let [sum, count] = [0, 0];
    for (let j = Math.max(0, row - reach); j <= Math.min(this.height - 1, row + reach); j += 1) {
      const from = Math.max(1, column - reach);
      for (let i = from; i <= Math.min(this.width - 1, column + reach); i += 1) {
        const at = (j * this.width + i) * this.channels + 1;
        sum += Math.abs((this.samples[at] ?? 0) - (this.samples[at - this.channels] ?? 0));
        count += 1;
      }
    }
    return sum / Math.max(1, count);
  }
}

function unfiltered(rows: Buffer, stride: number, height: number, bytes: number): Uint8Array {
  const out = new Uint8Array(stride * height);
  for (let y = 0; y < height; y += 1) {
    const filter = rows[y * (stride + 1)] ?? 0;
    for (let x = 0; x < stride; x += 1) {
      const raw = rows[y * (stride + 1) + 1 + x] ?? 0;
      const left = x >= bytes ? (out[y * stride + x - bytes] ?? 0) : 0;
      const up = y > 0 ? (out[(y - 1) * stride + x] ?? 0) : 0;
      const corner = x >= bytes && y > 0 ? (out[(y - 1) * stride + x - bytes] ?? 0) : 0;
      out[y * stride + x] = (raw + predicted(filter, left, up, corner)) & 0xff;
    }
  }
  return out;
}

function predicted(filter: number, left: number, up: number, corner: number): number {
  switch (filter) {
    case 1:
      return left;
    case 2:
      return up;
    case 3:
      return (left + up) >> 1;
    case 4: {
      const [a, b] = [Math.abs(up - corner), Math.abs(left - corner)];
      const c = Math.abs(left + up - 2 * corner);
      return a <= b && a <= c ? left : b <= c ? up : corner;
    }
    default:
      return 0;
  }
}
