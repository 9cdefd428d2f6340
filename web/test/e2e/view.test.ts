// Does a viewer see the right thing, sharp where it counts, by hand and by key?

import type { Browser, Page } from "playwright-core";
import { afterAll, beforeAll, expect, inject, test } from "vitest";
import type { Stats } from "../../src/engine/api.ts";
import { type Asked, RangeHost } from "../range-server.ts";
import { colourAt } from "../scenes.ts";
import { type Opened, connect, open, seen, settled, stats, told } from "./browser.ts";

let browser: Browser;
let host: RangeHost;

beforeAll(async () => {
  browser = await connect(inject("browser"));
});

afterAll(() => browser.close());

/** Opens a page of a fresh host, does the work, and looks whether all of it went well. */
async function on(
  address: string,
  work: (opened: Opened) => Promise<void>,
  options: Parameters<typeof open>[2] = {},
): Promise<void> {
  host = await RangeHost.of(inject("site"), { delayMs: 20 });
  const opened = await open(browser, host.url + address, options);
  opened.page.on("requestfailed", (request) => {
    if (request.failure()?.errorText === "net::ERR_ABORTED") host.gaveUp(request.headers().range);
  });
  try {
    await work(opened);
    expect(opened.complaints).toEqual([]);
    const usual = ({ method, status }: Asked): boolean =>
      method === "GET" && (status === 200 || status === 206);
    expect(host.log.filter((one) => !usual(one))).toEqual([]);
    expect(host.sentTwice()).toEqual([]);
  } finally {
    await opened.page.context().close();
    await host.close();
  }
}

/** The figures of the moment. */
/** Fails unless a colour is near what the scene has at a place, blue aside. */
function near(found: readonly number[], x: number, y: number): void {
  const expected = colourAt(x, y, 0);
  for (const channel of [0, 1]) {
    const apart = Math.abs((found[channel] ?? 0) - (expected[channel] ?? 0));
    expect(apart, `${found.join()} at ${x}, ${y}`).toBeLessThan(14);
  }
}

test("the list names every pack, with its poster, and leads to it", async () => {
  await on("", async ({ page }) => {
    await page.locator("#packs a").first().waitFor();
    expect(await page.locator("#packs h2").allTextContents()).toEqual(["flat", "sphere"]);
    const poster = page.locator("#packs img").first();
    const width = poster.evaluate(async (img: HTMLImageElement) => {
      await img.decode();
      return img.naturalWidth;
    });
    expect(await width).toBe(640);
    await page.locator("#packs a").first().click();
    await told(page, "picture");
    expect(await page.title()).toBe("flat");
  });
});

test("flat content fills the stage, and what is seen settles sharp", async () => {
  await on("view.html?pack=flat.foveal&paused", async (opened) => {
    await told(opened.page, "settled");
    const picture = await seen(opened.page);
    // The content is 16:9 in the middle of the stage.
    const high = (picture.width * 9) / 16 / picture.height;
    for (const [x, y] of [[0.5, 0.5], [0.2, 0.3], [0.8, 0.7]] as const) {
      near(picture.at(x, 0.5 + (y - 0.5) * high), x, y);
    }
    expect(picture.at(0.5, 0.01).every((channel) => channel < 8)).toBe(true);
    expect((await stats(opened)).drawing).toMatch(/^(webgpu|\w.* \(webgpu\))$/);
  });
});

/** Keeps the worker from drawing until what is returned is called. */
async function holdDrawing(page: Page): Promise<() => Promise<void>> {
  const [worker] = page.workers();
  if (worker === undefined) throw new Error("no worker");
  await worker.evaluate(() => {
    const draw = self.requestAnimationFrame.bind(self);
    const held: FrameRequestCallback[] = [];
    self.requestAnimationFrame = (picture) => held.push(picture);
    const letGo = (): void => {
      self.requestAnimationFrame = draw;
      for (const picture of held) draw(picture);
    };
    Object.assign(self, { letGo });
  });
  return () => worker.evaluate("letGo()");
}

