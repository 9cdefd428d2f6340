import { expect, test } from "vitest";
import { type Failure, Loader, type World } from "./loader.ts";

const FILE = Uint8Array.from({ length: 5_000_000 }, (_, n) => (n * 7) % 253);

interface Asked {
  readonly from: number;
  readonly to: number;
  readonly signal: AbortSignal | undefined;
  readonly cache: RequestCache | undefined;
  answer(status?: number, tag?: string): void;
  fail(): void;
}

/** A host that answers when the test says so, and a clock that the test moves. */
class Host {
  readonly asked: Asked[] = [];
  readonly failures: [Failure, number][] = [];
  readonly said: string[] = [];
  now = 0;
  readonly #waits: { at: number; then: () => void }[] = [];
  readonly loader: Loader;

  constructor() {
    const world: World = {
      fetch: (_input, how) => this.#fetch(how as RequestInit),
      now: () => this.now,
      wait: (ms, then) => this.#waits.push({ at: this.now + ms, then }),
    };
    const events = {
      bytes: () => {},
      failed: (why: Failure, status: number) => void this.failures.push([why, status]),
      restored: () => void this.said.push("restored"),
      changed: () => void this.said.push("changed"),
    };
    this.loader = new Loader("pack", 1 << 28, events, world);
  }

  #fetch(how: RequestInit): Promise<Response> {
    const range = (how.headers as Record<string, string>)["Range"] ?? "";
    const [from, to] = range.slice(6).split("-").map(Number) as [number, number];
    const signal = how.signal ?? undefined;
    return new Promise((resolve, reject) => {
      signal?.addEventListener("abort", () => reject(new Error("aborted")));
      this.asked.push({
        from,
        to,
        signal,
        cache: how.cache,
        answer: (status = 206, tag = "a") => {
          const headers = { "Content-Range": `bytes ${from}-${to}/${FILE.length}`, ETag: tag };
          const body = status === 206 ? FILE.slice(from, to + 1) : null;
          resolve(new Response(body, { status, headers }));
        },
        fail: () => reject(new TypeError("no network")),
      });
    });
  }

  /** Lets what was answered arrive. */
  async settle(): Promise<void> {
    for (let n = 0; n < 20; n++) await new Promise((done) => setTimeout(done));
  }

  async pass(ms: number): Promise<void> {
    this.now += ms;
    for (const wait of this.#waits.splice(0)) {
      if (wait.at <= this.now) wait.then();
      else this.#waits.push(wait);
    }
    await this.settle();
  }
}

const want = (offset: number, bytes: number, early = false) => ({ offset, bytes, early });

test("bytes arrive once, however often they are wanted", async () => {
  const host = new Host();
  host.loader.want([want(100, 1000)]);
  host.loader.want([want(100, 1000), want(600, 2000)]);
  await host.settle();
  expect(host.asked.map(({ from, to }) => [from, to])).toEqual([[100, 1099], [1100, 2599]]);
  host.asked.forEach((asked) => asked.answer());
  await host.settle();
  host.loader.want([want(0, 100), want(100, 2500)]);
  await host.settle();
  expect(host.asked[2]).toMatchObject({ from: 0, to: 99 });
  expect(host.loader.bytes.get(want(100, 2500))).toEqual(FILE.slice(100, 2600));
});

test("no byte is asked for twice, whatever is wanted and in whatever order it comes", async () => {
  const host = new Host();
  let state = 1;
  const random = (below: number): number => {
    state = (Math.imul(state, 1_664_525) + 1_013_904_223) >>> 0;
    return Math.floor((state / 2 ** 32) * below);
  };
  const twice: string[] = [];
  for (let step = 0; step < 300; step++) {
    const count = 1 + random(6);
    host.loader.want(Array.from({ length: count }, () => want(random(1e6), 1 + random(8000))));
    if (random(2) === 0) host.asked[random(host.asked.length)]?.answer();
    if (random(8) === 0) await host.settle();
  }
  host.asked.forEach((one, index) => {
    for (const other of host.asked.slice(0, index)) {
      const overlaps = one.from <= other.to && other.from <= one.to;
      if (overlaps) twice.push(`${other.from}-${other.to}, then ${one.from}-${one.to}`);
    }
  });
  expect(twice).toEqual([]);
  expect(host.asked.length).toBeGreaterThan(50);
});

