import { expect, test } from "vitest";
import { bytes, clock, parts, percent, rate, score, spokenTime } from "./words.ts";

test("a time is minutes and seconds, and hours where there are any", () => {
  const said = ["0:00", "0:05", "0:03", "1:05", "1:00:00", "1:02:05"];
  expect([0, 5.9, 2.999, 65, 3600, 3725].map(clock)).toEqual(said);
});

test("a spoken time leaves out what is zero", () => {
  expect(spokenTime(0)).toBe("the beginning");
  expect(spokenTime(61)).toBe("1 minute 1 second");
  expect(spokenTime(7200)).toBe("2 hours");
});

test("a size has three digits and never a thousand of its unit", () => {
  expect([0, 999, 1000, 12_345, 999_499, 999_501].map(bytes)).toEqual([
    "0 B",
    "999 B",
    "1.00 kB",
    "12.3 kB",
    "999 kB",
    "1.00 MB",
  ]);
  expect(rate(40e6)).toBe("40.0 Mbit/s");
});

test("a score is what is asked and, where that is known, what is expected", () => {
  expect(score(9.5, 9.5612)).toBe("9.5 asked, 9.56 expected");
  expect(score(9, null)).toBe("9 asked");
  expect(score(null, 10)).toBe("none asked, 10.00 expected");
});

test("what a scene consists of is counted in groups of three digits", () => {
  const told = [{ triangles: 1 }, { triangles: 870_306 }, { triangles: 0, points: 30_000 }];
  expect(told.map(parts)).toEqual(["1 triangle", "870,306 triangles", "30,000 points"]);
  expect(parts({ triangles: 2, points: 1 })).toBe("2 triangles, 1 point");
  expect(parts({})).toBe("0 triangles");
});

test("a small share keeps its digits", () => {
  expect([0.0021, 0.021, 0.21].map(percent)).toEqual(["0.21 %", "2.1 %", "21 %"]);
});
