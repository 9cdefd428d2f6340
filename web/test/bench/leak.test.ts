// Does memory stay what it is, however long a viewer looks around?
//
// Minutes of looking over a loopback: no part of `make test`. MINUTES says how many, 10 if nothing.

import { readdirSync, readFileSync } from "node:fs";
import { expect, inject, test } from "vitest";
import { RangeHost } from "../range-server.ts";
import { connect, serveBrowser } from "../e2e/browser.ts";

const MINUTES = Number(process.env.MINUTES ?? 10);
/** How much more than after the first minute is no leak. */
const MOST_GROWTH = 1.1;

/** Bytes of a process and all that it started, that they do not share. */
function bytesOf(root: number): number {
  const parents = new Map<number, number>();
  for (const name of readdirSync("/proc")) {
    try {
      const status = readFileSync(`/proc/${name}/stat`, "utf8");
      parents.set(Number(name), Number(status.slice(status.lastIndexOf(")") + 2).split(" ")[1]));
    } catch {
      // No process, or gone.
    }
  }
  const isOurs = (id: number): boolean =>
    id === root || (id > 1 && isOurs(parents.get(id) ?? 0));
  let pages = 0;
  for (const id of parents.keys()) {
    if (!isOurs(id)) continue;
    try {
      const [, resident, shared] = readFileSync(`/proc/${id}/statm`, "utf8").split(" ").map(Number);
      pages += (resident ?? 0) - (shared ?? 0);
    } catch {
      // It ended meanwhile.
    }
  }
  return pages * 4096;
}

test(`${MINUTES} minutes of looking round need no more memory than the first`, async () => {
  const host = await RangeHost.of(inject("site"));
  const server = await serveBrowser();
  const browser = await connect(server.wsEndpoint());
  const page = await browser.newPage({ viewport: { width: 640, height: 400 } });
  await page.goto(`${host.url}view.html?pack=sphere.foveal&demo`);
  await page.waitForTimeout(5000);
  const measured: number[] = [];
  const began = performance.now();
  let [turn, next] = [0, 60];
  while (next <= 60 * MINUTES) {
    turn += 1;
    const [x, y] = [320 + 250 * Math.sin(turn * 1.7), 200 + 150 * Math.cos(turn * 2.3)];
    await page.mouse.move(x, y, { steps: 3 });
    if (turn % 7 === 0) {
      await page.mouse.down();
      await page.mouse.move(640 - x, 400 - y, { steps: 5 });
      await page.mouse.up();
    }
    if (turn % 31 === 0) await page.mouse.wheel(0, turn % 62 === 0 ? 400 : -400);
    await page.waitForTimeout(100);
    if (performance.now() - began < 1000 * next) continue;
    measured.push(bytesOf(server.process().pid ?? 0));
    console.log(`${next / 60} min: ${((measured.at(-1) ?? 0) / 1e6).toFixed(1)} MB`);
    next += 60;
  }
  await browser.close();
  await server.close();
  await host.close();
  expect((measured.at(-1) ?? 0) / (measured[0] ?? 1)).toBeLessThan(MOST_GROWTH);
}, 60_000 * (MINUTES + 3));