test("requests no longer wanted are cancelled, and what arrived of them stays", async () => {
  const host = new Host();
  host.loader.want([want(0, 500_000)]);
  await host.settle();
  host.loader.want([want(1_000_000, 100)]);
  await host.settle();
  expect(host.asked.map(({ signal }) => signal?.aborted)).toEqual([true, false]);
  expect(host.failures).toEqual([]);
});

test("sixteen requests are under way at most, three of them early", async () => {
  const host = new Host();
  const far = Array.from({ length: 20 }, (_, n) => want(n * 200_000, 1000, true));
  host.loader.want(far);
  await host.settle();
  expect(host.asked.length).toBe(3);
  host.loader.want([...far.map((w) => ({ ...w, early: false }))]);
  await host.settle();
  expect(host.asked.length).toBe(16);
});

test("a host that fails is asked again, later and later, until it answers", async () => {
  const host = new Host();
  host.loader.want([want(0, 1000)]);
  await host.settle();
  host.asked[0]?.answer(404);
  await host.settle();
  expect(host.failures).toEqual([["not-found", 404]]);
  await host.pass(249);
  expect(host.asked.length).toBe(1);
  await host.pass(1);
  expect(host.asked.length).toBe(2);
  host.asked[1]?.fail();
  await host.settle();
  await host.pass(499);
  expect(host.asked.length).toBe(2);
  host.loader.hurry();
  await host.settle();
  host.asked[2]?.answer();
  await host.settle();
  expect(host.said).toEqual(["restored"]);
  expect(host.loader.bytes.get(want(0, 1000))).toEqual(FILE.slice(0, 1000));
});

test("another file under the same address is noticed", async () => {
  const host = new Host();
  host.loader.want([want(0, 1000)]);
  await host.settle();
  host.asked[0]?.answer();
  await host.settle();
  host.loader.want([want(5000, 1000)]);
  await host.settle();
  host.asked[1]?.answer(206, "b");
  await host.settle();
  expect(host.said).toEqual(["changed"]);
  // A browser's cache would merge the two files, or ask for all of the other.
  expect(host.asked.map(({ cache }) => cache)).toEqual(["no-store", "no-store"]);
});

test("another file is noticed while all that is wanted is in memory, once a minute", async () => {
  const host = new Host();
  host.loader.want([want(0, 1000)]);
  await host.settle();
  host.asked[0]?.answer();
  await host.settle();
  await host.pass(59_000);
  host.loader.check();
  await host.settle();
  expect(host.asked.length).toBe(1);
  await host.pass(1000);
  host.loader.check();
  host.loader.check();
  await host.settle();
  expect(host.asked.length).toBe(2);
  host.asked[1]?.fail();
  await host.pass(60_000);
  host.loader.check();
  await host.settle();
  host.asked[2]?.answer(206, "b");
  await host.settle();
  expect([host.said, host.failures]).toEqual([["changed"], []]);
});

test("a host without ranges is reported", async () => {
  const host = new Host();
  host.loader.want([want(0, 1000)]);
  await host.settle();
  host.asked[0]?.answer(200);
  await host.settle();
  expect(host.failures).toEqual([["no-ranges", 200]]);
});

test("throughput counts only the time in which something was on its way", async () => {
  const host = new Host();
  host.loader.want([want(0, 1_000_000)]);
  await host.settle();
  host.now += 500;
  host.asked[0]?.answer();
  await host.settle();
  host.now += 60_000;
  expect(host.loader.meter.bytesPerSecond).toBeCloseTo(2_000_000);
});
