import { expect, test } from "vitest";
import { type Actions, actionOfKey } from "./actions.ts";

function done(key: string, withModifier = false): string {
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
  };
  actionOfKey(key, withModifier, [1600, 160])?.(actions);
  return said.join(", ");
}

test("an arrow turns the head its way, so the content goes the other", () => {
  expect(done("ArrowRight")).toBe("drag -100 0");
  expect(done("ArrowLeft")).toBe("drag 100 0");
  expect(done("ArrowDown")).toBe("drag 0 -10");
  expect(done("ArrowUp")).toBe("drag 0 10");
});

test("with a modifier the arrows seek", () => {
  expect(done("ArrowRight", true)).toBe("skip 5");
  expect(done("ArrowLeft", true)).toBe("skip -5");
});

test("capital letters do what small ones do, and other keys nothing", () => {
  expect(done("M")).toBe("toggle sound");
  expect(done(" ")).toBe("toggle play");
  expect(done("Tab")).toBe("");
});
