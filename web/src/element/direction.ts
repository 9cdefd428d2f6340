// Where does the view of a sphere begin, as attributes and addresses say it?

import type { Stats, View } from "../engine/api.ts";

/** Attributes of the element, and parameters of a page's address, in degrees. */
export const DIRECTION = ["yaw", "pitch", "fov"] as const;

type Name = (typeof DIRECTION)[number];

/** What each of them may be. */
const RANGES: Readonly<Record<Name, readonly [number, number]>> = {
  yaw: [-360, 360],
  pitch: [-90, 90],
  fov: [0.01, 140],
};

/** The view that texts say; `refused` hears a sentence for each that says none. */
export function viewOf(
  text: (name: Name) => string | null,
  refused: (sentence: string) => void,
): View {
  const degrees = (name: Name): number | undefined => {
    const said = text(name);
    if (said === null) return undefined;
    const [least, most] = RANGES[name];
    const number = said.trim() === "" ? Number.NaN : Number(said);
    if (number >= least && number <= most) return number;
    refused(`${name} is ${said === "" ? "empty" : said}; give ${least} to ${most} degrees.`);
    return undefined;
  };
  const [yawDeg, pitchDeg, fovDeg] = DIRECTION.map(degrees);
  return {
    ...(yawDeg === undefined ? {} : { yawDeg }),
    ...(pitchDeg === undefined ? {} : { pitchDeg }),
    ...(fovDeg === undefined ? {} : { fovDeg }),
  };
}

/** The query of an address that begins where one looks now, all else as it was; the front needs no
 *  words. */
export function queryOf(search: string, { headDeg, fovDeg, zoom }: Stats): string {
  const [yaw, pitch] = headDeg.map((degrees) => Number(degrees.toFixed(2)) + 0);
  const isFront = yaw === 0 && pitch === 0 && Math.abs(zoom - 1) < 1e-3;
  const names: readonly string[] = DIRECTION;
  const others = search.replace(/^\?/, "").split("&");
  const kept = others.filter((part) => !names.includes(part.split("=")[0] ?? ""));
  const fov = Number(fovDeg.toPrecision(3));
  const said = isFront ? [] : [`yaw=${yaw}`, `pitch=${pitch}`, `fov=${fov}`];
  return `?${[...kept, ...said].filter((part) => part !== "").join("&")}`;
}
