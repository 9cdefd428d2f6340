import { expect, test } from "vitest";
import type { Stats } from "../engine/api.ts";
import { queryOf, viewOf } from "./direction.ts";

function read(search: string): [object, string[]] {
  const said: string[] = [];
  const asked = new URLSearchParams(search);
  return [viewOf((name) => asked.get(name), (sentence) => said.push(sentence)), said];
}

const looking = (yaw: number, pitch: number, fovDeg: number, zoom: number): Stats =>
  ({ headDeg: [yaw, pitch, 0], fovDeg, zoom }) as unknown as Stats;

test("numbers within their ranges are a view, and what is left out stays", () => {
  const whole = { yawDeg: -190, pitchDeg: 89.5, fovDeg: 40 };
  expect(read("?yaw=-190&pitch=89.5&fov=40")).toEqual([whole, []]);
  expect(read("?fov=0.5")).toEqual([{ fovDeg: 0.5 }, []]);
  expect(read("")).toEqual([{}, []]);
});

test("what is no number of its range is left out, and said", () => {
  const [view, said] = read("?yaw=north&pitch=91&fov=");
  expect(view).toEqual({});
  expect(said).toEqual([
    "yaw is north; give -360 to 360 degrees.",
    "pitch is 91; give -90 to 90 degrees.",
    "fov is empty; give 0.01 to 140 degrees.",
  ]);
  for (const bad of ["NaN", "Infinity", "1e9", "12deg", " "]) {
    expect(read(`?yaw=${encodeURIComponent(bad)}`)[1]).toHaveLength(1);
  }
});

test("an address says where one looks, and leaves all else as it was", () => {
  const search = "?pack=a%20b.foveal&paused&yaw=3&fov=x";
  const query = queryOf(search, looking(-12.3456, 7, 61.23, 2));
  expect(query).toBe("?pack=a%20b.foveal&paused&yaw=-12.35&pitch=7&fov=61.2");
  expect(read(query)).toEqual([{ yawDeg: -12.35, pitchDeg: 7, fovDeg: 61.2 }, []]);
});

test("the front needs no words in an address", () => {
  expect(queryOf("?pack=a.foveal&yaw=3", looking(-0.001, 0, 100, 1))).toBe("?pack=a.foveal");
});
