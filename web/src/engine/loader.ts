// How do bytes come from a host?
//
// Range requests, what matters most first: neighbours in the file travel together,
// requests no longer wanted are cancelled, failed ones repeated, and no byte is asked for twice.
//
// The browser's own cache is passed by. It gave next to nothing back of a pack that was opened
// again (Chromium; other browsers keep no ranges), asked for some ranges twice where several were
// under way, and asks with If-Range, to which a host with another file answers with all of it.

import { Bytes, KEEP_MS, type Stretch } from "./bytes.ts";
import { LEAST_HOLE, MOST_HOLE, MOST_REQUEST, nextRequest, type Want, without } from "./plan.ts";
import { Meter } from "./meter.ts";

/** Requests under way at once: over HTTP/1.1 browsers keep all but six of them back. */
const MOST_REQUESTS = 16;
/** Of these, requests for what nothing waits for yet. */
const MOST_EARLY = 3;
/** Connections to one host over HTTP/1.1. */
const CONNECTIONS = 6;
/** Bytes of a request, by what comes in this time, in seconds; less where nothing waits. */
const REQUEST_S = 0.25;
const EARLY_S = 0.1;
const LEAST_REQUEST = 128 * 1024;
/** A request with less left than this is not given up. */
const NEARLY_THERE = 128 * 1024;
/** Waits between tries, in milliseconds. */
const FIRST_WAIT = 250;
const MOST_WAIT = 8000;

/** Why bytes do not come. */
export type Failure = "not-found" | "no-ranges" | "network" | "short";

/** What a loader reports. */
export interface LoaderEvents {
  /** Bytes came. */
  bytes(): void;
  /** A try failed; `status` is 0 where there was no answer. It goes on trying. */
  failed(why: Failure, status: number): void;
  /** Bytes come again after a failure. */
  restored(): void;
  /** The host has another file now. */
  changed(): void;
}

interface Request extends Stretch {
  readonly abort: AbortController;
  readonly early: boolean;
  /** Bytes that came. */
  done: number;
}

/** What a loader needs of the world; tests give their own. */
export interface World {
  readonly fetch: typeof fetch;
  /** Milliseconds. */
  readonly now: () => number;
  readonly wait: (ms: number, then: () => void) => unknown;
}

export class Loader {
  readonly bytes: Bytes;
  readonly meter: Meter;
  /** Requests made so far. */
  requests = 0;
  /** Length of the file, once the host said it. */
  length: number | null = null;
  readonly #url: string;
  readonly #events: LoaderEvents;
  readonly #world: World;
  #under: Request[] = [];
  #wants: readonly Want[] = [];
  #tag: string | null = null;
  /** Milliseconds to the first byte of an answer, the lowest seen recently. */
  #trip = 0;
  #tries = 0;
  #failing = false;
  #waits = false;
  #closed = false;
  /** When the host last said which file it has, in milliseconds. */
  #told = 0;

  constructor(url: string, most: number, events: LoaderEvents, world: World) {
    this.#url = url;
    this.#events = events;
    this.#world = world;
    this.bytes = new Bytes(most, world.now);
    this.meter = new Meter(world.now);
  }

