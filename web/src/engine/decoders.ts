// Which decoder turns which chunk into planes?
//
// A chunk decodes by itself, so a decoder goes from tile to tile: it is re-keyed by the first
// access unit of whatever comes next. While the content plays, what follows in a chunk is decoded
// along, and waits until its frame is due.

import { Buffers, planesOf } from "./planes.ts";

/** A frame of a unit. */
export interface PictureWant {
  readonly unit: number;
  readonly frame: number;
  /** The unit's first frame, and how many it has. */
  readonly first: number;
  readonly frames: number;
  readonly width: number;
  readonly height: number;
}

/** The access units of a chunk. */
export type Chunk = readonly Uint8Array[];

/** What a pool reports. */
export interface DecoderEvents {
  /** A frame of a unit was decoded for which `decoded` were; `planes` are the receiver's. */
  picture(want: PictureWant, decoded: number, planes: Uint8Array): void;
  /** A frame of a unit cannot be decoded. */
  failed(want: PictureWant, why: string): void;
  /** The chunk of a unit, where its bytes are there. */
  chunk(unit: number): Chunk | null;
}

/** Frames beyond the wanted one that are decoded along while the content plays. */
const ALONG = 7;
/** Most bytes of planes that wait for their time. */
const MOST_READY = 128 << 20;

/** Most failures that are remembered. */
const MOST_FAILED = 4096;

interface Ready {
  readonly planes: Uint8Array;
  readonly decoded: number;
}

interface Worker {
  decoder: VideoDecoder | null;
  /** What it is in, and the next frame of that to be fed. */
  unit: number;
  next: number;
  /** The job under way. */
  job: { want: PictureWant; until: number; fed: number } | null;
}

const key = (unit: number, frame: number) => unit * 2 ** 24 + frame;

export class Decoders {
  readonly buffers = new Buffers();
  /** Milliseconds from a chunk to its planes, lately. */
  ms = 0;
  readonly #config: VideoDecoderConfig;
  readonly #events: DecoderEvents;
  readonly #workers: Worker[];
  #wants: readonly PictureWant[] = [];
  #plays = false;
  /** Planes that wait for their time, oldest first. */
  readonly #ready = new Map<number, Ready>();
  #readyBytes = 0;
  /** Frames of units that could not be decoded once. */
  readonly #failed = new Set<number>();
  #closed = false;

