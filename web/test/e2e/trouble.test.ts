// Is every trouble of a host or a browser said in a clear sentence, and overcome where it can be?

import { spawn } from "node:child_process";
import type { Browser } from "playwright-core";
import { afterAll, beforeAll, expect, inject, test } from "vitest";
import type { EngineProblem } from "../../src/engine/api.ts";
import { type Faults, RangeHost } from "../range-server.ts";
import {
  type Opened,
  connect,
  countTold,
  launchPlain,
  open,
  seen,
  stats,
  told,
} from "./browser.ts";

let browser: Browser;

beforeAll(async () => {
  browser = await connect(inject("browser"));
});

afterAll(() => browser.close());

async function on(
  address: string,
  faults: Partial<Faults>,
  work: (opened: Opened, host: RangeHost) => Promise<void>,
): Promise<void> {
  const host = await RangeHost.of(inject("site"), { delayMs: 10 });
  Object.assign(host.faults, faults);
  const opened = await open(browser, host.url + address);
  try {
    await work(opened, host);
  } finally {
    await opened.page.context().close();
    await host.close();
  }
}

/** The sentence that stands where the picture would be. */
async function sentence({ page }: Opened): Promise<string> {
  const alert = page.getByRole("alert");
  await alert.waitFor({ state: "visible" });
  return (await alert.locator("p").textContent()) ?? "";
}

test("a host without ranges is named as one", async () => {
  await on("view.html?pack=flat.foveal", { noRanges: true }, async (opened) => {
    expect(await sentence(opened)).toMatch(/range/i);
    const problem = (await told(opened.page, "problem")) as EngineProblem;
    expect(problem.kind).toBe("no-ranges");
  });
});

test("a pack that is not there is named, and those that are there are offered", async () => {
  await on("view.html?pack=none.foveal", {}, async ({ page }) => {
    await page.getByText("There is nothing at none.foveal.").waitFor();
    expect(((await told(page, "problem")) as EngineProblem).kind).toBe("not-found");
    expect(await page.locator("foveal-view").count()).toBe(0);
    await page.getByRole("link", { name: "sphere" }).click();
    await told(page, "picture");
  });
});

test("an element whose pack is not there says which, with a way on and no bar", async () => {
  await on("index.html", {}, async (opened) => {
    const { page } = opened;
    await page.evaluate("import('./foveal-view.js')");
    await page.evaluate(() => {
      document.body.innerHTML = '<foveal-view src="./none.foveal"></foveal-view>';
    });
    expect(await sentence(opened)).toMatch(/none\.foveal/);
    expect(await page.getByRole("button", { name: "Play" }).count()).toBe(0);
    await page.getByRole("button", { name: "Try again" }).waitFor();
    // With a pack that is there the bar is there, too.
    await page.evaluate(() => {
      document.querySelector("foveal-view")?.setAttribute("src", "./flat.foveal");
    });
    await page.getByRole("button", { name: "Pause" }).waitFor();
  });
});

test("where nothing lies, the program's page says so and leads on, at any depth", async () => {
  const server = spawn(inject("program"), [
    "serve", inject("site"), "--listen", "127.0.0.1:0", "--json",
  ]);
  const url = await new Promise<string>((resolve) => {
    server.stdout.once("data", (line: Buffer) => {
      resolve((JSON.parse(line.toString()) as { url: string }).url);
    });
  });
  const { page, complaints } = await open(browser, "about:blank");
  try {
    for (const path of ["missing", "deep/er/missing"]) {
      const answer = await page.goto(url + path);
      expect(answer?.status()).toBe(404);
      await page.getByText(`There is nothing at /${path}.`).waitFor();
      expect(await page.locator("foveal-view").count()).toBe(0);
      await page.getByRole("link", { name: "flat" }).click();
      await told(page, "picture");
    }
    expect(complaints).toEqual([]);
  } finally {
    await page.context().close();
    server.kill();
  }
});

/** Runs in a worker: the device, and what it has drawn, come when they are let go. */
function holdDevice(): void {
  const letGo: { device?: () => void; drawn?: () => void } = {};
  const device = new Promise<void>((done) => (letGo.device = done));
  const drawn = new Promise<void>((done) => (letGo.drawn = done));
  const request = GPUAdapter.prototype.requestDevice;
  GPUAdapter.prototype.requestDevice = async function held(...values) {
    await device;
    return request.apply(this, values);
  };
  const over = GPUQueue.prototype.onSubmittedWorkDone;
  GPUQueue.prototype.onSubmittedWorkDone = async function held() {
    await drawn;
    return over.call(this);
  };
  Object.assign(self, { letGo });
}

test("a poster stands until the device has drawn, and time begins with its picture", async () => {
  const host = await RangeHost.of(inject("site"), { delayMs: 200 });
  const opened = await open(browser, "about:blank");
  const { page } = opened;
  const starting = page.waitForEvent("worker").then(async (worker) => {
    await worker.evaluate(holdDevice);
    return worker;
  });
  try {
    await page.goto(`${host.url}view.html?pack=sphere.foveal`);
    const worker = await starting;
    const pictures = page.locator("foveal-view .stage canvas");
    await expect.poll(() => pictures.count(), { timeout: 60_000 }).toBe(2);
    const centre = (await seen(page)).at(0.5, 0.5);
    for (const channel of [0, 1]) expect(Math.abs((centre[channel] ?? 0) - 128)).toBeLessThan(14);
    await worker.evaluate("letGo.device()");
    // All of the first frame is there, but it was never shown.
    await told(page, "settled");
    const before = await stats(opened);
    expect([before.playing, before.time, before.firstPicture]).toEqual([true, 0, null]);
    expect(await pictures.count()).toBe(2);
    await worker.evaluate("letGo.drawn()");
    await told(page, "picture");
    expect(await pictures.count()).toBe(1);
    const time = async (): Promise<number> => (await stats(opened)).time;
    await expect.poll(time, { timeout: 60_000 }).toBeGreaterThan(0);
  } finally {
    await page.context().close();
    await host.close();
  }
});

