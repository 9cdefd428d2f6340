// How do bytes and planes get to what shows them?

import type { EngineProblem, PackFacts, PolicyName, Stats } from "./api.ts";
import { configOf, isStills } from "./codecs.ts";
import type { HostOptions, Tell } from "./calls.ts";
import { type Chunk, Decoders, type PictureWant } from "./decoders.ts";
import { type Failure, Loader } from "./loader.ts";
import { isEarly, isPage, isWhole, type Need, needsOf } from "./needs.ts";
import type { UnitNeed, WholeNeed } from "./needs.ts";
import type { Want } from "./plan.ts";
import { problem } from "./problem.ts";
import { Stills } from "./stills.ts";
import { headBytes, type Show } from "./wasm.ts";

/** Bytes from the beginning that are fetched before anything is known. */
const BEGINNING = 384 * 1024;
/** Bytes of the pack that are kept, where the page says nothing else. */
const USUAL_CACHE = 256 << 20;
/** Decoders: one a core, and never fewer or more than these. */
const DECODERS = [8, 12] as const;
/** Policies that choose by what units are worth. */
const VALUED: readonly PolicyName[] = ["acuity", "uniform", "eccentricity", "perceptual"];

/** What a courier reports. */
export interface CourierEvents {
  wake(): void;
  tell: Tell;
  ended(why: EngineProblem): void;
}

export class Courier {
  /** Round trips that the first picture waited for, one after the other. */
  trips = 1;
  readonly #loader: Loader;
  readonly #url: string;
  readonly #events: CourierEvents;
  #show: Show | null = null;
  /** A poster that is given the same pictures. */
  #poster: Show | null = null;
  #decoders: Decoders | Stills | null = null;
  #needs: readonly Need[] = [];
  readonly #extra: Want[] = [];
  #headWaits: ((head: Uint8Array | EngineProblem) => void) | null = null;
  /** Ends the wait of who opens the pack. */
  #refuse: ((why: EngineProblem) => void) | null = null;
  #pumping = false;
  /** The module that reads bytes is there. */
  #reads = false;
  #lost = false;
  /** Chunks whose lengths are known; the newest last. */
  readonly #chunks = new Map<number, Chunk>();
  /** Stretches that were damaged once, and units and pages that are. */
  readonly #retried = new Set<number>();
  readonly #damaged = new Set<number>();
  readonly #tables = new Map<string, Promise<boolean>>();