test("a picture keeps its proportions from a change of the stage to the next picture", async () => {
  const isBlack = (colour: readonly number[]) => colour.every((channel) => channel < 8);
  await on("view.html?pack=flat.foveal&paused", async (opened) => {
    const { page } = opened;
    await told(page, "settled");
    const letGo = await holdDrawing(page);
    await page.setViewportSize({ width: 400, height: 700 });
    for (const drawn of [false, true]) {
      if (drawn) await letGo();
      if (drawn) await settled(opened);
      const picture = await seen(page);
      // Content is 16:9 in the middle already where the next picture will have it.
      const high = (picture.width * 9) / 16 / picture.height;
      for (const [x, y] of [[0.5, 0.5], [0.2, 0.3], [0.8, 0.7]] as const) {
        near(picture.at(x, 0.5 + (y - 0.5) * high), x, y);
      }
      expect(isBlack(picture.at(0.5, 0.5 - 0.75 * high))).toBe(true);
    }
  });
  const upright = { viewport: { width: 360, height: 640 } };
  const turn = async (opened: Opened): Promise<void> => {
    const { page } = opened;
    await told(page, "settled");
    const letGo = await holdDrawing(page);
    await page.setViewportSize({ width: 640, height: 360 });
    const picture = await seen(page);
    near(picture.at(0.5, 0.5), 0.5, 0.5);
    // What was not drawn yet is black.
    expect(isBlack(picture.at(0.1, 0.5))).toBe(true);
    await letGo();
    await settled(opened);
    expect(isBlack((await seen(page)).at(0.1, 0.5))).toBe(false);
  };
  await on("view.html?pack=sphere.foveal&paused", turn, upright);
});

test("a sphere turns by dragging, and shows what lies there", async () => {
  await on("view.html?pack=sphere.foveal&paused", async (opened) => {
    const { page } = opened;
    await told(page, "settled");
    near((await seen(page)).at(0.5, 0.5), 0.5, 0.5);
    const stage = page.locator("foveal-view .stage");
    const box = await stage.boundingBox();
    if (box === null) throw new Error("no stage");
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x - 200, y, { steps: 4 });
    await page.mouse.up();
    const { headDeg } = await settled(opened);
    expect(headDeg[0]).toBeGreaterThan(10);
    near((await seen(page)).at(0.5, 0.5), 0.5 + headDeg[0] / 360, 0.5);
  });
});

test("zooming shows detail that was not there before", async () => {
  await on("view.html?pack=flat.foveal&paused", async (opened) => {
    const { page } = opened;
    await told(page, "settled");
    const { scale } = await stats(opened);
    const box = await page.locator("foveal-view .stage").boundingBox();
    if (box === null) throw new Error("no stage");
    await page.mouse.move(box.x + box.width / 4, box.y + box.height / 2);
    for (let turn = 0; turn < 4; turn += 1) await page.mouse.wheel(0, -300);
    const closer = await settled(opened);
    expect(closer.scale).toBeGreaterThan(2 * scale);
    // The grain of the finest level stands there now; without it there is a slope of 0.1 a pixel.
    expect((await seen(page)).detail(0.25, 0.5)).toBeGreaterThan(1);
    expect(closer.levels[0]).toBeGreaterThan(0);
  });
});

test("in demo mode the finest tiles lie where the pointer is, and follow a jump", async () => {
  // A still under perceptual keeps what was bought; acuity follows.
  await on("view.html?pack=flat.foveal&demo&policy=acuity&target=9&paused", async (opened) => {
    const { page } = opened;
    await told(page, "picture");
    // Tiles in the colours of their levels.
    await page.keyboard.press("l");
    const box = await page.locator("foveal-view .stage").boundingBox();
    if (box === null) throw new Error("no stage");
    const jump = async (x: number): Promise<Stats> => {
      await page.mouse.move(box.x + box.width * x, box.y + box.height / 2);
      return settled(opened);
    };
    const left = await jump(0.1);
    const before = await seen(page);
    expect(left.policy).toBe("acuity");
    expect(left.gazeDeg[0]).toBeLessThan(0);
    expect(left.share).toBeLessThan(0.9);
    const right = await jump(0.9);
    const after = await seen(page);
    expect(right.gazeDeg[0]).toBeGreaterThan(0);
    expect(right.share).toBeLessThan(0.9);
    for (const x of [0.15, 0.85]) {
      const [old, now] = [before.at(x, 0.4), after.at(x, 0.4)];
      const change = old.map((channel, at) => Math.abs(channel - (now[at] ?? 0)));
      expect(Math.max(...change), `${old.join()} at ${x}, then ${now.join()}`).toBeGreaterThan(20);
    }
  });
});