test("a pack that was cut short is refused as broken", async () => {
  await on("view.html?pack=flat.foveal", { truncatedAt: 100_000 }, async (opened) => {
    expect(await sentence(opened)).not.toBe("");
    expect(((await told(opened.page, "problem")) as EngineProblem).kind).toBe("broken-pack");
  });
});

test("flipped bytes of the description are refused as broken", async () => {
  await on("view.html?pack=flat.foveal", { flipped: new Set([100]) }, async (opened) => {
    expect(await sentence(opened)).not.toBe("");
    expect(((await told(opened.page, "problem")) as EngineProblem).kind).toBe("broken-pack");
  });
});

test("flipped bytes of fine tiles leave the coarser picture", async () => {
  // Every chunk of the second group and later is damaged somewhere; the first is whole.
  const places = Array.from({ length: 40 }, (_, at) => 60_000 + 977 * at);
  await on("view.html?pack=flat.foveal&paused", { flipped: new Set(places) }, async (opened) => {
    await told(opened.page, "picture");
    const middle = (await seen(opened.page)).at(0.5, 0.5);
    expect(middle.some((channel) => channel > 30)).toBe(true);
    expect(await opened.page.getByRole("alert").isVisible()).toBe(false);
  });
});

test("what is missing in the middle leaves the coarser picture, and is said", async () => {
  await on("view.html?pack=flat.foveal&paused", {}, async (opened, host) => {
    const { page } = opened;
    await told(page, "settled");
    const before = await countTold(page);
    host.faults.missingFrom = 4096;
    await page.keyboard.press("End");
    await told(page, "lost", before);
    const middle = (await seen(page)).at(0.5, 0.5);
    expect(middle.some((channel) => channel > 30)).toBe(true);
    const again = await countTold(page);
    host.faults.missingFrom = null;
    await told(page, "settled", again);
  });
});

test("a host that is away and comes back is waited for", async () => {
  await on("view.html?pack=flat.foveal&paused", {}, async (opened, host) => {
    const { page } = opened;
    await told(page, "settled");
    const before = await countTold(page);
    host.goOffline(true);
    await page.keyboard.press("End");
    expect(await told(page, "lost", before)).toBe("network");
    await page.getByText("The host cannot be reached").waitFor();
    host.goOffline(false);
    expect(await told(page, "restored", before)).toBe("network");
    await told(page, "settled", before);
  });
});

test("another file under the same address is noticed and shown", async () => {
  await on("view.html?pack=flat.foveal&paused", {}, async (opened, host) => {
    const { page } = opened;
    await told(page, "settled");
    const before = await countTold(page);
    host.faults.version = "-new";
    await page.keyboard.press("End");
    await told(page, "changed", before);
    await told(page, "settled", before);
  });
});

for (const what of ["gpu", "worker"] as const) {
  test(`a lost ${what} comes back by itself, and the picture is the one it was`, async () => {
    await on("view.html?pack=none.foveal", {}, async ({ page }) => {
      await page.evaluate("import('./foveal-view.js').then((it) => (window.Engine = it.Engine))");
      const [events, before, after] = await page.evaluate(async (lost) => {
        const place = document.body.appendChild(document.createElement("div"));
        const options = { src: "flat.foveal", size: [400, 225], paused: true } as const;
        const engine = await window.Engine.open(place, options);
        const events: string[] = [];
        engine.on("lost", (one) => events.push(`lost ${one}`));
        const restored = new Promise<void>((done) => {
          engine.on("restored", (one) => {
            events.push(`restored ${one}`);
            done();
          });
        });
        engine.seek(1);
        const sum = async (): Promise<string> => {
          const { data } = await engine.pixels();
          const hash = await crypto.subtle.digest("SHA-256", data as Uint8Array<ArrayBuffer>);
          return [...new Uint8Array(hash)].join();
        };
        const before = await sum();
        engine.lose(lost);
        await restored;
        const after = await sum();
        // What stood in for the picture goes once the new one is on screen.
        for (let waits = 0; waits < 400 && place.childElementCount > 1; waits += 1) {
          await new Promise((done) => setTimeout(done, 25));
        }
        events.push(`${place.childElementCount} canvas at ${(await engine.stats()).time}`);
        engine.close();
        return [events, before, after] as const;
      }, what);
      expect(events).toEqual([`lost ${what}`, `restored ${what}`, "1 canvas at 1"]);
      expect(after).toBe(before);
    });
  });
}

test("an address that names no video offers the list", async () => {
  await on("view.html", {}, async ({ page }) => {
    await page.getByRole("main").getByRole("link").click();
    await page.locator("#packs a").first().waitFor();
  });
});

test("without WebGPU the coarsest level plays, and a sentence says why", async () => {
  const plain = await launchPlain();
  const host = await RangeHost.of(inject("site"), { delayMs: 10 });
  try {
    for (const pack of ["flat", "sphere"]) {
      const opened = await open(plain, `${host.url}view.html?pack=${pack}.foveal`);
      await told(opened.page, "picture");
      const note = opened.page.getByRole("note");
      await note.waitFor({ state: "visible" });
      expect(await note.textContent()).toMatch(/WebGPU/);
      const picture = await seen(opened.page);
      expect(picture.at(0.5, 0.5).some((channel) => channel > 60)).toBe(true);
      expect(opened.complaints).toEqual([]);
      await opened.page.context().close();
    }
    expect(host.sentTwice()).toEqual([]);
  } finally {
    await plain.close();
    await host.close();
  }
});
