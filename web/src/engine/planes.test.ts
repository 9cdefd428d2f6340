import { expect, test } from "vitest";
import { Buffers, crop, planeBytes } from "./planes.ts";

test("a cropped picture keeps the left top of every plane", () => {
  // 4 x 4 luma, then two planes of 2 x 2.
  const planes = Uint8Array.from({ length: 24 }, (_, n) => n);
  const out = new Uint8Array(planeBytes(3, 2));
  crop(planes, [4, 4], [3, 2], out);
  expect([...out]).toEqual([0, 1, 2, 4, 5, 6, 16, 17, 20, 21]);
});

test("a free buffer is used again, for its own length alone", () => {
  const buffers = new Buffers();
  const first = buffers.take(10);
  buffers.give(first);
  expect(buffers.take(12)).not.toBe(first);
  expect(buffers.take(10)).toBe(first);
  expect(buffers.take(10)).not.toBe(first);
});
