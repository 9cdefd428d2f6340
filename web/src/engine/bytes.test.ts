import { expect, test } from "vitest";
import { Bytes, KEEP_MS } from "./bytes.ts";

/** Bytes that say where in the file they are. */
function part(offset: number, bytes: number): Uint8Array {
  return Uint8Array.from({ length: bytes }, (_, n) => (offset + n) % 251);
}

test("what was added is read back, whatever pieces it came in", () => {
  const bytes = new Bytes(1e6, () => 0);
  for (const [offset, length] of [[300, 50], [0, 100], [90, 60], [140, 160]] as const) {
    bytes.add(offset, part(offset, length));
  }
  expect(bytes.held).toBe(350);
  expect(bytes.get({ offset: 60, bytes: 280 })).toEqual(part(60, 280));
  expect(bytes.get({ offset: 300, bytes: 51 })).toBeNull();
  expect(bytes.missing({ offset: 340, bytes: 30 })).toEqual([{ offset: 350, bytes: 20 }]);
});

test("gaps lie between what is there", () => {
  const bytes = new Bytes(1e6, () => 0);
  bytes.add(10, part(10, 10));
  bytes.add(40, part(40, 10));
  expect(bytes.missing({ offset: 0, bytes: 60 })).toEqual([
    { offset: 0, bytes: 10 },
    { offset: 20, bytes: 20 },
    { offset: 50, bytes: 10 },
  ]);
});

test("memory is bounded, what is young stays, and never more than twice the bound", () => {
  let now = 0;
  const bytes = new Bytes(1000, () => now);
  for (let n = 0; n < 15; n++) bytes.add(n * 100, part(n * 100, 100));
  expect(bytes.held).toBe(1500);
  now = KEEP_MS;
  bytes.get({ offset: 0, bytes: 100 });
  now++;
  bytes.add(5000, part(5000, 100));
  expect(bytes.held).toBeLessThanOrEqual(1000);
  expect(bytes.get({ offset: 0, bytes: 100 })).toEqual(part(0, 100));
  for (let n = 0; n < 50; n++) bytes.add(10_000 + n * 100, part(n, 100));
  expect(bytes.held).toBeLessThanOrEqual(2000);
});

test("damaged bytes are forgotten", () => {
  const bytes = new Bytes(1e6, () => 0);
  bytes.add(0, part(0, 10));
  bytes.add(10, part(10, 10));
  bytes.drop({ offset: 5, bytes: 3 });
  expect(bytes.held).toBe(10);
  expect(bytes.get({ offset: 10, bytes: 10 })).toEqual(part(10, 10));
});

test("another thread gets all of it", () => {
  const [bytes, other] = [new Bytes(1e6, () => 0), new Bytes(1e6, () => 0)];
  bytes.add(0, part(0, 10));
  bytes.add(50, part(50, 10));
  for (const piece of bytes.take()) other.add(piece.offset, piece.bytes);
  expect([bytes.held, other.held]).toEqual([0, 20]);
  expect(other.get({ offset: 50, bytes: 10 })).toEqual(part(50, 10));
});
