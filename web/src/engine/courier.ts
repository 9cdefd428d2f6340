// How do bytes and planes get to what shows them?

import type { EngineProblem, PackFacts, Stats } from "./api.ts";
import { configOf, isStills } from "./codecs.ts";
import type { HostOptions, Tell } from "./calls.ts";
import { type Chunk, Decoders, type PictureWant } from "./decoders.ts";
import { type Failure, Loader } from "./loader.ts";
import type { Arrival, Need, Source } from "./needs.ts";
import type { Want } from "./plan.ts";
import { problem } from "./problem.ts";
import { Stills } from "./stills.ts";
import { Pack, type Show } from "./wasm.ts";

/** Bytes from the beginning that are fetched before anything is known. */
const BEGINNING = 384 * 1024;
/** Bytes of the pack that are kept, where the page says nothing else. */
const USUAL_CACHE = 256 << 20;
/** Decoders: one a core, and never fewer or more than these. */
const DECODERS = [8, 12] as const;

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
  /** What is fetched before anything is known, until it is there. */
  #beginning: Want | null = { offset: 0, bytes: BEGINNING, early: false };
  /** The pack that opens, and what ends the wait for it. */
  #opening: { pack: Pack | null; refuse(why: EngineProblem): void } | null = null;
  /** What waits for bytes, and says whether it has them. */
  #waiting: (() => boolean)[] = [];
  #pumping = false;
  #lost = false;
  /** Chunks that decoders read. */
  readonly #chunks = new Map<number, Chunk>();

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

  /** Opens the pack once `reads` settles, when bytes can be read; rejects with what is wrong. */
  open(reads: Promise<unknown>): Promise<Pack> {
    const pack = new Promise<Pack>((resolve, reject) => {
      const opening = { pack: null as Pack | null, refuse: reject };
      this.#opening = opening;
      this.#order();
      const opened = reads.then(() => {
        const pack = (opening.pack = new Pack());
        return this.until(() => (this.#isOpen(pack) ? pack : undefined));
      });
      opened.then(resolve, reject);
    });
    return pack.finally(() => (this.#opening = null));
  }

  /** Whether all has come that is needed to show it; refuses a file of another length. */
  #isOpen(pack: Pack): boolean {
    const [length, told] = [this.#loader.length, pack.fileBytes()];
    if (length !== null && told !== undefined && length !== told) {
      this.#refuse(problem("broken-pack", true, `${length} bytes, expected ${told}`));
    }
    return pack.isOpen();
  }

  /** What `look` finds, now or after bytes came. */
  until<T>(look: () => T | undefined): Promise<T> {
    return new Promise((resolve) => {
      const isThere = (): boolean => {
        const found = look();
        if (found !== undefined) resolve(found);
        return found !== undefined;
      };
      if (isThere()) return;
      this.#waiting.push(isThere);
      this.ask();
    });
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
  }

  /** What says which bytes are needed. */
  get #source(): Source | null {
    return this.#opening?.pack ?? this.#show;
  }

  /** Asks again what is needed. */
  ask(): void {
    if (!this.#source) return;
    this.#needs = JSON.parse(this.#source.needs()) as Need[];
    const missing = (need: Need): boolean => this.#loader.bytes.missing(need).length > 0;
    const isLater = (need: Need): boolean => need.offset + need.bytes > BEGINNING && missing(need);
    if (this.#opening && this.#needs.some(isLater)) this.trips = 2;
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
    this.#show = this.#poster = null;
    this.#loader.close();
    this.#decoders?.close();
  }

  /** Settles once the tables that the policy chooses by are there, or cannot be had. */
  async tables(): Promise<void> {
    await this.until(() => (this.#show?.awaitsTables() ? undefined : true));
  }

  #order(): void {
    this.#loader.want(this.#beginning ? [this.#beginning, ...this.#needs] : this.#needs);
  }

  /** Looks once what the bytes that came are good for. */
  #pump(): void {
    if (this.#pumping) return;
    this.#pumping = true;
    queueMicrotask(() => {
      this.#pumping = false;
      const bytes = Math.min(BEGINNING, this.#loader.length ?? BEGINNING);
      const missing = this.#loader.bytes.missing({ offset: 0, bytes });
      if (missing.length === 0) this.#beginning = null;
      if (this.#source) this.#bring(this.#source);
      this.#waiting = this.#waiting.filter((isThere) => !isThere());
    });
  }

  #bring(source: Source): void {
    const done = new Set<Need>();
    const wants: PictureWant[] = [];
    const near = new Set<number>();
    let more = false;
    for (const need of this.#needs) {
      const unit = need.picture?.unit ?? need.ahead;
      if (unit !== undefined) near.add(unit);
      if (need.ahead !== undefined) continue;
      const isRead = unit !== undefined && this.#chunks.has(unit);
      const arrival = isRead ? null : this.#arrive(source, need);
      more ||= arrival === "more";
      if (arrival === "taken") done.add(need);
      if (need.picture && this.#chunks.has(need.picture.unit)) wants.push(need.picture);
    }
    if (more && !this.#opening) this.trips = 2;
    if (more || done.size > 0) this.#events.wake();
    this.#needs = this.#needs.filter((need) => !done.has(need));
    // More may have been needed than was returned at once.
    if (more || (done.size > 0 && this.#needs.length === 0)) return this.ask();
    for (const unit of this.#chunks.keys()) {
      if (!near.has(unit)) this.#chunks.delete(unit);
    }
    const plays = this.#needs.some((need) => need.ahead !== undefined);
    if (this.#decoders instanceof Decoders) this.#decoders.want(wants, plays, near);
    else this.#decoders?.want(wants);
  }

  /** Hands a stretch over, once it is there, and says what came of it. */
  #arrive(source: Source, need: Need): Arrival | null {
    const bytes = this.#loader.bytes.get(need);
    if (!bytes) return null;
    try {
      const arrival = JSON.parse(source.arrived(need.offset, bytes)) as Arrival;
      if (arrival === "again") {
        this.#loader.again(need);
        this.#order();
      } else if (typeof arrival !== "string") {
        const edges = arrival.decode;
        const chunk = edges.slice(1).map((end, at) => bytes.subarray(edges[at], end));
        if (need.picture) this.#chunks.set(need.picture.unit, chunk);
      } else if (this.#poster && this.#poster !== source) {
        this.#poster.arrived(need.offset, bytes);
      }
      return arrival;
    } catch (error) {
      const why = problem("broken-pack", this.#opening !== null, String(error));
      if (this.#opening) this.#refuse(why);
      else this.#events.tell("error", why);
      return "taken";
    }
  }

  /** The pack cannot be opened. */
  #refuse(why: EngineProblem): void {
    this.#opening?.refuse(why);
    this.#opening = null;
  }

  #failed(why: Failure, status: number): void {
    const answered = status > 0 ? `the host answered ${status}` : "";
    const detail = why === "not-found" ? `${this.#url}: ${answered}` : answered;
    const kind = why === "short" ? "broken-pack" : why;
    const opening = this.#opening;
    if (kind === "no-ranges" || (opening && kind !== "network")) {
      const fatal = problem(kind, true, detail);
      this.#loader.close();
      if (opening) this.#refuse(fatal);
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