  /** From now on these are wanted, first what matters most, and nothing else. */
  want(wants: readonly Want[]): void {
    this.#wants = wants;
    for (const request of this.#under) {
      const left = request.bytes - request.done;
      if (left > NEARLY_THERE && !this.#serves(request)) request.abort.abort();
    }
    this.#go();
  }

  /** Tries again at once: the network may be back. */
  hurry(): void {
    this.#tries = 0;
    this.#waits = false;
    this.#go();
  }

  /** Asks again for bytes that were damaged. */
  again(damaged: Stretch): void {
    this.bytes.drop(damaged);
  }

  /** Asks whether the host still has this file, where it has not confirmed it for a minute. */
  check(): void {
    const now = this.#world.now();
    if (this.#closed || this.length === null || now - this.#told < KEEP_MS) return;
    this.#told = now;
    void this.#fetch({ offset: 0, bytes: 1 }).then(
      async (answer) => {
        if (answer.status === 206 && !this.#closed) this.#judge(answer);
        await answer.body?.cancel();
      },
      // What is here can be shown without the host.
      () => {},
    );
  }

  close(): void {
    this.#closed = true;
    for (const request of this.#under) request.abort.abort();
  }

  /** Whether what is left of a request is wanted. */
  #serves(request: Request): boolean {
    const from = request.offset + request.done;
    const end = request.offset + request.bytes;
    return this.#wants.some((want) => want.offset < end && want.offset + want.bytes > from);
  }

  #go(): void {
    if (this.#closed || this.#waits) return;
    while (this.#under.length < MOST_REQUESTS) {
      const early = this.#under.filter((request) => request.early).length;
      const gaps = this.#gaps(early < MOST_EARLY);
      const time = gaps[0]?.early ? EARLY_S : REQUEST_S;
      const usual = Math.max(this.meter.bytesPerSecond * time, LEAST_REQUEST);
      const most = Math.min(usual, MOST_REQUEST);
      const next = nextRequest(gaps, most, this.#hole(), (hole) => this.#isFree(hole));
      if (!next) return;
      void this.#run(next);
    }
  }

  /** What would come while one connection waits for an answer. */
  #hole(): number {
    const waiting = (this.meter.bytesPerSecond * this.#trip) / 1000 / CONNECTIONS;
    return Math.min(Math.max(waiting, LEAST_HOLE), MOST_HOLE);
  }

  /** Whether nothing of a stretch is in memory or under way. */
  #isFree(stretch: Stretch): boolean {
    const isWhole = ([part]: readonly Stretch[]): boolean => part?.bytes === stretch.bytes;
    return isWhole(this.bytes.missing(stretch)) && isWhole(without(stretch, this.#under));
  }

  /** What is missing and not under way, first what matters most. */
  #gaps(withEarly: boolean): Want[] {
    const gaps: Want[] = [];
    const end = this.length ?? Infinity;
    for (const { offset, bytes, early } of this.#wants) {
      if ((early && !withEarly) || offset >= end) continue;
      const want: Want = { offset, bytes: Math.min(bytes, end - offset), early };
      for (const part of this.bytes.missing(want)) {
        for (const gap of without(part, this.#under)) gaps.push({ ...gap, early: want.early });
      }
      // More would not travel together with the first.
      if (gaps.length >= 64) break;
    }
    return gaps;
  }

  #fetch(part: Stretch, signal?: AbortSignal): Promise<Response> {
    const last = part.offset + part.bytes - 1;
    return this.#world.fetch(this.#url, {
      headers: { Range: `bytes=${part.offset}-${last}` },
      cache: "no-store",
      credentials: "same-origin",
      ...(signal ? { signal } : {}),
    });
  }

  async #run(want: Want): Promise<void> {
    const abort = new AbortController();
    const request: Request = { ...want, abort, done: 0 };
    this.#under.push(request);
    this.requests++;
    this.meter.begin();
    const asked = this.#world.now();
    let failure: Failure | null = null;
    let status = 0;
    try {
      const answer = await this.#fetch(want, abort.signal);
      status = answer.status;
      const trip = this.#world.now() - asked;
      this.#trip = this.#trip > 0 ? Math.min(trip, this.#trip * 1.05) : trip;
      failure = this.#judge(answer);
      if (failure) await answer.body?.cancel();
      else await this.#read(answer, request);
    } catch {
      if (!abort.signal.aborted) failure = "network";
    }
    this.meter.end();
    this.#under = this.#under.filter((other) => other !== request);
    if (this.#closed) return;
    if (failure) this.#fail(failure, status);
    else if (!abort.signal.aborted) this.#well();
    this.#go();
  }

  async #read(answer: Response, request: Request): Promise<void> {
    const reader = answer.body?.getReader();
    if (!reader) return;
    for (;;) {
      const { done, value } = await reader.read();
      if (done) break;
      this.bytes.add(request.offset + request.done, value);
      request.done += value.length;
      this.meter.came(value.length);
      this.#events.bytes();
    }
  }

  /** What is wrong with an answer; notices another file. */
  #judge(answer: Response): Failure | null {
    if (answer.status === 200) return "no-ranges";
    if (answer.status === 416) return "short";
    if (answer.status !== 206) return answer.status === 404 ? "not-found" : "network";
    const total = /\/(\d+)$/.exec(answer.headers.get("Content-Range") ?? "")?.[1];
    const length = total === undefined ? null : Number(total);
    const tag = answer.headers.get("ETag") ?? answer.headers.get("Last-Modified");
    const other =
      (this.length !== null && length !== null && length !== this.length) ||
      (this.#tag !== null && tag !== null && tag !== this.#tag);
    this.length ??= length;
    this.#tag ??= tag;
    this.#told = this.#world.now();
    if (!other) return null;
    this.close();
    this.#events.changed();
    return "network";
  }

  #fail(why: Failure, status: number): void {
    this.#failing = true;
    this.#events.failed(why, status);
    if (this.#waits || this.#closed) return;
    this.#waits = true;
    const wait = Math.min(FIRST_WAIT * 2 ** this.#tries++, MOST_WAIT);
    this.#world.wait(wait, () => {
      this.#waits = false;
      this.#go();
    });
  }

  #well(): void {
    this.#tries = 0;
    if (!this.#failing) return;
    this.#failing = false;
    this.#events.restored();
  }
}
