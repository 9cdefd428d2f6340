// How soon does a page on a link show a pack, sharp, and after a jump of the eye?

import type { Browser, Page } from "playwright-core";
import { expect } from "vitest";
import type { EngineOptions } from "../../src/engine/api.ts";
import { open } from "./browser.ts";
import { makeVirtual, type VirtualLink } from "./virtual.ts";

const LINK: VirtualLink = { bitsPerSecond: 40e6, roundTrip: 0.06, framesPerSecond: 60 };
const FRAME = 1 / LINK.framesPerSecond;
/** Seconds until the first picture, and answers that it waits for one after the other, at most. */
const FIRST = { seconds: 0.6, trips: 2 };

/** Seconds and bytes from a moment to a later one. */
interface Spent {
  readonly seconds: number;
  readonly bytes: number;
}

/** What came of looking at a pack. */
export interface Looked {
  readonly picture: Spent;
  readonly trips: number;
  readonly settled: Spent;
  /** One for each place that was looked at. */
  readonly saccades: readonly Spent[];
}

type Places = readonly (readonly [number, number])[];

/** Opens a pack, lets it settle, and looks at places one after the other. */
async function look(page: Page, options: EngineOptions, places: Places): Promise<Looked> {
  return page.evaluate(
    async ({ options, places }) => {
      const { virtual } = window;
      let [began, had] = [virtual.now(), virtual.bytes()];
      const spent = () => ({ seconds: virtual.now() - began, bytes: virtual.bytes() - had });
      const engine = await window.Engine.open(document.body, { ...options, thread: "main" });
      let picture = { seconds: Infinity, bytes: Infinity };
      engine.on("picture", () => (picture = spent()));
      const settles = () => new Promise<void>((done) => void engine.on("settled", () => done()));
      await settles();
      const settled = spent();
      const saccades = [];
      for (const place of places) {
        // A fixation: eyes rest between their jumps.
        await virtual.pass(0.2);
        [began, had] = [virtual.now(), virtual.bytes()];
        const over = settles();
        engine.pointer(place);
        await over;
        saccades.push(spent());
      }
      const trips = (await engine.stats()).firstPictureTrips ?? Infinity;
      engine.close();
      return { picture, trips, settled, saccades };
    },
    { options, places },
  );
}

/** Seconds that bytes take on the link. */
const onLink = (bytes: number): number => (8 * bytes) / LINK.bitsPerSecond;

/** The same on a page of its own. */
async function lookFrom(
  browser: Browser,
  site: string,
  options: EngineOptions,
  places: Places,
): Promise<Looked> {
  const { page } = await open(browser, "about:blank");
  try {
    await makeVirtual(page, LINK);
    await page.goto(`${site}view.html`);
    await page.evaluate("import('./foveal-view.js').then((it) => (window.Engine = it.Engine))");
    return await look(page, options, places);
  } finally {
    await page.context().close();
  }
}

/** Fails unless a pack of a site is seen, sharp and followed as soon as a link allows. */
export async function expectPrompt(browser: Browser, site: string, src: string): Promise<void> {
  const options = { src, size: [800, 500], paused: true } as const;
  const still = await lookFrom(browser, site, options, []);
  const places = [[100, 400], [700, 100], [60, 60], [760, 440]] as const;
  const { saccades } = await lookFrom(browser, site, { ...options, demo: true }, places);
  const said = ({ seconds, bytes }: Spent) => `${seconds.toFixed(3)} s for ${bytes} bytes`;
  console.log(
    `${src}: first picture ${said(still.picture)}, ${still.trips} trips; ` +
      `settled ${said(still.settled)}; saccades ${saccades.map(said).join(", ")}`,
  );
  expect(still.trips).toBeLessThanOrEqual(FIRST.trips);
  expect(still.picture.seconds).toBeLessThanOrEqual(FIRST.seconds);
  const { seconds, bytes } = still.settled;
  // A picture of the screen is begun once the bytes are there, and shown with the next one.
  expect(seconds).toBeLessThanOrEqual(onLink(bytes) + 2 * LINK.roundTrip + 2 * FRAME);
  for (const saccade of saccades) {
    const bound = LINK.roundTrip + onLink(saccade.bytes) + 2 * FRAME;
    expect(saccade.seconds).toBeLessThanOrEqual(bound);
  }
}
