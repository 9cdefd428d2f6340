// Which host do the tests fetch from, and what did it send when?
//
// A static host with byte ranges, a log of what was asked, and faults that can be switched on.

import { type IncomingMessage, type Server, type ServerResponse, createServer } from "node:http";
import { open, stat } from "node:fs/promises";
import type { AddressInfo, Socket } from "node:net";
import { extname, join, normalize } from "node:path";

/** One answered request. */
export interface Asked {
  readonly method: string;
  readonly path: string;
  readonly status: number;
  /** The range as it was asked for. */
  readonly range: string;
  /** Bytes of the file, from first to last; empty (last < first) where none were sent. */
  readonly first: number;
  readonly last: number;
  /** Milliseconds since the host began. */
  readonly at: number;
  /** Whether all of it was sent. */
  whole: boolean;
}

/** What can go wrong; change it while the host runs. */
export interface Faults {
  /** Answers every request with the whole file, as hosts without ranges do. */
  noRanges: boolean;
  /** Files seem to end after so many bytes. */
  truncatedAt: number | null;
  /** Places in a pack whose byte is flipped. */
  flipped: ReadonlySet<number>;
  /** Byte ranges of packs that begin here or later are not found. */
  missingFrom: number | null;
  /** Every connection breaks off. */
  offline: boolean;
  /** Added to the ETag, as if the file had changed. */
  version: string;
}

/** How a host is set up. */
export interface HostOptions {
  /** Which other origins may read; none if left out. */
  readonly allowOrigin?: string;
  /** Milliseconds before each answer: requests of one moment overlap as on a real link. */
  readonly delayMs?: number;
}

const TYPES: Readonly<Record<string, string>> = {
  ".html": "text/html; charset=utf-8",
  ".js": "text/javascript; charset=utf-8",
  ".css": "text/css; charset=utf-8",
  ".json": "application/json",
  ".wasm": "application/wasm",
  ".jpg": "image/jpeg",
};

/** A host of one folder on a free port of this machine. */
export class RangeHost {
  readonly log: Asked[] = [];
  readonly faults: Faults = {
    noRanges: false,
    truncatedAt: null,
    flipped: new Set(),
    missingFrom: null,
    offline: false,
    version: "",
  };
  private readonly server: Server;
  private readonly sockets = new Set<Socket>();
  private readonly began = performance.now();

  private constructor(
    private readonly folder: string,
    private readonly options: HostOptions,
  ) {
    this.server = createServer((request, response) => void this.answer(request, response));
    this.server.on("connection", (socket: Socket) => {
      this.sockets.add(socket);
      socket.on("close", () => this.sockets.delete(socket));
      if (this.faults.offline) socket.destroy();
    });
  }

  static async of(folder: string, options: HostOptions = {}): Promise<RangeHost> {
    const host = new RangeHost(folder, options);
    await new Promise<void>((ready) => host.server.listen(0, "127.0.0.1", ready));
    return host;
  }

  /** Its address, with a slash at the end. */
  get url(): string {
    return `http://127.0.0.1:${(this.server.address() as AddressInfo).port}/`;
  }

  async close(): Promise<void> {
    for (const socket of this.sockets) socket.destroy();
    await new Promise<void>((closed) => this.server.close(() => closed()));
  }

  /** Breaks all connections, and every new one until it is back. */
  goOffline(offline: boolean): void {
    this.faults.offline = offline;
    if (offline) for (const socket of this.sockets) socket.destroy();
  }

  /** Requests for packs. */
  get ofPacks(): readonly Asked[] {
    return this.log.filter((one) => one.path.endsWith(".foveal"));
  }

  /** Bytes of packs that were sent twice within a minute; empty if all is well. */
  sentTwice(): readonly string[] {
    const twice: string[] = [];
    const sent = this.ofPacks.filter((one) => one.whole && one.last >= one.first);
    sent.forEach((one, index) => {
      for (const other of sent.slice(0, index)) {
        const overlaps = one.first <= other.last && other.first <= one.last;
        const soon = one.at - other.at < 60_000;
        if (one.path === other.path && overlaps && soon) {
          twice.push(`${one.path} ${other.first}-${other.last}, then ${one.first}-${one.last}`);
        }
      }
    });
    return twice;
  }

