// How many bytes does the host bring in a second?

/** How much of the past counts, in milliseconds. */
const WINDOW_MS = 2000;

/** Measures while anything is on its way, and only then. */
export class Meter {
  /** Bytes since the beginning. */
  total = 0;
  readonly #clock: () => number;
  #under = 0;
  #since = 0;
  /** Spans of time with something under way, and the bytes that came in them. */
  #spans: { end: number; ms: number; bytes: number }[] = [];

  constructor(clock: () => number) {
    this.#clock = clock;
  }

  begin(): void {
    if (this.#under++ === 0) this.#since = this.#clock();
  }

  end(): void {
    this.#note(0);
    this.#under--;
  }

  came(bytes: number): void {
    this.total += bytes;
    this.#note(bytes);
  }

  /** Recent; 0 before anything came. */
  get bytesPerSecond(): number {
    let [ms, bytes] = [0, 0];
    for (const span of this.#spans) {
      ms += span.ms;
      bytes += span.bytes;
    }
    return ms > 0 ? (bytes * 1000) / ms : 0;
  }

  #note(bytes: number): void {
    const now = this.#clock();
    const last = this.#spans[this.#spans.length - 1];
    const ms = now - this.#since;
    this.#since = now;
    // Spans of a few milliseconds are one.
    if (last && now - last.end < 20) {
      last.bytes += bytes;
      last.ms += ms;
    } else {
      this.#spans.push({ end: now, ms, bytes });
    }
    while (this.#spans.length > 1 && now - (this.#spans[0]?.end ?? now) > WINDOW_MS) {
      this.#spans.shift();
    }
  }
}
