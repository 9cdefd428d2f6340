// How does a test get a page, and what does it see of it?

import { execFileSync } from "node:child_process";
import {
  type Browser,
  type BrowserContextOptions,
  type BrowserServer,
  type Page,
  chromium,
} from "playwright-core";
import type { Stats } from "../../src/engine/api.ts";
import { PNG } from "./png.ts";

/** Flags with which Chromium draws WebGPU that can be looked at, without a display or a GPU. */
export const DRAWS = [
  "--no-sandbox",
  "--enable-unsafe-webgpu",
  "--enable-features=Vulkan",
  "--use-angle=gl-egl",
  "--use-webgpu-adapter=swiftshader",
  "--ignore-gpu-blocklist",
  "--disable-background-networking",
  "--no-first-run",
  "--autoplay-policy=user-gesture-required",
];

export function executable(): string {
  for (const name of ["chromium", "chromium-browser", "google-chrome"]) {
    try {
      return execFileSync("sh", ["-c", `command -v ${name}`], { encoding: "utf8" }).trim();
    } catch {
      // The next name.
    }
  }
  throw new Error("no Chromium is installed: scripts/install.sh does it");
}

/** A browser that draws, to which files connect. */
export function serveBrowser(): Promise<BrowserServer> {
  return chromium.launchServer({ executablePath: executable(), args: DRAWS });
}

/** The browser at an address; what is opened here goes when this is closed, the browser stays. */
export function connect(address: string): Promise<Browser> {
  return chromium.connect(address);
}

/** A browser of one's own, without WebGPU. */
export function launchPlain(): Promise<Browser> {
  const args = ["--no-sandbox", "--disable-features=WebGPU"];
  return chromium.launch({ executablePath: executable(), args });
}

/** A page, and what it complained about. */
export interface Opened {
  readonly page: Page;
  /** Uncaught errors, and what a policy refused. */
  readonly complaints: string[];
}

export async function open(
  browser: Browser,
  address: string,
  options: BrowserContextOptions = {},
): Promise<Opened> {
  const context = await browser.newContext({ viewport: { width: 800, height: 600 }, ...options });
  const page = await context.newPage();
  page.setDefaultTimeout(120_000);
  const complaints: string[] = [];
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("console", (message) => {
    const text = message.text();
    if (message.type() === "error" && /Content Security Policy|Refused/.test(text)) {
      complaints.push(text);
    }
  });
  await page.addInitScript(watchEvents);
  await page.goto(address);
  return { page, complaints };
}

declare global {
  interface Window {
    /** Events of every foveal-view, in order. */
    told: { name: string; detail: unknown }[];
  }
}

/** Runs in the page: keeps what the element reports. */
function watchEvents(): void {
  const names =
    "ready picture settled problem changed lost restored play pause ended gazeconnection headset";
  window.told = [];
  const dispatch = EventTarget.prototype.dispatchEvent;
  EventTarget.prototype.dispatchEvent = function told(event: Event): boolean {
    if (event instanceof CustomEvent && names.split(" ").includes(event.type)) {
      window.told.push({ name: event.type, detail: event.detail as unknown });
    }
    return dispatch.call(this, event);
  };
}

/** Waits until the element reported something, from its `since`th event on. */
export async function told(page: Page, name: string, since = 0): Promise<unknown> {
  const found = await page.waitForFunction(
    ([wanted, from]) => {
      const event = window.told.slice(from).find((one) => one.name === wanted);
      return event === undefined ? null : { detail: event.detail };
    },
    [name, since] as const,
  );
  const value = await found.jsonValue();
  return value?.detail;
}

/** The figures of the page's view. */
export function stats({ page }: Opened): Promise<Stats> {
  return page.evaluate(() => {
    const view = document.querySelector("foveal-view");
    if (view === null) throw new Error("no foveal-view");
    return view.stats();
  });
}

/** Waits until all that was asked for so far is shown. */
export async function settled(opened: Opened): Promise<Stats> {
  for (;;) {
    const now = await stats(opened);
    if (now.settled) return now;
    await opened.page.waitForTimeout(20);
  }
}

/** How many events there were so far. */
export function countTold(page: Page): Promise<number> {
  return page.evaluate(() => window.told.length);
}

/** What is seen of the stage. */
export async function seen(page: Page): Promise<PNG> {
  return PNG.parse(await page.locator("foveal-view .stage").screenshot());
}