  /** The page gave up a request, which may have been sent whole by then. */
  gaveUp(range: string | undefined): void {
    const asked = this.log.findLast((one) => one.range === range);
    if (asked) asked.whole = false;
  }

  private async answer(request: IncomingMessage, response: ServerResponse): Promise<void> {
    if (this.faults.offline) {
      request.socket.destroy();
      return;
    }
    const path = decodeURIComponent(new URL(request.url ?? "/", this.url).pathname);
    const before = {
      method: request.method ?? "",
      path,
      range: request.headers.range ?? "",
      at: performance.now() - this.began,
    };
    if (this.options.allowOrigin !== undefined) {
      response.setHeader("access-control-allow-origin", this.options.allowOrigin);
      response.setHeader("access-control-allow-headers", "range, cache-control, if-range");
      response.setHeader(
        "access-control-expose-headers",
        "accept-ranges, content-length, content-range, etag",
      );
    }
    await new Promise((ready) => setTimeout(ready, this.options.delayMs ?? 0));
    const { status, first, bytes } = await this.content(request, response, path);
    const asked: Asked = {
      ...before,
      status,
      first,
      last: first + bytes.length - 1,
      whole: false,
    };
    this.log.push(asked);
    response.on("finish", () => {
      asked.whole = true;
    });
    response.statusCode = status;
    response.end(request.method === "HEAD" ? undefined : bytes);
  }

  private async content(
    request: IncomingMessage,
    response: ServerResponse,
    path: string,
  ): Promise<{ status: number; first: number; bytes: Buffer }> {
    const nothing = (status: number) => ({ status, first: 0, bytes: Buffer.alloc(0) });
    if (request.method === "OPTIONS") return nothing(204);
    const inside = normalize(path.endsWith("/") ? `${path}index.html` : path);
    const file = join(this.folder, inside);
    const there = await stat(file).catch(() => null);
    if (inside.startsWith("..") || there === null || !there.isFile()) return nothing(404);
    const isPack = inside.endsWith(".foveal");
    const length = Math.min(there.size, (isPack && this.faults.truncatedAt) || Infinity);
    const part = async (first: number, end: number): Promise<Buffer> => {
      const bytes = await read(file, first, end - first);
      return isPack ? this.spoil(bytes, first) : bytes;
    };
    const version = isPack ? this.faults.version : "";
    const tag = `"${length.toString(16)}-${there.mtimeMs}${version}"`;
    response.setHeader("etag", tag);
    response.setHeader("content-type", TYPES[extname(inside)] ?? "application/octet-stream");
    const matches = request.headers["if-match"];
    if (matches !== undefined && matches !== tag) return nothing(412);
    const whole = async () => ({ status: 200, first: 0, bytes: await part(0, length) });
    if (isPack && this.faults.noRanges) return whole();
    response.setHeader("accept-ranges", "bytes");
    const range = /^bytes=(\d+)-(\d*)$/.exec(request.headers.range ?? "");
    const isSame = (request.headers["if-range"] ?? tag) === tag;
    if (range === null || !isSame) return whole();
    const [first, asked] = [Number(range[1]), range[2] === "" ? Infinity : Number(range[2])];
    if (first >= length) {
      response.setHeader("content-range", `bytes */${length}`);
      return nothing(416);
    }
    if (isPack && this.faults.missingFrom !== null && first >= this.faults.missingFrom) {
      return nothing(404);
    }
    const last = Math.min(asked, length - 1);
    response.setHeader("content-range", `bytes ${first}-${last}/${length}`);
    return { status: 206, first, bytes: await part(first, last + 1) };
  }

  /** Flips what is to be flipped in bytes that begin at `first`. */
  private spoil(bytes: Buffer, first: number): Buffer {
    for (const at of this.faults.flipped) {
      const place = at - first;
      if (place >= 0 && place < bytes.length) bytes[place] = (bytes[place] ?? 0) ^ 0xff;
    }
    return bytes;
  }
}

/** A part of a file. */
async function read(file: string, first: number, bytes: number): Promise<Buffer> {
  const opened = await open(file);
  try {
    const buffer = Buffer.alloc(bytes);
    const { bytesRead } = await opened.read(buffer, 0, bytes, first);
    return buffer.subarray(0, bytesRead);
  } finally {
    await opened.close();
  }
}
