// How are times, sizes and shares said to people?

import { SAMPLES, type Samples } from "../engine/api.ts";

/** Seconds that are over; 2.999 of a clip of 90 pictures are three. */
function wholeSeconds(seconds: number): number {
  return Math.max(0, Math.floor(Math.round(seconds * 100) / 100));
}

/** Minutes and seconds, as 1:05. */
export function clock(seconds: number): string {
  const whole = wholeSeconds(seconds);
  const parts = [Math.floor(whole / 60) % 60, whole % 60];
  const hours = Math.floor(whole / 3600);
  const [minutes = 0, rest = 0] = parts;
  const end = String(rest).padStart(2, "0");
  return hours > 0
    ? `${hours}:${String(minutes).padStart(2, "0")}:${end}`
    : `${minutes}:${end}`;
}

/** The same as it is spoken: "1 minute 5 seconds". */
export function spokenTime(seconds: number): string {
  const whole = wholeSeconds(seconds);
  const said = (count: number, word: string): string =>
    count === 0 ? "" : `${count} ${word}${count === 1 ? "" : "s"}`;
  const parts = [
    said(Math.floor(whole / 3600), "hour"),
    said(Math.floor(whole / 60) % 60, "minute"),
    said(whole % 60, "second"),
  ].filter((part) => part !== "");
  return parts.length === 0 ? "the beginning" : parts.join(" ");
}

const SIZES = ["B", "kB", "MB", "GB", "TB"] as const;

/** Bytes in three digits, as 1.25 MB. */
export function bytes(count: number): string {
  let size = 0;
  let rest = Math.max(0, count);
  while (rest >= 999.5 && size < SIZES.length - 1) {
    rest /= 1000;
    size += 1;
  }
  const digits = size === 0 || rest >= 99.95 ? 0 : rest >= 9.995 ? 1 : 2;
  return `${rest.toFixed(digits)} ${SIZES[size] ?? ""}`;
}

/** Bits a second, as 12.3 Mbit/s. */
export function rate(bitsPerSecond: number): string {
  return `${bytes(bitsPerSecond).replace("B", "bit")}/s`;
}

/** A score that is asked for and one that is expected, in JOD: "9.5 asked, 9.56 expected". As
 *  `score_told` of crates/core/src/content/asked.rs. */
export function score(target: number | null, expected: number | null): string {
  const said = expected === null ? "" : `, ${expected.toFixed(2)} expected`;
  return `${target ?? "none"} asked${said}`;
}

/** What a scene consists of, as "870,306 triangles, 12,000 points". */
export function parts(of: Partial<Samples>): string {
  const there = SAMPLES.filter((name) => (of[name] ?? 0) > 0);
  const told = (there.length > 0 ? there : SAMPLES.slice(0, 1)).map((name) => {
    const count = of[name] ?? 0;
    return `${count.toLocaleString("en")} ${count === 1 ? name.slice(0, -1) : name}`;
  });
  return told.join(", ");
}

/** A share as a percentage, with two digits below one per cent. */
export function percent(share: number): string {
  const value = 100 * share;
  return `${value.toFixed(value < 1 ? 2 : value < 10 ? 1 : 0)} %`;
}
