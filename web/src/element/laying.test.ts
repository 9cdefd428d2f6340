// Does a picture keep its proportions and its place while the stage changes?

import { expect, test } from "vitest";
import { type Content, laid } from "./laying.ts";

const SPHERE: Content = { projection: "cube", size: [512, 512] };
const FLAT: Content = { projection: "flat", size: [1600, 900] };

/** Left, top and both scales of a transform. */
function numbers(transform: string): number[] {
  return (transform.match(/-?[\d.]+(?:e-?\d+)?/g) ?? []).map(Number);
}

test("a picture of the stage's shape covers it, whatever its pixels", () => {
  expect(numbers(laid(FLAT, [800, 500], [800, 500]))).toEqual([0, 0, 1, 1]);
  expect(numbers(laid(SPHERE, [1600, 1000], [800, 500]))).toEqual([0, 0, 0.5, 0.5]);
  const [left = 1, top = 1, x = 0, y = 0] = numbers(laid(FLAT, [427, 267], [426.66, 266.7]));
  expect([left, top]).toEqual([0, 0]);
  expect([x * 427, y * 267]).toEqual([expect.closeTo(426.66), expect.closeTo(266.7)]);
});

test("a phone's turn leaves a sphere's picture as large as it was, in the middle", () => {
  expect(numbers(laid(SPHERE, [360, 640], [640, 360]))).toEqual([140, -140, 1, 1]);
});

test("a phone's turn makes flat content as large as it is going to be", () => {
  // 360 of 1600 pixels across, then 640.
  const [left, top, x, y] = numbers(laid(FLAT, [360, 640], [640, 360]));
  expect(x).toBeCloseTo(640 / 360);
  expect(y).toBe(x);
  expect(left).toBeCloseTo(0);
  expect(top).toBeCloseTo((360 - 640 * (640 / 360)) / 2);
});