test("a button makes the pointer the eye, and back", async () => {
  await on("view.html?pack=flat.foveal&paused", async (opened) => {
    const { page } = opened;
    await told(page, "settled");
    const demo = page.getByRole("button", { name: "Demo: your pointer acts as your gaze" });
    expect(await demo.getAttribute("aria-pressed")).toBe("false");
    await demo.click();
    await expect.poll(async () => (await stats(opened)).policy).toBe("perceptual");
    expect(await demo.getAttribute("aria-pressed")).toBe("true");
    await demo.click();
    await expect.poll(async () => (await stats(opened)).policy).toBe("viewport");
    expect(await demo.getAttribute("aria-pressed")).toBe("false");
  });
});

test("all of it works by keyboard alone", async () => {
  await on("view.html?pack=sphere.foveal", async (opened) => {
    const { page } = opened;
    await told(page, "picture");
    const press = async (key: string): Promise<Stats> => {
      await page.keyboard.press(key);
      return settled(opened);
    };
    expect((await press("Space")).playing).toBe(false);
    expect((await press("ArrowRight")).headDeg[0]).toBeGreaterThan(0);
    expect((await press("Home")).frame).toBe(0);
    expect((await press(".")).frame).toBe(1);
    expect((await press(",")).frame).toBe(0);
    expect((await press("=")).zoom).toBeGreaterThan(1);
    await page.keyboard.press("o");
    const figures = page.getByRole("region", { name: "Figures" });
    await figures.waitFor({ state: "visible" });
    // Every control is reached by Tab and has a name.
    const names = new Set<string>();
    for (let tab = 0; tab < 12; tab += 1) {
      await page.keyboard.press("Tab");
      const name = await page.evaluate(() => {
        const inner = document.activeElement?.shadowRoot?.activeElement;
        const labels = inner instanceof HTMLInputElement ? inner.labels?.[0]?.textContent : null;
        return inner?.getAttribute("aria-label") ?? labels ?? inner?.textContent ?? "";
      });
      if (name !== "") names.add(name.trim());
    }
    for (const name of ["Play", "Time", "Figures", "Full screen", "Keys", "Policy"]) {
      expect([...names]).toContain(name);
    }
  });
});

test("H lists the keys, then the figures, and keys do what they do in the window", async () => {
  await on("view.html?pack=sphere.foveal&paused", async (opened) => {
    const { page } = opened;
    await told(page, "settled");
    const keys = page.getByRole("dialog", { name: "Keys" });
    const figures = page.getByRole("region", { name: "Figures" });
    await page.keyboard.press("h");
    await keys.waitFor({ state: "visible" });
    const rows = await keys.getByRole("row").allTextContents();
    const does = (said: string): boolean => rows.some((row) => row.includes(said));
    expect(["play, pause", "next policy", "full screen", "sound"].map(does)).toEqual([
      true,
      true,
      true,
      // This pack has none.
      false,
    ]);
    await page.keyboard.press("h");
    await keys.waitFor({ state: "hidden" });
    await figures.waitFor({ state: "visible" });
    await page.keyboard.press("h");
    await figures.waitFor({ state: "hidden" });
    const press = async (key: string): Promise<Stats> => {
      await page.keyboard.press(key);
      return settled(opened);
    };
    expect((await press("]")).frame).toBe(49);
    expect((await press("[")).frame).toBe(0);
    expect((await press("p")).policy).toBe("acuity");
    expect((await press("Shift+P")).policy).toBe("viewport");
  });
});

