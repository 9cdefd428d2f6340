// Is a link ever idle while something is wanted of it?
//
// A link in virtual time: nothing waits, so nothing depends on how busy the machine is.

import { expect, test } from "vitest";
import { Loader } from "./loader.ts";
import type { Want } from "./plan.ts";

const LENGTH = 40_000_000;
/** Bytes of one piece of an answer. */
const PIECE = 16 * 1024;

/** A host at the end of a link: answers take a round trip, and share the rate in turn. */
class Link {
  now = 0;
  sent = 0;
  readonly #events: { at: number; then: () => void }[] = [];
  #free = 0;

  constructor(
    readonly bytesPerMs: number,
    readonly trip: number,
  ) {}

  at(at: number, then: () => void): void {
    this.#events.push({ at, then });
    this.#events.sort((a, b) => a.at - b.at);
  }

  async run(): Promise<void> {
    for (;;) {
      for (let n = 0; n < 12; n++) await new Promise((done) => setImmediate(done));
      const next = this.#events.shift();
      if (!next) return;
      this.now = Math.max(this.now, next.at);
      next.then();
    }
  }

  readonly fetch = ((_url: string, how: RequestInit): Promise<Response> => {
    const range = (how.headers as Record<string, string>)["Range"] ?? "";
    const [from, last] = range.slice(6).split("-").map(Number) as [number, number];
    const to = Math.min(last, LENGTH - 1);
    const headers = { "Content-Range": `bytes ${from}-${to}/${LENGTH}`, ETag: "a" };
    return new Promise((resolve) => {
      this.at(this.now + this.trip, () => {
        let stream: ReadableStreamDefaultController<Uint8Array> | null = null;
        const body = new ReadableStream<Uint8Array>({ start: (it) => void (stream = it) });
        resolve(new Response(body, { status: 206, headers }));
        const send = (at: number): void => {
          const bytes = Math.min(PIECE, to + 1 - at);
          this.#free = Math.max(this.#free, this.now) + bytes / this.bytesPerMs;
          this.at(this.#free, () => {
            this.sent += bytes;
            stream?.enqueue(new Uint8Array(bytes));
            if (at + bytes > to) stream?.close();
            else send(at + bytes);
          });
        };
        send(from);
      });
    });
  }) as typeof fetch;
}

/** What is wanted, and what of it must be there before it is known what is wanted next. */
interface Stage {
  readonly wants: readonly Want[];
  readonly there?: readonly Want[];
}

/** Wants one stage after the other, and says when all of it was there. */
async function timeOf(link: Link, stages: readonly Stage[]): Promise<number> {
  let [stage, done] = [0, 0];
  const isThere = (want: Want) => loader.bytes.missing(want).length === 0;
  const loader = new Loader(
    "pack",
    1 << 28,
    {
      bytes: () => {
        for (;;) {
          const { wants, there } = stages[stage] ?? { wants: [] };
          if (stage === stages.length || !(there ?? wants).every(isThere)) return;
          stage += 1;
          done = link.now;
          loader.want(stages.slice(0, stage + 1).flatMap((one) => one.wants));
        }
      },
      failed: () => {},
      restored: () => {},
      changed: () => {},
    },
    { fetch: link.fetch, now: () => link.now, wait: (ms, then) => link.at(link.now + ms, then) },
  );
  loader.want(stages[0]?.wants ?? []);
  await link.run();
  expect(stage).toBe(stages.length);
  return done;
}

const want = (offset: number, bytes: number): Want => ({ offset, bytes, early: false });
/** A level's tiles in view: runs along the curve, as a view crosses it. */
const runs = (from: number, count: number) =>
  Array.from({ length: count }, (_, n) => want(from + n * 60_000, 30_000));

test("a still view is there after its bytes and two round trips", async () => {
  for (const [mbit, trip] of [[40, 30], [8, 60], [200, 10]] as const) {
    const link = new Link(mbit * 125, trip);
    // Header and description say where the index is, its pages where the tiles are.
    const beginning = { wants: [want(0, 393_216)], there: [want(0, 4096)] };
    const pages = { wants: [want(39_000_000, 16_000), want(39_500_000, 32_000)] };
    const tiles = [...runs(1_000_000, 60), ...runs(20_000_000, 30)];
    const took = await timeOf(link, [beginning, pages, { wants: tiles }]);
    const bytes = link.sent / link.bytesPerMs;
    expect(took, `${mbit} Mbit/s, ${trip} ms`).toBeLessThanOrEqual(bytes + 2 * trip + 1e-6);
  }
});

test("what a saccade asks for is there after one round trip and its bytes", async () => {
  const link = new Link(5000, 30);
  const fovea = runs(5_000_000, 6);
  const took = await timeOf(link, [{ wants: fovea }]);
  expect(took).toBeLessThanOrEqual(30 + link.sent / link.bytesPerMs + 1);
});
