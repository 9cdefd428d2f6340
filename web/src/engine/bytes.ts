// Which bytes of the file are in memory?
//
// Pieces as they came from the network, sorted by place. What was fetched within the last minute
// is kept, so that no byte is fetched twice in that time, as long as twice the bound allows.

/** Milliseconds that bytes are kept for, bound or not. */
export const KEEP_MS = 60_000;

interface Piece {
  readonly offset: number;
  readonly bytes: Uint8Array;
  /** When it came, and when it was last read. */
  readonly came: number;
  used: number;
}

/** A stretch of the file: first byte and length. */
export interface Stretch {
  readonly offset: number;
  readonly bytes: number;
}

export class Bytes {
  #pieces: Piece[] = [];
  #held = 0;
  readonly #most: number;
  readonly #clock: () => number;

  /** Keeps about `most` bytes; `clock` is in milliseconds. */
  constructor(most: number, clock: () => number) {
    this.#most = most;
    this.#clock = clock;
  }

  /** Bytes in memory. */
  get held(): number {
    return this.#held;
  }

  /** Number of the first piece that ends after `offset`. */
  #first(offset: number): number {
    let [low, high] = [0, this.#pieces.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      const piece = this.#pieces[middle] as Piece;
      if (piece.offset + piece.bytes.length <= offset) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  /** Takes bytes from `offset` on; what is there already is left out. */
  add(offset: number, bytes: Uint8Array): void {
    for (const gap of this.missing({ offset, bytes: bytes.length })) {
      const from = gap.offset - offset;
      const whole = gap.bytes === bytes.length;
      const part = whole ? bytes : bytes.slice(from, from + gap.bytes);
      const now = this.#clock();
      const piece = { offset: gap.offset, bytes: part, came: now, used: now };
      this.#pieces.splice(this.#first(gap.offset), 0, piece);
      this.#held += part.length;
    }
    if (this.#held > this.#most) this.#shrink();
  }

  /** The stretches of `wanted` that are not in memory. */
  missing(wanted: Stretch): Stretch[] {
    const end = wanted.offset + wanted.bytes;
    const gaps: Stretch[] = [];
    let at = wanted.offset;
    for (let n = this.#first(at); n < this.#pieces.length && at < end; n++) {
      const piece = this.#pieces[n] as Piece;
      if (piece.offset >= end) break;
      if (piece.offset > at) gaps.push({ offset: at, bytes: piece.offset - at });
      at = Math.max(at, piece.offset + piece.bytes.length);
    }
    if (at < end) gaps.push({ offset: at, bytes: end - at });
    return gaps;
  }

  /** A stretch as one array, or nothing where a byte of it is missing. */
  get(wanted: Stretch): Uint8Array | null {
    const end = wanted.offset + wanted.bytes;
    const now = this.#clock();
    let n = this.#first(wanted.offset);
    const first = this.#pieces[n];
    if (first && first.offset <= wanted.offset && first.offset + first.bytes.length >= end) {
      first.used = now;
      const from = wanted.offset - first.offset;
      return first.bytes.subarray(from, from + wanted.bytes);
    }
    if (this.missing(wanted).length > 0) return null;
    const out = new Uint8Array(wanted.bytes);
    for (; n < this.#pieces.length; n++) {
      const piece = this.#pieces[n] as Piece;
      if (piece.offset >= end) break;
      piece.used = now;
      const from = Math.max(wanted.offset - piece.offset, 0);
      const to = Math.min(end - piece.offset, piece.bytes.length);
      out.set(piece.bytes.subarray(from, to), piece.offset + from - wanted.offset);
    }
    return out;
  }

  /** Forgets what overlaps a stretch: its bytes were damaged on the way. */
  drop(gone: Stretch): void {
    const end = gone.offset + gone.bytes;
    this.#pieces = this.#pieces.filter((piece) => {
      const keeps = piece.offset >= end || piece.offset + piece.bytes.length <= gone.offset;
      if (!keeps) this.#held -= piece.bytes.length;
      return keeps;
    });
  }

  /** All pieces, to be handed to another thread; none is left here. */
  take(): { offset: number; bytes: Uint8Array }[] {
    const pieces = this.#pieces;
    this.#pieces = [];
    this.#held = 0;
    return pieces.map(({ offset, bytes }) => ({ offset, bytes }));
  }

  /** Lets go of what was read longest ago. */
  #shrink(): void {
    const now = this.#clock();
    const oldest = [...this.#pieces].sort((a, b) => a.used - b.used);
    const gone = new Set<Piece>();
    for (const piece of oldest) {
      const over = this.#held > this.#most;
      const young = now - piece.came < KEEP_MS && this.#held <= 2 * this.#most;
      if (!over) break;
      if (young) continue;
      gone.add(piece);
      this.#held -= piece.bytes.length;
    }
    if (gone.size > 0) this.#pieces = this.#pieces.filter((piece) => !gone.has(piece));
  }
}