test("an address says where a view begins, and keeps where one looks", async () => {
  let shared = "";
  let before = 0;
  await on("view.html?pack=sphere.foveal&paused&yaw=90&pitch=20&fov=50", async (opened) => {
    const { page } = opened;
    const first = (await told(page, "settled")) as Stats;
    expect(first.headDeg[0]).toBeCloseTo(90, 6);
    expect(first.headDeg[1]).toBeCloseTo(20, 6);
    expect(first.fovDeg).toBeCloseTo(50, 6);
    near((await seen(page)).at(0.5, 0.5), 0.5 + 90 / 360, 0.5 - 20 / 180);
    const steps = await page.evaluate(() => history.length);
    await page.keyboard.press("ArrowRight");
    await page.keyboard.press("+");
    const { headDeg, fovDeg } = await settled(opened);
    expect(fovDeg).toBeLessThan(50);
    await page.waitForURL((url) => {
      const [yaw, fov] = ["yaw", "fov"].map((name) => Number(url.searchParams.get(name)));
      return yaw === Number(headDeg[0].toFixed(2)) && fov === Number(fovDeg.toPrecision(3));
    });
    expect(await page.evaluate(() => history.length)).toBe(steps);
    [shared, before] = [new URL(page.url()).search, headDeg[0]];
    expect(shared).toMatch(/^\?pack=sphere\.foveal&paused&yaw=/);
  });
  await on(`view.html${shared}`, async ({ page }) => {
    const { headDeg } = (await told(page, "settled")) as Stats;
    expect(headDeg[0]).toBeCloseTo(before, 1);
    // An attribute that changes turns the view.
    await page.evaluate(() => document.querySelector("foveal-view")?.setAttribute("yaw", "-45"));
    const yaw = async (): Promise<number | undefined> =>
      page.evaluate(async () => {
        const stats = await document.querySelector("foveal-view")?.stats();
        return stats?.headDeg[0];
      });
    await expect.poll(yaw).toBeCloseTo(-45, 6);
    // Back at the front the address does not mention it.
    await page.keyboard.press("0");
    await page.waitForURL((url) => url.search === "?pack=sphere.foveal&paused");
  });
});

test("a direction that is none is said and left out, and flat content has none", async () => {
  await on("view.html?pack=sphere.foveal&paused&yaw=north&fov=200", async ({ page }) => {
    await page.getByText("yaw is north; give -360 to 360 degrees.").waitFor();
    const { headDeg, fovDeg } = (await told(page, "settled")) as Stats;
    expect([...headDeg, Math.round(fovDeg)]).toEqual([0, 0, 0, 100]);
  });
  const flat = "?pack=flat.foveal&paused&yaw=90&fov=20";
  await on(`view.html${flat}`, async (opened) => {
    expect(((await told(opened.page, "settled")) as Stats).zoom).toBe(1);
    await opened.page.keyboard.press("+");
    expect((await settled(opened)).zoom).toBeGreaterThan(1);
    expect(new URL(opened.page.url()).search).toBe(flat);
  });
});

test("a policy chosen among the figures rules at once", async () => {
  await on("view.html?pack=flat.foveal&paused", async (opened) => {
    const { page } = opened;
    await told(page, "settled");
    await page.keyboard.press("o");
    await page.getByRole("combobox", { name: "Policy" }).selectOption("coarsest");
    const figures = await settled(opened);
    expect(figures.policy).toBe("coarsest");
    const panel = page.getByRole("region", { name: "Figures" });
    const shown = (await panel.textContent()) ?? "";
    for (const words of ["late pictures", "left-out pictures", "came after its time"]) {
      expect(shown).toContain(words);
    }
    expect(figures.levels.slice(0, -1).every((count) => count === 0)).toBe(true);
  });
});

test("on a phone it fits, and a finger turns it", async () => {
  const phone = {
    viewport: { width: 360, height: 640 },
    hasTouch: true,
    isMobile: true,
    deviceScaleFactor: 2,
    colorScheme: "dark",
  } as const;
  const work = async (opened: Opened): Promise<void> => {
    const { page } = opened;
    await told(page, "settled");
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    expect(wide).toBeLessThanOrEqual(360);
    const buttons = page.locator("foveal-view .bar button:visible");
    for (const button of await buttons.all()) {
      const box = await button.boundingBox();
      expect(box !== null && box.x >= 0 && box.x + box.width <= 360).toBe(true);
    }
    // The larger side has 100 degrees: half of them to the upper edge.
    const stage = await page.locator("foveal-view .stage").boundingBox();
    if (stage === null) throw new Error("no stage");
    expect(stage.height).toBeGreaterThan(stage.width);
    await page.mouse.move(stage.x + stage.width / 2, stage.y + 0.5);
    expect((await settled(opened)).gazeDeg[1]).toBeCloseTo(50, 0);
    const session = await page.context().newCDPSession(page);
    const touch = (type: string, x: number): Promise<unknown> =>
      session.send("Input.dispatchTouchEvent", {
        type: type as "touchStart",
        touchPoints: type === "touchEnd" ? [] : [{ x, y: 300 }],
      });
    await touch("touchStart", 250);
    await touch("touchMove", 150);
    await touch("touchEnd", 150);
    expect((await settled(opened)).headDeg[0]).toBeGreaterThan(5);
    // Two fingers that part bring it closer.
    for (const apart of [40, 80, 120, 0]) {
      const fingers = [180 - apart / 2, 180 + apart / 2].map((x, id) => ({ x, y: 300, id }));
      await session.send("Input.dispatchTouchEvent", {
        type: apart === 40 ? "touchStart" : apart === 0 ? "touchEnd" : "touchMove",
        touchPoints: apart === 0 ? [] : fingers,
      });
    }
    expect((await settled(opened)).zoom).toBeGreaterThan(2);
    await page.keyboard.press("0");
    // Held upright, then turned a quarter to the right.
    await page.getByRole("button", { name: "Turn by moving the device" }).click();
    await page.locator('foveal-view button[aria-pressed="true"]').waitFor();
    await page.evaluate(() => {
      for (const alpha of [0, -90]) {
        const held = { alpha, beta: 90, gamma: 0 };
        window.dispatchEvent(new DeviceOrientationEvent("deviceorientation", held));
      }
    });
    expect((await settled(opened)).headDeg[0]).toBeGreaterThan(85);
  };
  await on("view.html?pack=sphere.foveal&paused", work, phone);
});

