// Does a page show what a score takes, and say so?

import type { Browser } from "playwright-core";
import { afterAll, beforeAll, expect, inject, test } from "vitest";
import type { Stats } from "../../src/engine/api.ts";
import { RangeHost } from "../range-server.ts";
import { type Opened, connect, open, settled, told } from "./browser.ts";

let browser: Browser;
let host: RangeHost;

beforeAll(async () => {
  browser = await connect(inject("browser"));
  host = await RangeHost.of(inject("site"), { delayMs: 20 });
});

afterAll(async () => {
  await browser.close();
  await host.close();
});

/**
 * Opens a pack, looks at its middle until all is shown that is wanted, and goes on from there.
 * `said` is a sentence that the page shows at first, for some seconds.
 */
async function looking(
  query: string,
  work: (opened: Opened, stats: Stats) => Promise<void>,
  said?: string,
): Promise<void> {
  const opened = await open(browser, `${host.url}view.html?${query}&paused`);
  try {
    if (said !== undefined) await opened.page.getByText(said).waitFor();
    await told(opened.page, "picture");
    await work(opened, await settled(opened));
    expect(opened.complaints).toEqual([]);
  } finally {
    await opened.page.context().close();
  }
}

const figuresOf = async ({ page }: Opened): Promise<string> => {
  const panel = page.getByRole("region", { name: "Figures" });
  if (!(await panel.isVisible())) await page.keyboard.press("o");
  await panel.waitFor({ state: "visible" });
  return (await panel.textContent()) ?? "";
};

test("a demo fetches and shows less for 9 than for 9.75, and says so", async () => {
  const fetched: number[] = [];
  const shown: number[] = [];
  for (const target of [9, 9.75]) {
    // From a low score on: what is fetched while the table of worth is on its way is a matter of
    // time.
    await looking("pack=flat.foveal&demo&target=2", async (opened, first) => {
      expect([first.policy, first.target]).toEqual(["perceptual", 2]);
      await opened.page
        .locator("foveal-view")
        .evaluate((it, to) => it.setAttribute("target", String(to)), target);
      await expect
        .poll(async () => (await settled(opened)).expectedScore, { timeout: 60_000 })
        .toBeGreaterThanOrEqual(target);
      const stats = await settled(opened);
      expect(stats.target).toBe(target);
      await expect.poll(() => figuresOf(opened)).toContain(`${target} asked, `);
      expect(await figuresOf(opened)).toContain("perceptual");
      fetched.push(stats.bytesFetched - first.bytesFetched);
      shown.push(stats.share);
    });
  }
  for (const [less = 0, more = 0] of [fetched, shown]) {
    expect(less, `${fetched.join()} bytes, ${shown.join()} shown`).toBeLessThan(0.7 * more);
  }
});

test("a key goes to other scores, and an attribute does", async () => {
  await looking("pack=sphere.foveal&demo", async (opened, first) => {
    const { page } = opened;
    expect([first.policy, first.target]).toEqual(["perceptual", 9.5]);
    await page.keyboard.press("j");
    await page.getByText("Target score 9.75").waitFor();
    const finer = await settled(opened);
    expect(finer.target).toBe(9.75);
    await page.keyboard.press("j");
    await page.getByText("No target score").waitFor();
    expect((await settled(opened)).target).toBe(null);
    const attribute = (value: string): Promise<void> =>
      page.locator("foveal-view").evaluate((it, to) => it.setAttribute("target", to), value);
    await attribute("8.5");
    await expect.poll(async () => (await settled(opened)).target).toBe(8.5);
    await attribute("12");
    await page.getByText("target is 12; give a score of 1 to 9.99, or none.").waitFor();
  });
});

test("a slope is acuity without a score, and both together are said to be wrong", async () => {
  await looking("pack=sphere.foveal&slope=0.011", async (_, stats) => {
    expect([stats.policy, stats.target]).toEqual(["acuity", null]);
  });
  const both = "target and slope are both given; give one of them";
  await looking("pack=sphere.foveal&demo&slope=0.011&target=9", async (_, stats) => {
    expect([stats.policy, stats.target]).toEqual(["perceptual", 9.5]);
  }, both);
});
