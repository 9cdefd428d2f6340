// Does the element work in another site's page, in a headset, and with a gaze from outside?

import { execFile } from "node:child_process";
import { mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import { createServer } from "node:http";
import { createHash } from "node:crypto";
import { tmpdir } from "node:os";
import { join } from "node:path";
import type { AddressInfo, Socket } from "node:net";
import { promisify } from "node:util";
import type { Browser } from "playwright-core";
import { afterAll, beforeAll, expect, inject, test } from "vitest";
import { RangeHost } from "../range-server.ts";
import { connect, countTold, open, seen, settled, told } from "./browser.ts";

const run = promisify(execFile);

let browser: Browser;

beforeAll(async () => {
  browser = await connect(inject("browser"));
});

afterAll(() => browser.close());

/** Another site's page, in three lines. */
const FOREIGN = (site: string): string => `<!doctype html>
<script type="module" src="${site}foveal-view.js"></script>
<foveal-view src="${site}sphere.foveal" paused style="width: 400px"></foveal-view>`;

test("three lines show a pack in a page of another origin", async () => {
  const folder = await mkdtemp(join(tmpdir(), "foveal-foreign-"));
  const host = await RangeHost.of(inject("site"), { allowOrigin: "*", delayMs: 10 });
  await writeFile(join(folder, "index.html"), FOREIGN(host.url));
  const foreign = await RangeHost.of(folder);
  const opened = await open(browser, foreign.url);
  const { page, complaints } = opened;
  try {
    await told(page, "settled");
    const api = await page.evaluate(async () => {
      const view = document.querySelector("foveal-view");
      if (view === null) throw new Error("no element");
      const pose = await view.pose({ yawDeg: 30, pitchDeg: 10 });
      view.seek(1);
      view.gaze({ t_s: 0, yaw_deg: 30, pitch_deg: 10 });
      return { pose, seconds: view.pack?.seconds };
    });
    expect(api.seconds).toBeCloseTo(2, 1);
    const stats = await settled(opened);
    expect(stats.headDeg[0]).toBeCloseTo(30, 0);
    expect(stats.frame).toBe(25);
    expect((await seen(page)).at(0.5, 0.5).some((channel) => channel > 30)).toBe(true);
    expect(complaints).toEqual([]);
  } finally {
    await page.context().close();
    await Promise.all([host.close(), foreign.close(), rm(folder, { recursive: true })]);
  }
});

test("a headset shows both eyes, each with its picture", async () => {
  const host = await RangeHost.of(inject("site"), { delayMs: 10 });
  const { page } = await open(browser, "about:blank");
  const iwer = join(import.meta.dirname, "../../node_modules/iwer/build/iwer.min.js");
  await page.addInitScript({ path: iwer });
  await page.addInitScript(() => {
    const { XRDevice, metaQuest3 } = (window as unknown as { IWER: typeof import("iwer") }).IWER;
    const device = new XRDevice(metaQuest3);
    device.installRuntime({ forceInstall: true });
    device.stereoEnabled = true;
    Object.assign(window, { device });
  });
  try {
    await page.goto(`${host.url}view.html?pack=sphere.foveal&paused`);
    await told(page, "settled");
    const enter = page.getByRole("button", { name: "Enter the headset" });
    await enter.waitFor();
    // What reaches the headset's framebuffer is read where it is drawn.
    await page.evaluate(() => {
      const drawn: number[][] = [];
      Object.assign(window, { drawn });
      const draw = WebGL2RenderingContext.prototype.drawArrays;
      WebGL2RenderingContext.prototype.drawArrays = function read(...values): void {
        draw.apply(this, values);
        const port = this.getParameter(this.VIEWPORT) as Int32Array;
        const [x = 0, y = 0, width = 0, height = 0] = port;
        const pixel = new Uint8Array(4);
        const [px, py] = [x + (width >> 1), y + (height >> 1)];
        this.readPixels(px, py, 1, 1, this.RGBA, this.UNSIGNED_BYTE, pixel);
        if (drawn.length < 64) drawn.push([x, ...pixel]);
      };
    });
    await enter.click();
    await page.waitForFunction(() => {
      const { drawn } = window as unknown as { drawn: number[][] };
      return new Set(drawn.map(([x]) => x)).size === 2;
    });
    expect(await told(page, "headset")).toBe(true);
    const drawn = await page.evaluate(() => (window as unknown as { drawn: number[][] }).drawn);
    for (const [, red = 0, green = 0] of drawn.slice(-2)) {
      expect(Math.abs(red - 128)).toBeLessThan(30);
      expect(Math.abs(green - 128)).toBeLessThan(30);
    }
    const before = await countTold(page);
    await page.evaluate(() => {
      const { device } = window as unknown as { device: import("iwer").XRDevice };
      void device.activeSession?.end();
    });
    expect(await told(page, "headset", before)).toBe(false);
    await told(page, "settled", before);
  } finally {
    await page.context().close();
    await host.close();
  }
});

test("a site says of its packs what its maker says, as text and never as HTML", async () => {
  const folder = await mkdtemp(join(tmpdir(), "foveal-said-"));
  const evil = '<img src="x" onerror="window.evil = 1"> & more';
  const said = [`title = '${evil}'`, `description = '${evil}'`, "licence = 'CC BY 4.0 <b>'"];
  await writeFile(join(folder, "about.toml"), ["[flat]", ...said].join("\n"));
  const packs = ["sphere", "flat"].map((name) => join(inject("packs"), `${name}.foveal`));
  const site = join(folder, "site");
  const options = ["--title", evil, "--order", "flat", "--about", join(folder, "about.toml")];
  await run(inject("program"), ["export", "site", ...packs, "--out", site, ...options]);
  const host = await RangeHost.of(site);
  const { page, complaints } = await open(browser, host.url);
  try {
    await page.locator("#packs a").first().waitFor();
    expect([await page.title(), await page.locator("h1").textContent()]).toEqual([evil, evil]);
    expect(await page.locator("#packs h2").allTextContents()).toEqual([evil, "sphere"]);
    expect(await page.locator("#packs .about").allTextContents()).toEqual([evil]);
    expect(await page.locator("#packs a p").first().textContent()).toContain(", CC BY 4.0 <b>");
    await page.locator("#packs a").first().click();
    await page.getByText("CC BY 4.0 <b>").waitFor();
    expect([await page.title(), await page.locator("h1").textContent()]).toEqual([evil, evil]);
    expect(await page.locator("header .about").textContent()).toBe(evil);
    const name = await page.locator("foveal-view .stage").getAttribute("aria-label");
    expect(name).toBe(`${evil}. Arrow keys look around; H lists keys.`);
    expect(await page.evaluate(() => "evil" in window)).toBe(false);
    expect(complaints).toEqual([]);
  } finally {
    await page.context().close();
    await Promise.all([host.close(), rm(folder, { recursive: true })]);
  }
});

test("the manifest lists the attributes that the element heeds", async () => {
  const host = await RangeHost.of(inject("site"));
  const { page } = await open(browser, `${host.url}view.html`);
  try {
    await page.evaluate("import('./foveal-view.js')");
    const heeded = await page.evaluate(() => {
      const made = customElements.get("foveal-view") as unknown;
      return (made as { observedAttributes?: string[] } | undefined)?.observedAttributes ?? [];
    });
    const web = join(import.meta.dirname, "../..");
    const manifest = JSON.parse(await readFile(join(web, "custom-elements.json"), "utf8")) as {
      modules: { declarations: { attributes: { name: string }[] }[] }[];
    };
    const listed = manifest.modules[0]?.declarations[0]?.attributes.map(({ name }) => name) ?? [];
    expect([...heeded].sort()).toEqual([...listed].sort());
    // None is read that is not among them.
    const source = await readFile(join(web, "src/element/view-element.ts"), "utf8");
    const read = source.matchAll(/(?:get|has)Attribute\("([a-z-]+)"\)/g);
    for (const [, name] of read) expect(heeded).toContain(name);
  } finally {
    await page.context().close();
    await host.close();
  }
});

/** A WebSocket server that sends lines to any client, and hears nothing. */
async function gazeServer(line: string): Promise<{ url: string; close: () => void }> {
  const sockets = new Set<Socket>();
  const server = createServer();
  server.on("upgrade", (request, socket: Socket) => {
    const key = request.headers["sec-websocket-key"] ?? "";
    const accept = createHash("sha1")
      .update(`${key}258EAFA5-E914-47DA-95CA-C5AB0DC85B11`)
      .digest("base64");
    const head = "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\n";
    socket.write(`${head}Connection: Upgrade\r\nSec-WebSocket-Accept: ${accept}\r\n\r\n`);
    const text = Buffer.from(line);
    socket.write(Buffer.concat([Buffer.from([0x81, text.length]), text]));
    sockets.add(socket);
    socket.on("error", () => undefined);
  });
  await new Promise<void>((ready) => server.listen(0, "127.0.0.1", ready));
  const { port } = server.address() as AddressInfo;
  return {
    url: `ws://127.0.0.1:${port}`,
    close: () => {
      for (const socket of sockets) socket.destroy();
      server.close();
    },
  };
}

test("a tracker's gaze comes through a WebSocket, and a wrong address is said", async () => {
  const host = await RangeHost.of(inject("site"), { delayMs: 10 });
  const sender = await gazeServer('{"t_s":1,"yaw_deg":12,"pitch_deg":-5}');
  const gaze = encodeURIComponent(sender.url);
  const opened = await open(browser, `${host.url}view.html?pack=flat.foveal&gaze=${gaze}`);
  const { page, complaints } = opened;
  try {
    // A link from someone else connects to nothing before the viewer agrees.
    const question = page.getByText("Take the gaze of an eye tracker");
    await question.waitFor();
    await page.getByRole("button", { name: "Connect" }).click();
    expect(await question.count()).toBe(0);
    expect(await told(page, "gazeconnection")).toBe(true);
    const yaw = async (): Promise<number> => {
      const stats = await page.evaluate(() => document.querySelector("foveal-view")?.stats());
      return stats?.gazeDeg[0] ?? Number.NaN;
    };
    await expect.poll(yaw, { timeout: 120_000 }).toBeCloseTo(12, 0);
    sender.close();
    expect(await told(page, "gazeconnection", 1)).toBeDefined();
    await page.goto(`${host.url}view.html?pack=flat.foveal&gaze=udp:5005`);
    await page.getByRole("button", { name: "Connect" }).click();
    await page.getByText("give a WebSocket address").waitFor();
    expect(complaints).toEqual([]);
  } finally {
    await page.context().close();
    sender.close();
    await host.close();
  }
});
