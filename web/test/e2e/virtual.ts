// How long would it take over a link, where nothing else takes any time?
//
// A page's clock, screen and link in virtual time: the clock stands while the page works or
// decodes, and moves on to whatever comes first, bytes or a picture of the screen. So what is
// measured is which requests wait for which answers, on a machine however busy.

import type { Page } from "playwright-core";

/** A link, and the screen at its end. */
export interface VirtualLink {
  readonly bitsPerSecond: number;
  /** Seconds from the page to the host and back. */
  readonly roundTrip: number;
  readonly framesPerSecond: number;
}

/** What tests read in the page. */
export interface Virtual {
  /** Seconds. */
  readonly now: () => number;
  /** Bytes of packs that came so far. */
  readonly bytes: () => number;
  /** Waits for so many seconds. */
  readonly pass: (seconds: number) => Promise<void>;
}

declare global {
  interface Window {
    virtual: Virtual;
  }
}

/** From the next address on the page lives in virtual time; engines must work on its thread. */
export async function makeVirtual(page: Page, link: VirtualLink): Promise<void> {
  await page.addInitScript(install, link);
}

/** Runs in the page. */
function install(link: VirtualLink): void {
  const real = { fetch: window.fetch.bind(window), timeout: window.setTimeout.bind(window) };
  const piece = 16 * 1024;
  let now = 0;
  let free = 0;
  let sent = 0;
  // What works in real time and holds the clock.
  let working = 0;
  let turned = 0;
  const coming: { at: number; then: () => void }[] = [];
  let pictures: { id: number; heard: FrameRequestCallback }[] = [];
  let ids = 0;
  const hold = <T>(work: Promise<T>): Promise<T> => {
    working += 1;
    const over = (): void => {
      working -= 1;
      turned = 0;
    };
    work.then(over, over);
    return work;
  };
  const at = (time: number, then: () => void): void => {
    coming.push({ at: time, then });
    coming.sort((a, b) => a.at - b.at);
  };

  performance.now = () => 1000 * now;
  window.requestAnimationFrame = (heard) => {
    pictures.push({ id: ++ids, heard });
    turned = 0;
    return ids;
  };
  window.cancelAnimationFrame = (gone) => {
    pictures = pictures.filter(({ id }) => id !== gone);
  };

  window.fetch = async (input, how) => {
    if (!String(input).endsWith(".foveal")) return hold(real.fetch(input, how));
    const asked = now;
    turned = 0;
    const answer = await hold(real.fetch(input, { ...how, signal: null }));
    const bytes = new Uint8Array(await hold(answer.arrayBuffer()));
    const { status, headers } = answer;
    const signal = how?.signal ?? null;
    return new Promise((resolve, reject) => {
      const isOver = (): boolean => signal?.aborted === true;
      signal?.addEventListener("abort", () => reject(new DOMException("given up", "AbortError")));
      at(asked + link.roundTrip, () => {
        if (isOver()) return;
        let stream: ReadableStreamDefaultController<Uint8Array> | null = null;
        const body = new ReadableStream<Uint8Array>({ start: (it) => void (stream = it) });
        signal?.addEventListener("abort", () => stream?.error(signal.reason));
        resolve(new Response(body, { status, headers }));
        const send = (from: number): void => {
          const part = bytes.slice(from, from + piece);
          free = Math.max(free, now) + (8 * part.length) / link.bitsPerSecond;
          at(free, () => {
            sent += part.length;
            if (isOver()) return;
            stream?.enqueue(part);
            if (from + piece < bytes.length) send(from + piece);
            else stream?.close();
          });
        };
        send(0);
      });
    });
  };

  const made = WebAssembly.instantiateStreaming;
  WebAssembly.instantiateStreaming = (...values) => hold(made(...values));
  const adapter = GPU.prototype.requestAdapter;
  GPU.prototype.requestAdapter = function held(...values) {
    return hold(adapter.apply(this, values));
  };
  const device = GPUAdapter.prototype.requestDevice;
  GPUAdapter.prototype.requestDevice = function held(...values) {
    return hold(device.apply(this, values));
  };
  const done = GPUQueue.prototype.onSubmittedWorkDone;
  GPUQueue.prototype.onSubmittedWorkDone = function held() {
    return hold(done.call(this));
  };
  const copy = VideoFrame.prototype.copyTo;
  VideoFrame.prototype.copyTo = function held(...values) {
    return hold(copy.apply(this, values));
  };
  const Real = VideoDecoder;
  window.VideoDecoder = class extends Real {
    constructor(init: VideoDecoderInit) {
      let under = 0;
      const over = (count: number): void => {
        under -= count;
        working -= count;
        turned = 0;
      };
      super({
        output: (frame) => {
          over(1);
          init.output(frame);
        },
        error: (why) => {
          over(under);
          init.error(why);
        },
      });
      const decode = this.decode.bind(this);
      this.decode = (chunk) => {
        decode(chunk);
        under += 1;
        working += 1;
      };
      const close = this.close.bind(this);
      this.close = () => {
        over(under);
        close();
      };
    }
  };

  // Turns of the event loop without work after which the page waits for the next moment.
  const still = 12;
  const turn = (): void => {
    turned = working > 0 ? 0 : turned + 1;
    const screen = (Math.floor(now * link.framesPerSecond + 1e-6) + 1) / link.framesPerSecond;
    const next = coming[0]?.at ?? Infinity;
    if (turned > still && next <= screen) {
      now = Math.max(now, next);
      turned = 0;
      coming.shift()?.then();
    } else if (turned > still && pictures.length > 0) {
      now = screen;
      turned = 0;
      for (const { heard } of pictures.splice(0)) heard(1000 * now);
    } else if (turned > still && next < Infinity) {
      now = next;
    }
    ring.port2.postMessage(null);
  };
  const ring = new MessageChannel();
  // A message comes between all other work; a timer now and then lets what is slower come, too.
  let count = 0;
  ring.port1.onmessage = () => {
    count += 1;
    if (working > 0 || count % 4 === 0) real.timeout(turn, 0);
    else turn();
  };
  ring.port2.postMessage(null);
  const pass = (seconds: number) => new Promise<void>((done) => at(now + seconds, done));
  Object.assign(window, { virtual: { now: () => now, bytes: () => sent, pass } });
}
