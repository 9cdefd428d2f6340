// Which site do the tests open, and in which browser?
//
// A site that the program itself makes of generated clips, in a folder that goes away with them,
// and one browser for all files: a context for each test keeps them apart. The program is named by
// FOVEAL; `cargo xtask web-test` says which.

import { execFile } from "node:child_process";
import { copyFile, mkdtemp, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { promisify } from "node:util";
import type { TestProject } from "vitest/node";
import { writeAvi } from "../avi.ts";
import { FRAMES_PER_SECOND, pictures, sound } from "../scenes.ts";
import { serveBrowser } from "./browser.ts";

declare module "vitest" {
  interface ProvidedContext {
    /** Where files connect to the browser. */
    browser: string;
    /** The folder of the site. */
    site: string;
    /** The program. */
    program: string;
    /** The packs of the site, before they were put there. */
    packs: string;
  }
}

const run = promisify(execFile);

export default async function setup(project: TestProject): Promise<() => Promise<void>> {
  const program = process.env.FOVEAL;
  if (program === undefined) throw new Error("FOVEAL names no program: run `cargo xtask web-test`");
  const browser = await serveBrowser();
  const folder = await mkdtemp(join(tmpdir(), "foveal-web-"));
  const prepare = async (name: string, size: readonly [number, number], more: string[]) => {
    const clip = join(folder, `${name}.avi`);
    const framesPerSecond = FRAMES_PER_SECOND;
    const heard = name === "flat" ? { sound: sound() } : {};
    await writeAvi(clip, { size, framesPerSecond, pictures: pictures(size), ...heard });
    const pack = join(folder, `${name}.foveal`);
    const fixed = ["--quality", "24", "--calibrate", "off"];
    await run(program, ["prepare", "video", clip, "--out", pack, ...fixed, ...more]);
    return pack;
  };
  const equirect = ["--projection", "equirect", "--pack-projection", "equirect"];
  const [flat, sphere, round] = await Promise.all([
    prepare("flat", [1024, 576], ["--projection", "flat"]),
    prepare("sphere", [2048, 1024], ["--projection", "equirect"]),
    prepare("round", [1024, 512], equirect),
  ]);
  const site = join(folder, "site");
  await run(program, ["export", "site", flat, sphere, "--out", site]);
  // In addition to those that the site lists.
  await copyFile(round, join(site, "round.foveal"));
  project.provide("browser", browser.wsEndpoint());
  project.provide("site", site);
  project.provide("program", program);
  project.provide("packs", folder);
  return async () => {
    await browser.close();
    await rm(folder, { recursive: true, force: true });
  };
}