test("both kinds of content play on, round after round", async () => {
  for (const pack of ["flat", "sphere"]) {
    await on(`view.html?pack=${pack}.foveal&muted`, async (opened) => {
      const { page } = opened;
      await told(page, "picture");
      // The content lasts two seconds: time that falls has started over.
      let [before, rounds, frames] = [0, 0, 0];
      while (rounds < 1 || frames < 3) {
        const { time, playing, framesShown } = await stats(opened);
        expect(playing).toBe(true);
        if (time < before) rounds += 1;
        [before, frames] = [time, framesShown];
      }
    });
  }
});

test("sound begins with a key, without a gap, in step with the pictures", async () => {
  await on("view.html?pack=flat.foveal&paused", async ({ page }) => {
    await told(page, "picture");
    await page.getByRole("button", { name: "Unmute" }).waitFor();
    // What is put on the audio clock: when, when it was known, and its samples.
    await page.evaluate(() => {
      const placed: { at: number; known: number; samples: number[] }[] = [];
      Object.assign(window, { placed });
      const start = AudioBufferSourceNode.prototype.start;
      AudioBufferSourceNode.prototype.start = function note(at = 0): void {
        const samples = [...(this.buffer?.getChannelData(0) ?? [])];
        placed.push({ at, known: this.context.currentTime, samples });
        start.call(this, at);
      };
    });
    await page.keyboard.press("m");
    await page.getByRole("button", { name: "Mute", exact: true }).waitFor();
    await page.keyboard.press("Space");
    const kept = await page.waitForFunction(() => {
      const { placed } = window as unknown as { placed: { at: number }[] };
      return placed.length >= 4 ? placed : null;
    });
    type Placed = { at: number; known: number; samples: number[] };
    const [first, ...others] = ((await kept.jsonValue()) ?? []) as Placed[];
    if (first === undefined) throw new Error("nothing was heard");
    let end = first.at + first.samples.length / 48_000;
    // What is heard without anything left out.
    const stretches = [[first.samples]];
    for (const { at, known, samples } of others) {
      expect(at).toBeGreaterThan(end - 1e-4);
      // Where a busy machine knows a piece only after the one before is over, it comes at once.
      const late = at > end + 1e-4;
      if (late) expect(end).toBeLessThan(known);
      if (late && at > known + 1e-4) {
        // After half a second of silence sound begins where the picture is by then.
        expect(end + 0.5).toBeLessThan(known);
        expect(at).toBeLessThan(known + 0.08 + 1e-4);
        stretches.push([]);
      }
      stretches.at(-1)?.push(samples);
      end = at + samples.length / 48_000;
    }
    // The tone starts over with every fifth picture, to 5 ms.
    let beats = 0;
    for (const pieces of stretches) {
      const whole = pieces.flat();
      const loudest = (from: number): number => {
        const part = whole.slice(from, from + 9600).map(Math.abs);
        return part.indexOf(Math.max(...part));
      };
      // A stretch begins where the picture is by then, which is within some beat.
      const count = Math.floor(whole.length / 9600);
      const [begun = 0, ...onsets] = Array.from({ length: count }, (_, at) => loudest(at * 9600));
      for (const onset of onsets) {
        // The last sample of a beat is next to the first of the next.
        const away = Math.abs(onset - begun);
        expect(Math.min(away, 9600 - away)).toBeLessThan(240);
      }
      beats += count;
    }
    expect(beats).toBeGreaterThan(8);
  });
});
