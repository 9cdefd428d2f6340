// Does a page play a scene: by ranges alone, sharp where it is seen, and flown through?

import { execFile } from "node:child_process";
import { mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { promisify } from "node:util";
import type { Browser } from "playwright-core";
import { afterAll, beforeAll, expect, inject, test } from "vitest";
import type { EngineProblem } from "../../src/engine/api.ts";
import { RangeHost } from "../range-server.ts";
import { type Opened, connect, countTold, open, seen, settled, stats, told } from "./browser.ts";
import type { PNG } from "./png.ts";

const run = promisify(execFile);

/** Corners of the torus round it and along its tube. */
const ROUND = 256;
const ALONG = 96;

let browser: Browser;
let folder: string;
let site: string;
/** Where the index of the pack begins, and its bytes. */
let index: number;
let fileBytes: number;

beforeAll(async () => {
  browser = await connect(inject("browser"));
  folder = await mkdtemp(join(tmpdir(), "foveal-scene-"));
  const [model, pack] = [join(folder, "torus.obj"), join(folder, "torus.foveal")];
  await writeFile(model, torus());
  await run(inject("program"), ["prepare", "scene", model, "--out", pack]);
  site = join(folder, "site");
  await run(inject("program"), ["export", "site", pack, "--out", site]);
  const file = await readFile(pack);
  [index, fileBytes] = [Number(file.readBigUInt64LE(24)), file.length];
});

afterAll(async () => {
  await browser.close();
  await rm(folder, { recursive: true, force: true });
});

/** A ring that stands upright, towards the viewer, with bumps along its tube. */
function torus(): string {
  const lines: string[] = [];
  for (let i = 0; i < ROUND; i += 1) {
    for (let j = 0; j < ALONG; j += 1) {
      const [round, along] = [(2 * Math.PI * i) / ROUND, (2 * Math.PI * j) / ALONG];
      const tube = 0.35 + 0.01 * Math.sin(16 * round) * Math.sin(9 * along);
      const out = 1 + tube * Math.cos(along);
      const place = [out * Math.cos(round), out * Math.sin(round), tube * Math.sin(along)];
      lines.push(`v ${place.map((one) => one.toFixed(6)).join(" ")}`);
    }
  }
  const at = (i: number, j: number): number => (i % ROUND) * ALONG + (j % ALONG) + 1;
  for (let i = 0; i < ROUND; i += 1) {
    for (let j = 0; j < ALONG; j += 1) {
      lines.push(`f ${at(i, j)} ${at(i + 1, j)} ${at(i + 1, j + 1)} ${at(i, j + 1)}`);
    }
  }
  return lines.join("\n");
}

/** Opens a page of a fresh host and does the work. */
async function on(
  query: string,
  work: (opened: Opened, host: RangeHost) => Promise<void>,
  flipped: readonly number[] = [],
): Promise<void> {
  const host = await RangeHost.of(site, { delayMs: 20 });
  host.faults.flipped = new Set(flipped);
  const opened = await open(browser, `${host.url}${query}`);
  opened.page.on("requestfailed", (request) => {
    if (request.failure()?.errorText === "net::ERR_ABORTED") host.gaveUp(request.headers().range);
  });
  try {
    await work(opened, host);
    expect(opened.complaints).toEqual([]);
  } finally {
    await opened.page.context().close();
    await host.close();
  }
}

/** How far two colours are apart, the largest of three channels. */
function apart(a: readonly number[], b: readonly number[]): number {
  return Math.max(...a.map((one, k) => Math.abs(one - (b[k] ?? 0))));
}

/** Whether the ring is where a viewer sees it who has just come: round an empty middle. */
function showsRing(picture: PNG): boolean {
  const [middle, corner] = [picture.at(0.5, 0.5), picture.at(0.02, 0.04)];
  const share = picture.height / picture.width;
  const steps = Array.from({ length: 40 }, (_, step) => 0.03 + 0.01 * step);
  const hasPart = ([x, y]: readonly [number, number]): boolean =>
    steps.some((far) => apart(picture.at(0.5 + x * share * far, 0.5 + y * far), middle) > 40);
  const around = [[1, 0], [-1, 0], [0, 1], [0, -1]] as const;
  return apart(middle, corner) < 4 && around.every(hasPart);
}

test("the list leads to a scene, which comes by ranges alone until it is sharp", async () => {
  await on("", async (opened, host) => {
    const { page } = opened;
    await page.getByText(/Scene, 49,152 triangles/).waitFor();
    await page.locator("#packs a").first().click();
    await told(page, "settled");
    const { levels, share, damagedTiles, trianglesDrawn } = await stats(opened);
    expect(levels.reduce((sum, count) => sum + count, 0)).toBeGreaterThan(10);
    expect([share > 0.02, damagedTiles]).toEqual([true, 0]);
    expect(trianglesDrawn).toBeGreaterThan(1000);
    const picture = await seen(page);
    if (process.env.SHOTS) await page.screenshot({ path: join(process.env.SHOTS, "torus.png") });
    expect(showsRing(picture)).toBe(true);
    const { ofPacks } = host;
    expect(ofPacks.every(({ status, range }) => status === 206 && range !== "")).toBe(true);
    expect(host.sentTwice()).toEqual([]);
  });
});

test("a hand turns the head, a wheel comes closer, and Home goes back to the start", async () => {
  await on("view.html?pack=torus.foveal", async (opened) => {
    const { page } = opened;
    await told(page, "settled");
    const [first, start] = [await seen(page), await stats(opened)];
    await page.mouse.move(400, 300);
    await page.mouse.down();
    await page.mouse.move(500, 330, { steps: 4 });
    await page.mouse.up();
    const turned = await settled(opened);
    expect(turned.headDeg[0]).toBeLessThan(-5);
    expect(showsRing(await seen(page))).toBe(false);
    expect(turned.position).toEqual(start.position);
    await page.keyboard.press("Home");
    await settled(opened);
    await page.mouse.move(400, 300);
    await page.mouse.wheel(0, -400);
    const closer = await settled(opened);
    expect(closer.position[2]).toBeLessThan(start.position[2] - 0.2);
    expect(closer.share).toBeGreaterThan(start.share);
    await page.keyboard.press("Home");
    const back = await settled(opened);
    expect(back.position).toEqual(start.position);
    const again = await seen(page);
    for (const [x, y] of [[0.5, 0.2], [0.3, 0.5], [0.6, 0.7]] as const) {
      expect(apart(first.at(x, y), again.at(x, y))).toBeLessThan(3);
    }
  });
});

test("one flies while a key is held", async () => {
  await on("view.html?pack=torus.foveal", async (opened) => {
    const { page } = opened;
    await told(page, "settled");
    const start = await stats(opened);
    await page.keyboard.down("d");
    await expect.poll(async () => (await stats(opened)).position[0]).toBeGreaterThan(0.1);
    await page.keyboard.up("d");
    const there = await settled(opened);
    expect(there.position[2]).toBeCloseTo(start.position[2], 9);
    await page.waitForTimeout(300);
    expect((await stats(opened)).position).toEqual(there.position);
  });
});

test("only the policies of scenes are offered, and each shows the ring", async () => {
  await on("view.html?pack=torus.foveal&demo", async (opened) => {
    const { page } = opened;
    await told(page, "settled");
    expect((await stats(opened)).policy).toBe("acuity");
    const offered = await page.locator("foveal-view select option").allTextContents();
    const gazing = ["acuity", "perceptual", "eccentricity"];
    expect(offered).toEqual(["viewport", ...gazing, "uniform", "full", "coarsest"]);
    for (const policy of offered) {
      const since = await countTold(page);
      await page.evaluate((name) => {
        document.querySelector("foveal-view")?.setAttribute("policy", name);
      }, policy);
      await told(page, "settled", since);
      expect([(await stats(opened)).policy, showsRing(await seen(page))]).toEqual([policy, true]);
    }
  });
});

test("a damaged unit is counted and reported, and the coarser one stays", async () => {
  const work = async (opened: Opened): Promise<void> => {
    await told(opened.page, "settled");
    expect((await stats(opened)).damagedTiles).toBeGreaterThan(0);
    const problem = (await told(opened.page, "problem")) as EngineProblem;
    expect([problem.kind, problem.fatal]).toEqual(["broken-pack", false]);
    expect(showsRing(await seen(opened.page))).toBe(true);
  };
  await on("view.html?pack=torus.foveal&policy=full", work, [index - 40]);
});

test("what is damaged before the units is said in a sentence that names it", async () => {
  const tail = [[index + 9, "index"], [fileBytes - 9, "table units"]] as const;
  const parts = [[70, "description"], ...tail] as const;
  for (const [place, named] of parts) {
    const work = async ({ page }: Opened): Promise<void> => {
      const alert = page.getByRole("alert");
      await alert.waitFor({ state: "visible" });
      expect(await alert.locator("p").textContent()).toContain(named);
    };
    await on("view.html?pack=torus.foveal", work, [place]);
  }
});

test("the program selects what the page's log of a flight says", async () => {
  await on("view.html?pack=none.foveal", async ({ page }) => {
    await page.evaluate("import('./foveal-view.js').then((it) => (window.Engine = it.Engine))");
    for (const policy of ["viewport", "acuity", "uniform"] as const) {
      const log = await page.evaluate(async (policy) => {
        const options = { src: "torus.foveal", size: [640, 400], log: true } as const;
        const engine = await window.Engine.open(document.body, { ...options, policy });
        await engine.pixels();
        engine.pointer([100, 200]);
        engine.fly([1, 0, 1], true, true);
        await new Promise((done) => setTimeout(done, 500));
        engine.stopFlying();
        engine.drag(50, 20);
        await engine.pixels();
        const log = await engine.sessionLog();
        engine.close();
        return log;
      }, policy);
      const file = join(folder, "log.jsonl");
      await writeFile(file, log);
      const words = ["replay", file, "--pack", join(folder, "torus.foveal"), "--json"];
      const { stdout } = await run(inject("program"), words);
      const { same } = JSON.parse(stdout) as { same: boolean };
      expect([policy, same, log.split("\n").length > 5]).toEqual([policy, true, true]);
    }
  });
});

test("the page draws what the program draws, but for what JPEG leaves", async () => {
  await on("view.html?pack=none.foveal", async ({ page }) => {
    await page.evaluate("import('./foveal-view.js').then((it) => (window.Engine = it.Engine))");
    const off = await page.evaluate(async () => {
      const jpeg = await createImageBitmap(await (await fetch("./posters/torus.jpg")).blob());
      const [width, height] = [jpeg.width, jpeg.height];
      const context = new OffscreenCanvas(width, height).getContext("2d");
      if (context === null) throw new Error("no canvas");
      context.drawImage(jpeg, 0, 0);
      const native = context.getImageData(0, 0, width, height).data;
      const engine = await window.Engine.open(document.body, {
        src: "torus.foveal",
        size: [width, height],
        fieldDeg: 60,
      });
      const { data } = await engine.pixels();
      engine.close();
      let sum = 0;
      for (let at = 0; at < data.length; at += 1) {
        if (at % 4 < 3) sum += Math.abs((data[at] ?? 0) - (native[at] ?? 0));
      }
      return sum / (width * height * 3);
    });
    expect(off).toBeLessThan(1.5);
  });
});
