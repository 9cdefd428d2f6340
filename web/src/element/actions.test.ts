import { expect, test } from "vitest";
import { type Actions, actionOfKey } from "./actions.ts";

function done(key: string, withShift = false): string {
  const said: string[] = [];
  const say =
    (name: string) =>
    (...values: readonly unknown[]): void => {
      said.push([name, ...values].join(" "));
    };
  const actions: Actions = {
    gesture: say("gesture"),
    drag: say("drag"),
    zoom: say("zoom"),
    reset: say("reset"),
    pointer: say("pointer"),
    toggle: say("toggle"),
    skip: say("skip"),
    step: say("step"),
    seekShare: say("seekShare"),
    nextPolicy: say("nextPolicy"),
    nextTarget: say("nextTarget"),
  };
  actionOfKey(key, withShift, 1600)?.(actions);
  return said.join(", ");
}

test("an arrow turns the head its way, so the content goes the other", () => {
  expect(done("ArrowRight")).toBe("drag -100 0");
  expect(done("ArrowLeft")).toBe("drag 100 0");
  expect(done("ArrowDown")).toBe("drag 0 -100");
  expect(done("ArrowUp")).toBe("drag 0 100");
});

test("with Shift the arrows seek, as the brackets do without", () => {
  expect(done("ArrowRight", true)).toBe("skip 5");
  expect(done("]")).toBe("skip 5");
  expect(done("ArrowLeft", true)).toBe("skip -5");
  expect(done("[")).toBe("skip -5");
});

test("capital letters do what small ones do, but where Shift is in the table", () => {
  expect(done("M")).toBe("toggle sound");
  expect(done("M", true)).toBe("toggle sound");
  expect(done("p")).toBe("nextPolicy 1");
  expect(done("P", true)).toBe("nextPolicy -1");
  expect(done("P")).toBe("nextPolicy 1");
  expect(done("j")).toBe("nextTarget 1");
  expect(done("J", true)).toBe("nextTarget -1");
});

test("signs that a keyboard has on Shift are found, and other keys do nothing", () => {
  expect(done("?", true)).toBe("toggle overlay");
  expect(done("+", true)).toBe("zoom 1.25 ");
  expect(done(" ")).toBe("toggle play");
  expect(done("Tab")).toBe("");
  expect(done("F11")).toBe("");
});
