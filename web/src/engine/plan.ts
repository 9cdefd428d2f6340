// Which request is made next?
//
// Stretches are wanted in an order; neighbours in the file travel together.

import type { Stretch } from "./bytes.ts";

/**
 * Bytes between two wanted stretches that are fetched along rather than asked for apart, at least
 * and at most: as many as come while another request would be on its way.
 */
export const LEAST_HOLE = 4096;
export const MOST_HOLE = 32 * 1024;

/** Bytes of one request at most. */
export const MOST_REQUEST = 2 * 1024 * 1024;

/** A stretch that something waits for. */
export interface Want extends Stretch {
  /** It may be needed soon, but nothing waits for it yet. */
  readonly early: boolean;
}

/** What is left of `wanted` after what is `taken` already. */
export function without(wanted: Stretch, taken: readonly Stretch[]): Stretch[] {
  let left: Stretch[] = [wanted];
  for (const { offset, bytes } of taken) {
    left = left.flatMap((part) => {
      const end = part.offset + part.bytes;
      if (offset + bytes <= part.offset || offset >= end) return [part];
      const before = { offset: part.offset, bytes: Math.max(0, offset - part.offset) };
      const after = { offset: offset + bytes, bytes: Math.max(0, end - offset - bytes) };
      return [before, after].filter((piece) => piece.bytes > 0);
    });
  }
  return left;
}

/**
 * The next request: the first gap in order of importance, with the gaps that follow it closely in
 * the file while that makes no more than `most` bytes. `gaps` are what is missing and not under
 * way, by importance; up to `hole` bytes between them are fetched along where `isFree` says that
 * these are not in memory and not under way either.
 */
export function nextRequest(
  gaps: readonly Want[],
  most: number,
  hole: number,
  isFree: (hole: Stretch) => boolean,
): Want | null {
  const first = gaps[0];
  if (!first) return null;
  let begin = first.offset;
  let end = begin + Math.min(first.bytes, MOST_REQUEST);
  const early = first.early;
  const bridges = (from: number, to: number): boolean =>
    to <= from || (to - from <= hole && isFree({ offset: from, bytes: to - from }));
  const inFile = gaps.slice(1).sort((a, b) => a.offset - b.offset);
  for (const gap of inFile) {
    const reaches = gap.offset + gap.bytes;
    const grows = gap.offset >= begin && reaches > end && reaches - begin <= most;
    if (grows && bridges(end, gap.offset)) end = reaches;
  }
  for (const gap of inFile.reverse()) {
    const grows = gap.offset < begin && end - gap.offset <= most;
    if (grows && bridges(gap.offset + gap.bytes, begin)) begin = gap.offset;
  }
  return { offset: begin, bytes: end - begin, early };
}
