import { expect, test } from "vitest";
import { type Actions, actionOfKey, endOfKey } from "./actions.ts";

function done(key: string, withShift = false, inScene = false, isEnd = false): string {
  const said: string[] = [];
  const say =
    (name: string) =>
    (...values: readonly unknown[]): void => {
      said.push([name, ...values].join(" "));
    };
  const actions: Actions = {
    gesture: say("gesture"),
    drag: say("drag"),
    fly: say("fly"),
    stopFlying: say("stopFlying"),
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
  const pressed = { key, shiftKey: withShift };
  const action = isEnd ? endOfKey(pressed, inScene) : actionOfKey(pressed, inScene, 1600);
  action?.(actions);
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

test("in scenes one flies while a key is held, with Shift faster", () => {
  expect(done("w", false, true)).toBe("fly 0,0,1 true false");
  expect(done("A", true, true)).toBe("fly -1,0,0 true true");
  expect(done("s", false, true, true)).toBe("fly 0,0,-1 false false");
  expect(done("Home", false, true)).toBe("reset");
  expect(done("p", false, true)).toBe("nextPolicy 1");
  expect([done("w"), done("Home"), done("w", false, false, true)]).toEqual(["", "seekShare 0", ""]);
});

test("signs that a keyboard has on Shift are found, and other keys do nothing", () => {
  expect(done("?", true)).toBe("toggle overlay");
  expect(done("+", true)).toBe("zoom 1.25 ");
  expect(done(" ")).toBe("toggle play");
  expect(done("Tab")).toBe("");
  expect(done("F11")).toBe("");
});
