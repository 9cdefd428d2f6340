// How do generated pictures and sound become a file that `foveal prepare` reads?
//
// AVI with plain 4:2:0 pictures and 16-bit sound: nothing is lost, and no program is needed.

import { writeFile } from "node:fs/promises";

/** A picture of 4:2:0: planes Y, U, V of even sides. */
export type Planes = readonly [Uint8Array, Uint8Array, Uint8Array];

/** What is written. */
export interface Clip {
  readonly size: readonly [number, number];
  readonly framesPerSecond: number;
  readonly pictures: readonly Planes[];
  /** Samples of one channel at 48 kHz, from -1 to 1. */
  readonly sound?: Float32Array;
}

const RATE = 48_000;

function words(...values: readonly number[]): Buffer {
  const bytes = Buffer.alloc(4 * values.length);
  values.forEach((value, index) => bytes.writeUInt32LE(value >>> 0, 4 * index));
  return bytes;
}

function halves(...values: readonly number[]): Buffer {
  const bytes = Buffer.alloc(2 * values.length);
  values.forEach((value, index) => bytes.writeUInt16LE(value, 2 * index));
  return bytes;
}

function chunk(name: string, ...parts: readonly Uint8Array[]): Buffer {
  const body = Buffer.concat(parts);
  const padding = Buffer.alloc(body.length % 2);
  return Buffer.concat([Buffer.from(name, "latin1"), words(body.length), body, padding]);
}

function list(name: string, ...parts: readonly Uint8Array[]): Buffer {
  return chunk("LIST", Buffer.from(name, "latin1"), ...parts);
}

function videoStream(clip: Clip, pictureBytes: number): Buffer {
  const [width, height] = clip.size;
  const head = Buffer.concat([
    Buffer.from("vidsI420", "latin1"),
    words(0, 0, 0, 1, clip.framesPerSecond, 0, clip.pictures.length, pictureBytes, 0, 0),
    halves(0, 0, width, height),
  ]);
  const format = Buffer.concat([
    words(40, width, height),
    halves(1, 12),
    Buffer.from("I420", "latin1"),
    words(pictureBytes, 0, 0, 0, 0),
  ]);
  return list("strl", chunk("strh", head), chunk("strf", format));
}

function soundStream(samples: number): Buffer {
  const head = Buffer.concat([
    Buffer.from("auds\0\0\0\0", "latin1"),
    words(0, 0, 0, 1, RATE, 0, samples, 2 * RATE, 0, 2),
    halves(0, 0, 0, 0),
  ]);
  const format = Buffer.concat([halves(1, 1), words(RATE, 2 * RATE), halves(2, 16)]);
  return list("strl", chunk("strh", head), chunk("strf", format));
}

/** Writes a clip, pictures and the sound that goes with each in turn. */
export async function writeAvi(path: string, clip: Clip): Promise<void> {
  const [width, height] = clip.size;
  const pictureBytes = (width * height * 3) / 2;
  const { sound } = clip;
  const main = words(
    Math.round(1e6 / clip.framesPerSecond),
    0,
    0,
    0x100,
    clip.pictures.length,
    0,
    sound === undefined ? 1 : 2,
    pictureBytes,
    width,
    height,
    0,
    0,
    0,
    0,
  );
  const streams = [videoStream(clip, pictureBytes)];
  if (sound !== undefined) streams.push(soundStream(sound.length));
  const each = Math.round(RATE / clip.framesPerSecond);
  const content = clip.pictures.flatMap((planes, index) => {
    const picture = chunk("00dc", ...planes);
    if (sound === undefined) return [picture];
    const samples = [...sound.subarray(index * each, (index + 1) * each)];
    const codes = samples.map((sample) => Math.round(sample * 32_767) & 0xffff);
    return [picture, chunk("01wb", halves(...codes))];
  });
  const file = chunk(
    "RIFF",
    Buffer.from("AVI ", "latin1"),
    list("hdrl", chunk("avih", main), ...streams),
    list("movi", ...content),
  );
  await writeFile(path, file);
}
