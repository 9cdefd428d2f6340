import { expect, test } from "vitest";
import {
  LEAST_HOLE as HOLE,
  MOST_REQUEST,
  nextRequest as planned,
  type Want,
  without,
} from "./plan.ts";

const want = (offset: number, bytes: number, early = false): Want => ({ offset, bytes, early });
const nextRequest = (gaps: readonly Want[], most: number, isFree = true) =>
  planned(gaps, most, HOLE, () => isFree);

test("neighbours in the file travel together, what matters most first", () => {
  const gaps = [want(1000, 100), want(50_000, 10), want(1100, 400), want(900, 100)];
  expect(nextRequest(gaps, 10_000)).toEqual(want(900, 600));
  expect(nextRequest([], 10_000)).toBeNull();
});

test("a small hole is fetched along, a large one is not", () => {
  const near = [want(0, 100), want(100 + HOLE, 100)];
  expect(nextRequest(near, 1e6)).toEqual(want(0, 200 + HOLE));
  const far = [want(0, 100), want(101 + HOLE, 100)];
  expect(nextRequest(far, 1e6)).toEqual(want(0, 100));
  // Nor one that is in memory or under way, on either side.
  expect(nextRequest(near, 1e6, false)).toEqual(want(0, 100));
  expect(nextRequest(near.reverse(), 1e6, false)).toEqual(want(100 + HOLE, 100));
});

test("no request grows beyond its bound", () => {
  const gaps = Array.from({ length: 100 }, (_, n) => want(n * 1000, 1000));
  expect(nextRequest(gaps, 10_000)?.bytes).toBe(10_000);
  expect(nextRequest([want(0, 1e9)], 10_000)?.bytes).toBe(MOST_REQUEST);
});

test("what is under way is not asked for again", () => {
  const under = [{ offset: 10, bytes: 10 }, { offset: 40, bytes: 100 }];
  expect(without(want(0, 60), under)).toEqual([
    { offset: 0, bytes: 10 },
    { offset: 20, bytes: 20 },
  ]);
  expect(without(want(45, 10), under)).toEqual([]);
});
