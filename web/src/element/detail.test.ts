import { expect, test } from "vitest";
import { demoPolicy, firstPolicy } from "../engine/api.ts";
import { detailOf } from "./detail.ts";

function read(search: string): [object, string[]] {
  const said: string[] = [];
  const asked = new URLSearchParams(search);
  return [detailOf((name) => asked.get(name), (sentence) => said.push(sentence)), said];
}

test("a score, none, or a slope is a detail", () => {
  expect(read("?target=9")).toEqual([{ target: 9 }, []]);
  expect(read("?target=9.75")).toEqual([{ target: 9.75 }, []]);
  expect(read("?target=none")).toEqual([{ target: "none" }, []]);
  expect(read("?slope=0.011")).toEqual([{ slope: 0.011 }, []]);
  expect(read("?slope=0")).toEqual([{ slope: 0 }, []]);
  expect(read("")).toEqual([{}, []]);
});

test("both, and what is no number of its range, are left out, and said", () => {
  const both = "target and slope are both given; give one of them, as each says how much is shown.";
  expect(read("?target=9&slope=0.011")).toEqual([{}, [both]]);
  expect(read("?target=10")).toEqual([{}, ["target is 10; give a score of 1 to 9.99, or none."]]);
  expect(read("?target=")[1]).toEqual(["target is empty; give a score of 1 to 9.99, or none."]);
  expect(read("?slope=steep")).toEqual([{}, ["slope is steep; give 0 to 1 degree a degree."]]);
  for (const bad of ["target=NaN", "target=0.5", "target=None", "slope=-1", "slope=Infinity"]) {
    expect(read(`?${bad}`)[1]).toHaveLength(1);
  }
});

test("a demo weighs what tiles add where the pack has it, and a slope is of acuity", () => {
  const telling = { kind: "video", policies: ["viewport", "acuity", "perceptual"] } as const;
  const silent = { kind: "video", policies: ["viewport", "acuity"] } as const;
  expect([demoPolicy(telling), demoPolicy(silent)]).toEqual(["perceptual", "acuity"]);
  expect(firstPolicy({}, telling)).toBe("viewport");
  expect(firstPolicy({ demo: true }, telling)).toBe("perceptual");
  expect(firstPolicy({ demo: true }, silent)).toBe("acuity");
  expect(firstPolicy({ demo: true, slope: 0.011 }, telling)).toBe("acuity");
  expect(firstPolicy({ policy: "full", slope: 0.011 }, telling)).toBe("full");
});

test("a demo of a scene, which has no score, is chosen by acuity", () => {
  const scene = { kind: "scene", policies: ["viewport", "acuity", "perceptual"] } as const;
  expect(demoPolicy(scene)).toBe("acuity");
  expect(firstPolicy({ demo: true }, scene)).toBe("acuity");
  expect(firstPolicy({ demo: true, policy: "perceptual" }, scene)).toBe("perceptual");
});