  constructor(config: VideoDecoderConfig, count: number, events: DecoderEvents) {
    this.#config = config;
    this.#events = events;
    this.#workers = Array.from({ length: count }, () => ({
      decoder: null,
      unit: -1,
      next: 0,
      job: null,
    }));
  }

  /** From now on these are wanted, in this order, and nothing else. */
  want(wants: readonly PictureWant[], plays: boolean, near: ReadonlySet<number>): void {
    this.#wants = wants;
    this.#plays = plays;
    for (const [name, ready] of this.#ready) {
      if (!near.has(Math.floor(name / 2 ** 24))) this.#forget(name, ready);
    }
    this.go();
  }

  /** Hands out what is ready, and gives idle decoders work. */
  go(): void {
    if (this.#closed) return;
    const left: PictureWant[] = [];
    for (const want of this.#wants) {
      const name = key(want.unit, want.frame);
      const ready = this.#ready.get(name);
      if (ready) {
        this.#forget(name, ready, true);
        this.#events.picture(want, ready.decoded, ready.planes);
      } else {
        left.push(want);
      }
    }
    this.#wants = left;
    for (const want of left) {
      if (this.#isUnderWay(want)) continue;
      const worker = this.#workerFor(want);
      if (!worker) return;
      this.#begin(worker, want);
    }
  }

  close(): void {
    this.#closed = true;
    for (const { decoder } of this.#workers) {
      if (decoder && decoder.state !== "closed") decoder.close();
    }
    this.#ready.clear();
  }

  #forget(name: number, ready: Ready, handed = false): void {
    this.#ready.delete(name);
    this.#readyBytes -= ready.planes.length;
    if (!handed) this.buffers.give(ready.planes);
  }

  #isUnderWay(want: PictureWant): boolean {
    return this.#workers.some(({ job }) => {
      return job?.want.unit === want.unit && job.until >= want.frame;
    });
  }

  /** An idle decoder: the one that is in this unit already, else one whose unit is over. */
  #workerFor(want: PictureWant): Worker | null {
    const idle = this.#workers.filter(({ job }) => !job);
    const inUnit = idle.find(({ unit, next }) => unit === want.unit && next <= want.frame);
    if (inUnit) return inUnit;
    const near = new Set(this.#wants.map(({ unit }) => unit));
    return idle.find(({ unit }) => !near.has(unit)) ?? idle[0] ?? null;
  }

  #begin(worker: Worker, want: PictureWant): void {
    const chunk = this.#events.chunk(want.unit);
    if (!chunk) return;
    const goesOn = worker.unit === want.unit && worker.next <= want.frame;
    const from = goesOn ? worker.next : want.first;
    const last = want.first + want.frames - 1;
    const room = this.#readyBytes < MOST_READY;
    const until = this.#plays && room ? Math.min(want.frame + ALONG, last) : want.frame;
    worker.unit = want.unit;
    worker.next = until + 1;
    worker.job = { want, until, fed: until + 1 - from };
    const began = performance.now();
    void this.#decode(worker, chunk, from, until, want).then(
      () => {
        const passed = (performance.now() - began) / (until + 1 - from);
        this.ms += (passed - this.ms) * (this.ms === 0 ? 1 : 0.1);
        this.#end(worker);
      },
      (error: unknown) => {
        worker.unit = -1;
        if (worker.decoder?.state !== "closed") worker.decoder?.close();
        worker.decoder = null;
        if (!this.#closed) this.#fail(want, String(error));
        this.#end(worker);
      },
    );
  }

  /** A browser may take a decoder away: a fresh one tries once more. */
  #fail(want: PictureWant, why: string): void {
    const name = key(want.unit, want.frame);
    if (this.#failed.size > MOST_FAILED) this.#failed.clear();
    if (!this.#failed.has(name)) {
      this.#failed.add(name);
      return;
    }
    this.#wants = this.#wants.filter((other) => key(other.unit, other.frame) !== name);
    this.#events.failed(want, why);
  }

  #end(worker: Worker): void {
    worker.job = null;
    if (this.#closed) return;
    this.go();
  }

  /** Feeds frames `from` to `until`, and keeps the planes of those that are not before the want. */
  #decode(
    worker: Worker,
    chunk: Chunk,
    from: number,
    until: number,
    want: PictureWant,
  ): Promise<void> {
    return new Promise((resolve, reject) => {
      const copies: Promise<void>[] = [];
      const output = (frame: VideoFrame) => {
        const number = frame.timestamp;
        if (number < want.frame) frame.close();
        else copies.push(this.#keep(frame, number, number + 1 - from, want));
        if (number === until) void Promise.all(copies).then(() => resolve(), reject);
      };
      if (worker.decoder?.state === "closed") worker.decoder = null;
      worker.decoder ??= this.#open();
      const told = this.#told.get(worker.decoder);
      if (told) Object.assign(told, { output, error: reject });
      for (let number = from; number <= until; number++) {
        const data = chunk[number - want.first];
        if (!data) return reject(new Error("a chunk without this frame"));
        const type = number === want.first ? "key" : "delta";
        worker.decoder.decode(new EncodedVideoChunk({ type, timestamp: number, data }));
      }
      // Some decoders hold the last pictures back until more comes.
      if (until === want.first + want.frames - 1) {
        void worker.decoder.flush().then(
          () => {},
          () => {},
        );
      }
    });
  }

  readonly #told = new Map<
    VideoDecoder,
    { output(frame: VideoFrame): void; error(why: unknown): void }
  >();

  #open(): VideoDecoder {
    const told = {
      output: (frame: VideoFrame) => frame.close(),
      error: (_why: unknown) => {},
    };
    const decoder = new VideoDecoder({
      output: (frame) => told.output(frame),
      error: (why) => {
        this.#told.delete(decoder);
        told.error(why);
      },
    });
    decoder.configure(this.#config);
    this.#told.set(decoder, told);
    return decoder;
  }

  async #keep(
    frame: VideoFrame,
    number: number,
    decoded: number,
    want: PictureWant,
  ): Promise<void> {
    try {
      const planes = await planesOf(frame, want.width, want.height, this.buffers);
      if (number === want.frame) {
        this.#wants = this.#wants.filter((other) => {
          return other.unit !== want.unit || other.frame !== number;
        });
        if (!this.#closed) this.#events.picture(want, decoded, planes);
        return;
      }
      this.#ready.set(key(want.unit, number), { planes, decoded: 1 });
      this.#readyBytes += planes.length;
    } finally {
      frame.close();
    }
  }
}