  constructor(begin: HostOptions, events: CourierEvents) {
    this.#events = events;
    this.#url = begin.url;
    const most = begin.options.cacheBytes ?? USUAL_CACHE;
    this.#loader = new Loader(
      begin.url,
      most,
      {
        bytes: () => this.#pump(),
        failed: (why, status) => this.#failed(why, status),
        restored: () => this.#restored(),
        changed: () => events.tell("changed", "the host has another file at this address now"),
      },
      {
        fetch: (input, how) => fetch(input, how),
        now: () => performance.now(),
        wait: (ms, then) => setTimeout(then, ms),
      },
    );
    for (const { offset, bytes } of begin.pieces) this.#loader.bytes.add(offset, bytes);
  }

  get bytesPerSecond(): number {
    return this.#loader.meter.bytesPerSecond;
  }

  /** Header and description; rejects with what is wrong. */
  head(): Promise<Uint8Array> {
    const beginning: Want = { offset: 0, bytes: BEGINNING, early: false };
    this.#extra.push(beginning);
    this.#onBytes.push(() => {
      const whole = this.#loader.bytes.missing(this.#inFile(beginning)).length === 0;
      if (whole) this.#extra.splice(this.#extra.indexOf(beginning), 1);
      return whole;
    });
    return new Promise((resolve, reject) => {
      this.#refuse = (why) => this.#headWaits?.(why);
      this.#headWaits = (head) => {
        this.#headWaits = null;
        this.#refuse = null;
        if (head instanceof Uint8Array) resolve(head);
        else reject(head);
      };
      this.#order();
      this.#pump();
    });
  }

  /** What the pack needs besides its head before it can be opened, one after the other: `stretches`
   *  are first bytes and lengths. */
  rest(stretches: Float64Array): Promise<Uint8Array<ArrayBuffer>> {
    const wants: Want[] = [];
    for (let at = 0; at + 1 < stretches.length; at += 2) {
      const [offset = 0, bytes = 0] = stretches.subarray(at, at + 2);
      wants.push({ offset, bytes, early: false });
    }
    const missing = (want: Want): boolean => this.#loader.bytes.missing(want).length > 0;
    if (wants.some(missing)) this.trips += 1;
    this.#extra.push(...wants);
    return new Promise((resolve, reject) => {
      this.#refuse = reject;
      this.#onBytes.push(() => {
        if (wants.some(missing)) return false;
        const whole = new Uint8Array(wants.reduce((sum, { bytes }) => sum + bytes, 0));
        let at = 0;
        for (const want of wants) {
          whole.set(this.#loader.bytes.get(want) ?? [], at);
          at += want.bytes;
          this.#extra.splice(this.#extra.indexOf(want), 1);
        }
        this.#refuse = null;
        resolve(whole);
        return true;
      });
      this.#order();
      this.#pump();
    });
  }

  /** From now on bytes can be read. */
  begin(): void {
    this.#reads = true;
    this.#pump();
  }

  /** Opens decoders for a pack. */
  async prepare(facts: PackFacts): Promise<void> {
    if (facts.kind === "scene") return;
    const events = {
      picture: (want: PictureWant, decoded: number, planes: Uint8Array) => {
        try {
          for (const show of new Set([this.#show, this.#poster])) {
            show?.deliver(want.unit, want.frame, decoded, planes);
          }
        } catch (error) {
          this.#show?.fail(want.unit, want.frame);
          this.#events.tell("error", problem("internal", false, String(error)));
        }
        this.#decoders?.buffers.give(planes);
        this.#events.wake();
      },
      failed: (want: PictureWant) => {
        this.#show?.fail(want.unit, want.frame);
        this.#events.wake();
      },
      idle: () => {},
      chunk: (unit: number) => this.#chunks.get(unit) ?? null,
    };
    if (isStills(facts.codec)) {
      if (typeof ImageDecoder === "undefined") throw problem("codec", true, facts.codec);
      this.#decoders = new Stills(facts.codec, events);
      return;
    }
    const config = await configOf(facts.codec);
    if (!config) throw problem("codec", true, facts.codec);
    const [least, most] = DECODERS;
    const count = Math.min(Math.max(navigator.hardwareConcurrency || least, least), most);
    this.#decoders = new Decoders(config, count, events);
  }

  /** Brings what a poster asks for until there is a show to serve, and then the same to both. */
  preview(poster: Show): void {
    this.#show = poster;
    this.#poster = poster;
    this.ask();
  }

  /** The poster is not needed any more. */
  forgetPoster(): void {
    if (this.#show === this.#poster) this.#show = null;
    this.#poster = null;
  }

  /** Begins to bring what `show` asks for. */
  serve(show: Show): void {
    this.#show = show;
    this.ask();
    void this.#table("frame_times");
  }

  /** Asks again what is needed. */
  ask(): void {
    if (!this.#show) return;
    this.#needs = needsOf(this.#show.needs());
    this.#order();
    this.#pump();
  }

  hurry(): void {
    this.#loader.hurry();
  }

  /** Looks, once in a while, whether the host still has this file. */
  check(): void {
    this.#loader.check();
  }

  stats(): Pick<Stats, "bytesFetched" | "requests" | "throughput" | "cachedBytes" | "decodeMs"> {
    return {
      bytesFetched: this.#loader.meter.total,
      requests: this.#loader.requests,
      throughput: this.bytesPerSecond * 8,
      cachedBytes: this.#loader.bytes.held,
      decodeMs: this.#decoders?.ms ?? 0,
    };
  }

  /** All bytes, for another thread. */
  take(): { offset: number; bytes: Uint8Array }[] {
    return this.#loader.bytes.take();
  }

  close(): void {
    this.#loader.close();
    this.#decoders?.close();
  }

  /** Fetches the tables that a policy chooses by; settles once they are there, or cannot be had. */
  async tablesFor(policy: PolicyName): Promise<void> {
    if (!VALUED.includes(policy)) return;
    await Promise.all([this.#table("signatures"), this.#table("calibration")]);
  }

  /** Whether the sound is there. */
  sound(): Promise<boolean> {
    return this.#table("sound");
  }

  #table(name: string): Promise<boolean> {
    const known = this.#tables.get(name);
    if (known) return known;
    const [offset, bytes] = this.#show?.tablePlace(name) ?? [];
    if (offset === undefined || bytes === undefined) return Promise.resolve(false);
    const want: Want = { offset, bytes, early: true };
    const coming = new Promise<boolean>((done) => {
      this.#onBytes.push(() => {
        const there = this.#loader.bytes.get(want);
        if (!there) return false;
        this.#extra.splice(this.#extra.indexOf(want), 1);
        try {
          this.#show?.addTable(name, there.slice());
          done(true);
        } catch (error) {
          this.#show?.failTable(name);
          this.#events.tell("error", problem("broken-pack", false, String(error)));
          done(false);
        }
        this.#events.wake();
        return true;
      });
    });
    this.#extra.push(want);
    this.#tables.set(name, coming);
    this.#order();
    this.#pump();
    return coming;
  }

  /** What waits for bytes, and says whether it has them. */
  #onBytes: (() => boolean)[] = [];

  /** What of a stretch the file has. */
  #inFile(want: Want): Want {
    const end = Math.min(want.offset + want.bytes, this.#loader.length ?? Infinity);
    return { ...want, bytes: Math.max(0, end - want.offset) };
  }

  #order(): void {
    const wants = this.#needs.map((need) => ({
      offset: need.offset,
      bytes: need.bytes,
      early: isEarly(need),
    }));
    const extra = this.#extra.map((want) => this.#inFile(want));
    const [now, later] = [false, true].map((early) => extra.filter((w) => w.early === early));
    // Nothing early goes before what is waited for.
    const waited = wants.filter((want) => !want.early);
    const early = wants.filter((want) => want.early);
    this.#loader.want([...(now ?? []), ...waited, ...(later ?? []), ...early]);
  }

  /** Looks once what the bytes that came are good for. */
  #pump(): void {
    if (this.#pumping) return;
    this.#pumping = true;
    queueMicrotask(() => {
      this.#pumping = false;
      this.#readHead();
      this.#onBytes = this.#onBytes.filter((ready) => !ready());
      if (this.#show) this.#bring(this.#show);
    });
  }

  #readHead(): void {
    if (!this.#headWaits || !this.#reads) return;
    const { bytes, length } = this.#loader;
    try {
      const beginning = bytes.get({ offset: 0, bytes: 64 });
      const head = beginning && bytes.get({ offset: 0, bytes: headBytes(beginning) });
      if (!head) return;
      const told = new DataView(head.buffer, head.byteOffset).getBigUint64(40, true);
      if (length !== null && BigInt(length) !== told) {
        const found = `${length} bytes, expected ${told}`;
        this.#headWaits(problem("broken-pack", true, found));
        return;
      }
      this.#headWaits(head.slice());
    } catch (error) {
      this.#headWaits(problem("broken-pack", true, String(error)));
    }
  }

  #bring(show: Show): void {
    let pages = false;
    const taken = new Set<Need>();
    const wants: PictureWant[] = [];
    const near = new Set<number>();
    for (const need of this.#needs) {
      if (isPage(need)) {
        pages = this.#readPage(show, need) || pages;
        continue;
      }
      if (isWhole(need)) {
        if (this.#takeWhole(show, need)) taken.add(need);
        continue;
      }
      near.add(need.unit);
      if (need.want && this.#readChunk(show, need)) wants.push(need.want);
    }
    if (pages) {
      this.#events.wake();
      return this.ask();
    }
    if (taken.size > 0) {
      this.#needs = this.#needs.filter((need) => !taken.has(need));
      this.#events.wake();
      // More may have been needed than was returned at once.
      if (this.#needs.length === 0) return this.ask();
    }
    for (const unit of this.#chunks.keys()) {
      if (!near.has(unit)) this.#chunks.delete(unit);
    }
    const plays = this.#needs.some(isEarly);
    if (this.#decoders instanceof Decoders) this.#decoders.want(wants, plays, near);
    else this.#decoders?.want(wants);
  }

  /** Takes a page of the index once it is there; whether that is new. */
  #readPage(show: Show, need: { page: number; offset: number; bytes: number }): boolean {
    if (this.#damaged.has(need.offset)) {
      show.failPage(need.page);
      this.#events.wake();
      return false;
    }
    const bytes = this.#loader.bytes.get(need);
    if (!bytes) return false;
    try {
      show.addPage(need.page, bytes);
      this.trips = Math.max(this.trips, 2);
      return true;
    } catch (error) {
      if (this.#retry(need)) return false;
      show.failPage(need.page);
      this.#events.tell("error", problem("broken-pack", false, String(error)));
      this.#events.wake();
      return false;
    }
  }

  /** Hands a unit's chunk over once it is there; whether nothing more is to be done for it. */
  #takeWhole(show: Show, need: WholeNeed): boolean {
    const shows = new Set([show, this.#poster ?? show]);
    const fail = (): boolean => {
      for (const one of shows) one.fail(need.whole, 0);
      return true;
    };
    if (this.#damaged.has(need.offset)) return fail();
    const bytes = this.#loader.bytes.get(need);
    if (!bytes) return false;
    try {
      for (const one of shows) one.deliverWhole(need.whole, bytes);
      return true;
    } catch (error) {
      if (this.#retry(need)) return false;
      this.#events.tell("error", problem("broken-pack", false, String(error)));
      return fail();
    }
  }

  /** Whether a unit's chunk can be decoded. */
  #readChunk(show: Show, need: UnitNeed): boolean {
    if (this.#chunks.has(need.unit)) return true;
    const want = need.want as PictureWant;
    if (this.#damaged.has(need.offset)) {
      show.fail(need.unit, want.frame);
      this.#events.wake();
      return false;
    }
    const bytes = this.#loader.bytes.get(need);
    if (!bytes) return false;
    try {
      const lengths = show.lengths(need.unit, bytes);
      let at = 4 * lengths.length;
      const chunk = Array.from(lengths, (length) => {
        at += length;
        return bytes.subarray(at - length, at);
      });
      this.#chunks.set(need.unit, chunk);
      return true;
    } catch (error) {
      if (!this.#retry(need)) {
        show.fail(need.unit, want.frame);
        this.#events.tell("error", problem("broken-pack", false, String(error)));
        this.#events.wake();
      }
      return false;
    }
  }

  /** Fetches damaged bytes once more; `false` where that was done already. */
  #retry(need: { offset: number; bytes: number }): boolean {
    if (this.#retried.has(need.offset)) {
      this.#damaged.add(need.offset);
      return false;
    }
    this.#retried.add(need.offset);
    this.#loader.again(need);
    this.#order();
    return true;
  }

  #failed(why: Failure, status: number): void {
    const answered = status > 0 ? `the host answered ${status}` : "";
    const detail = why === "not-found" ? `${this.#url}: ${answered}` : answered;
    const kind = why === "short" ? "broken-pack" : why;
    const opening = this.#refuse;
    if (kind === "no-ranges" || (opening && kind !== "network")) {
      const fatal = problem(kind, true, detail);
      this.#loader.close();
      if (opening) opening(fatal);
      else this.#events.ended(fatal);
      return;
    }
    if (this.#lost) return;
    this.#lost = true;
    this.#events.tell("lost", "network");
    this.#events.tell("error", problem("network", false, detail));
  }

  #restored(): void {
    this.#lost = false;
    this.#events.tell("restored", "network");
  }
}
