// How does a decoded picture become three planes without gaps?

/** Columns and rows of the planes of a 4:2:0 picture. */
function planeSizes(width: number, height: number): [number, number][] {
  const half: [number, number] = [(width + 1) >> 1, (height + 1) >> 1];
  return [[width, height], half, half];
}

/** Bytes of the planes of a picture. */
export function planeBytes(width: number, height: number): number {
  return planeSizes(width, height).reduce((sum, [w, h]) => sum + w * h, 0);
}

/** Buffers of the same lengths come again and again: what is free is reused. */
export class Buffers {
  readonly #free = new Map<number, Uint8Array[]>();

  take(bytes: number): Uint8Array {
    return this.#free.get(bytes)?.pop() ?? new Uint8Array(bytes);
  }

  /** At most 64 of a length wait. */
  give(buffer: Uint8Array): void {
    const waiting = this.#free.get(buffer.length) ?? [];
    if (waiting.length < 64) waiting.push(buffer);
    this.#free.set(buffer.length, waiting);
  }
}

/** The left top part of planes that are `from` wide and high, as planes that are `to`. */
export function crop(
  planes: Uint8Array,
  from: readonly [number, number],
  to: readonly [number, number],
  out: Uint8Array,
): void {
  const [large, small] = [planeSizes(...from), planeSizes(...to)];
  let [read, write] = [0, 0];
  large.forEach(([width, height], plane) => {
    const [columns, rows] = small[plane] as [number, number];
    for (let row = 0; row < rows; row++) {
      const line = read + row * width;
      out.set(planes.subarray(line, line + columns), write + row * columns);
    }
    read += width * height;
    write += columns * rows;
  });
}

/** U and V that alternate, as two planes. */
function partChroma(mixed: Uint8Array, luma: number): Uint8Array {
  const out = new Uint8Array(mixed.length);
  out.set(mixed.subarray(0, luma));
  const half = (mixed.length - luma) >> 1;
  for (let n = 0; n < half; n++) {
    out[luma + n] = mixed[luma + 2 * n] as number;
    out[luma + half + n] = mixed[luma + 2 * n + 1] as number;
  }
  return out;
}

/** The planes of a frame, `width` by `height` of it; refuses what is not 8-bit 4:2:0. */
export async function planesOf(
  frame: VideoFrame,
  width: number,
  height: number,
  buffers: Buffers,
): Promise<Uint8Array> {
  const { format, visibleRect } = frame;
  const mixed = format === "NV12";
  if ((format !== "I420" && !mixed) || !visibleRect) {
    throw new Error(`a picture of format ${format ?? "none"}, expected 8-bit 4:2:0`);
  }
  const size: [number, number] = [visibleRect.width, visibleRect.height];
  const exact = size[0] === width && size[1] === height;
  const out = buffers.take(planeBytes(width, height));
  if (exact && !mixed) {
    await frame.copyTo(out);
    return out;
  }
  const whole = new Uint8Array(frame.allocationSize());
  await frame.copyTo(whole);
  crop(mixed ? partChroma(whole, size[0] * size[1]) : whole, size, [width, height], out);
  return out;
}
