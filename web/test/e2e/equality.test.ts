// Does the page show and select what the program does, bit by bit?
//
// Both draw on one driver, the software Vulkan that Chromium brings along.

import { execFile } from "node:child_process";
import { existsSync } from "node:fs";
import { mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { promisify } from "node:util";
import type { Browser, Page } from "playwright-core";
import { afterAll, beforeAll, expect, inject, test } from "vitest";
import type { EngineOptions } from "../../src/engine/api.ts";
import type { Engine } from "../../src/engine/engine.ts";
import { RangeHost } from "../range-server.ts";
import { connect, open } from "./browser.ts";
import { PNG } from "./png.ts";

const run = promisify(execFile);
const DRIVER = ["/usr/lib/chromium", "/usr/lib/chromium-browser", "/opt/google/chrome"]
  .map((folder) => join(folder, "vk_swiftshader_icd.json"))
  .find((file) => existsSync(file));

/** A view that the program and the page can both have. */
interface Scene {
  readonly pack: string;
  readonly size: readonly [number, number];
  /** Over what screen the page shows it, so that it fills the angles that it shows. */
  readonly diagonalInches: number;
  /** Where the pointer is, in pixels, before and after a saccade. */
  readonly gazes: readonly [readonly [number, number], readonly [number, number]];
}

/** A sphere's view of 100° that fills 100° at the eye. */
function wide([w, h]: readonly [number, number]): number {
  const across = 2 * Math.tan((50 * Math.PI) / 180);
  return (0.6 * across * Math.hypot(w, h)) / w / 0.0254;
}

const SPHERE = [640, 400] as const;
const SCENES: readonly Scene[] = [
  {
    pack: "flat",
    size: [1024, 576],
    diagonalInches: 24,
    gazes: [[300, 200], [900, 400]],
  },
  {
    pack: "sphere",
    size: SPHERE,
    diagonalInches: wide(SPHERE),
    gazes: [[320, 200], [100, 300]],
  },
  {
    pack: "round",
    size: SPHERE,
    diagonalInches: wide(SPHERE),
    gazes: [[320, 200], [100, 300]],
  },
];

interface Drawn {
  /** RGBA in base64: lists of numbers take minutes to cross. */
  readonly pictures: string[];
  /** What each of them was chosen for. */
  readonly lines: string[];
  readonly log: string;
  readonly damaged: number;
}

declare global {
  interface Window {
    Engine: typeof Engine;
  }
}

let browser: Browser;
let host: RangeHost;
let folder: string;

beforeAll(async () => {
  browser = await connect(inject("browser"));
  host = await RangeHost.of(inject("site"));
  folder = await mkdtemp(join(tmpdir(), "foveal-equal-"));
});

afterAll(async () => {
  await browser.close();
  await host.close();
  await rm(folder, { recursive: true, force: true });
});

/** Frames 0, 1, .. of a pack under a policy; the last is looked at from another place. */
async function inPage(page: Page, scene: Scene, policy: string, frames: number): Promise<Drawn> {
  const options = {
    src: `${scene.pack}.foveal`,
    policy,
    paused: true,
    log: true,
    size: scene.size,
    screen: { pixels: scene.size, diagonalInches: scene.diagonalInches, distanceM: 0.6 },
  } as EngineOptions;
  // As text: what bundles this test has no import in the page.
  await page.evaluate("import('./foveal-view.js').then((it) => (window.Engine = it.Engine))");
  return page.evaluate(
    async ({ options, gazes, frames }) => {
      const { policy, ...rest } = options;
      // Choosing begins with the gaze: levels are kept steady, so that what was before counts.
      const begin = { ...rest, policy: "coarsest" } as const;
      const engine = await window.Engine.open(document.body, begin).catch((why: unknown) => {
        throw new Error(JSON.stringify(why));
      });
      engine.pointer(gazes[0]);
      await engine.pixels();
      engine.setPolicy(policy ?? "acuity");
      const pictures: string[] = [];
      const lines: string[] = [];
      const text = (data: Uint8Array) =>
        new Promise<string>((done) => {
          const reader = new FileReader();
          reader.onload = () => done((reader.result as string).split(",")[1] ?? "");
          reader.readAsDataURL(new Blob([data as Uint8Array<ArrayBuffer>]));
        });
      for (let frame = 0; frame < frames; frame += 1) {
        if (frame > 0) {
          if (frame === frames - 1) engine.pointer(gazes[1]);
          engine.step(1);
        }
        pictures.push(await text((await engine.pixels()).data));
        lines.push((await engine.sessionLog()).trimEnd().split("\n").at(-1) ?? "");
      }
      const log = await engine.sessionLog();
      const damaged = (await engine.stats()).damagedTiles;
      engine.close();
      return { pictures, lines, log, damaged };
    },
    { options, gazes: scene.gazes, frames },
  );
}

/** What pictures were looked at with, as the trace by which the program looks alike. */
function traceOf(lines: readonly string[]): string {
  const rows = lines.map((line, frame) => {
    const { gaze, spread_rad } = JSON.parse(line) as { gaze: number[]; spread_rad: number };
    const [x = 0, y = 0, z = -1] = gaze;
    const degrees = [Math.atan2(x, -z), Math.asin(y), spread_rad].map((a) => (a * 180) / Math.PI);
    const [yaw, pitch, spread] = degrees;
    return `${frame / 25 - 0.001},${yaw},${pitch},${spread},0,0`;
  });
  return ["t_s,yaw_deg,pitch_deg,spread_deg,head_yaw_deg,head_pitch_deg", ...rows, ""].join("\n");
}

/** The same frames as the program draws them. */
async function natively(
  scene: Scene,
  policy: string,
  lines: readonly string[],
): Promise<PNG[]> {
  const frames = lines.length;
  const out = join(folder, `${scene.pack}-${policy}`);
  const trace = join(folder, `${scene.pack}-${policy}.csv`);
  await writeFile(trace, traceOf(lines));
  const pack = join(inject("packs"), `${scene.pack}.foveal`);
  const words = ["simulate", pack, "--policy", policy, "--gaze", `trace:${trace}`];
  const more = ["--frames", `${frames}`, "--view", scene.size.join("x"), "--out", out];
  const env = { ...process.env, VK_DRIVER_FILES: DRIVER };
  await run(inject("program"), [...words, ...more], { env });
  const files = Array.from({ length: frames }, (_, frame) =>
    join(out, `frame_${String(frame).padStart(5, "0")}.png`),
  );
  return Promise.all(files.map(async (file) => PNG.parse(await readFile(file))));
}

for (const scene of SCENES) {
  const cases = [["full", 2], ["acuity", 3]] as const;
  for (const [policy, frames] of cases) {
    test.skipIf(DRIVER === undefined)(
      `${frames} frames of the ${scene.pack} pack under ${policy} are the program's, bit by bit`,
      async () => {
        const opened = await open(browser, `${host.url}view.html?pack=none.foveal`);
        const drawn = await inPage(opened.page, scene, policy, frames);
        await opened.page.context().close();
        const native = await natively(scene, policy, drawn.lines);
        const differing = native.map((picture, frame) => {
          return picture.differing(Buffer.from(drawn.pictures[frame] ?? "", "base64"));
        });
        expect([drawn.damaged, ...differing]).toEqual(Array.from({ length: frames + 1 }, () => 0));
      },
    );
  }

  test(`the program selects for the ${scene.pack} pack what the page's log says`, async () => {
    const opened = await open(browser, `${host.url}view.html?pack=none.foveal`);
    for (const policy of ["acuity", "viewport", "perceptual"]) {
      const { log } = await inPage(opened.page, scene, policy, 4);
      const file = join(folder, "log.jsonl");
      await writeFile(file, log);
      const pack = join(inject("packs"), `${scene.pack}.foveal`);
      const { stdout } = await run(inject("program"), ["replay", file, "--pack", pack, "--json"]);
      const { same, log_sha256, replay_sha256 } = JSON.parse(stdout) as Record<string, unknown>;
      expect([policy, same, replay_sha256]).toEqual([policy, true, log_sha256]);
    }
    await opened.page.context().close();
  });
}
