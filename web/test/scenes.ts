// What do the tests look at?
//
// Pictures whose colour says where and when they are: a sphere whose red grows with yaw and whose
// green grows with pitch, a flat picture whose red grows to the right and green downwards, both
// with blue that grows with time, and grain that only the finest level holds.

import type { Planes } from "./avi.ts";

export const FRAMES = 50;
export const FRAMES_PER_SECOND = 25;

type Rgb = readonly [number, number, number];

/** BT.709 of limited range. */
function codes([r, g, b]: Rgb): Rgb {
  const y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
  const chroma = (difference: number, range: number): number =>
    128 + (difference / range) * (224 / 255);
  return [16 + (219 * y) / 255, chroma(b - y, 1.8556), chroma(r - y, 1.5748)];
}

/** The colour at a place (0 to 1 to the right and downwards) in frame `frame`. */
export function colourAt(x: number, y: number, frame: number): Rgb {
  return [32 + 192 * x, 32 + 192 * y, 32 + (192 * frame) / FRAMES];
}

/** Every frame of a clip of this size. */
export function pictures([width, height]: readonly [number, number]): Planes[] {
  const [cw, ch] = [width / 2, height / 2];
  const first: [Float32Array, Float32Array, Float32Array] = [
    new Float32Array(width * height),
    new Float32Array(cw * ch),
    new Float32Array(cw * ch),
  ];
  const [y, u, v] = first;
  for (let row = 0; row < height; row += 1) {
    for (let column = 0; column < width; column += 1) {
      const colour = colourAt((column + 0.5) / width, (row + 0.5) / height, 0);
      const [luma, blue, red] = codes(colour);
      y[row * width + column] = luma;
      const chroma = (row >> 1) * cw + (column >> 1);
      u[chroma] = blue;
      v[chroma] = red;
    }
  }
  const before = codes(colourAt(0, 0, 0));
  const after = codes(colourAt(0, 0, 1));
  const each = after.map((code, plane) => code - (before[plane] ?? 0));
  return Array.from({ length: FRAMES }, (_, frame) => {
    const moved = (plane: Float32Array, number: number, grain: number): Uint8Array => {
      const later = frame * (each[number] ?? 0);
      const out = new Uint8Array(plane.length);
      let state = frame + 1;
      // A loop: `Uint8Array.from` makes a list of numbers first.
      for (let at = 0; at < out.length; at += 1) {
        state = (Math.imul(state, 1_664_525) + 1_013_904_223) >>> 0;
        out[at] = Math.round((plane[at] ?? 0) + later + grain * (state / 2 ** 31 - 1));
      }
      return out;
    };
    // Grain in luma averages out on every coarser level, and makes the file as large as real ones.
    return [moved(y, 0, GRAIN), moved(u, 1, 0), moved(v, 2, 0)];
  });
}

/** How far grain goes from what is round it, in code values. */
const GRAIN = 16;

/** A tone for as long as the pictures last, that starts over with every fifth frame. */
export function sound(): Float32Array {
  const rate = 48_000;
  const length = (FRAMES / FRAMES_PER_SECOND) * rate;
  const beat = rate / 5;
  return Float32Array.from({ length }, (_, at) => {
    const since = (at % beat) / rate;
    return 0.8 * Math.exp(-60 * since) * Math.sin(2 * Math.PI * 880 * since);
  });
}
