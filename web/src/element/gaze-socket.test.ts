// Is a flood of gazes thinned, and what trackers send let through?

import { expect, test } from "vitest";
import { Sieve } from "./gaze-socket.ts";

test("every line of a tracker of a thousand a second comes through", () => {
  const sieve = new Sieve();
  for (let ms = 0; ms < 5000; ms++) {
    expect(sieve.through([`${ms}`], ms)).toEqual([`${ms}`]);
  }
});

test("of a flood as many lines come through as a page can look at, the newest", () => {
  const sieve = new Sieve();
  let passed = 0;
  for (let ms = 0; ms < 2000; ms += 10) {
    const lines = Array.from({ length: 2000 }, (_, n) => `${ms + n}`);
    const through = sieve.through(lines, ms);
    passed += through.length;
    expect(through).toEqual(lines.slice(lines.length - through.length));
  }
  expect(passed).toBeGreaterThan(7000);
  expect(passed).toBeLessThan(9000);
});
