// How does an engine run in a worker?

import type { Call, Said } from "./calls.ts";
import { Host } from "./host.ts";
import { problemOf } from "./problem.ts";

const post = (said: Said, transfer: Transferable[] = []) => {
  (self as unknown as { postMessage(said: Said, transfer: Transferable[]): void }).postMessage(
    said,
    transfer,
  );
};

const host = new Host((event, value) => post({ event, value }));

/** Buffers that go over without being copied. */
function buffersOf(value: unknown): Transferable[] {
  const parts = Array.isArray(value) ? value : [value];
  const bytes = parts.flatMap((part: unknown) => {
    const { bytes, data } = (part ?? {}) as { bytes?: unknown; data?: unknown };
    return [bytes, data].filter((held) => held instanceof Uint8Array);
  });
  return [...new Set(bytes.map((held) => held.buffer as ArrayBuffer))];
}

self.onmessage = async ({ data }: MessageEvent<Call>) => {
  const call = host[data.name] as (...values: readonly unknown[]) => unknown;
  try {
    const value = await call.apply(host, data.values as unknown[]);
    if (data.id > 0) post({ id: data.id, value }, buffersOf(value));
  } catch (error) {
    if (data.id > 0) post({ id: data.id, error: problemOf(error) });
    else post({ event: "error", value: problemOf(error) });
  }
};
