// How do gazes come from a tracker's WebSocket?
//
// The other end is a server that sends records (docs/formats/gaze.md), one a line; nothing is ever
// sent to it.

/** What is heard of a socket. */
export interface GazeHeard {
  /** One line. */
  record(line: string): void;
  /** It opened (true) or was lost (false), which is reported once. */
  connected(is: boolean): void;
}

/** The longest message that is looked at, in characters. */
const LONGEST = 1 << 16;
/** Milliseconds until a lost server is tried again, at first and at most. */
const FIRST_PAUSE = 500;
const LONGEST_PAUSE = 8000;

/** Lines a second that are looked at, and how many of them at once: several times what trackers
 *  send. */
const MOST_PER_S = 4000;
const MOST_AT_ONCE = 400;

/** Lets the newest lines through where more come than a page can look at. */
export class Sieve {
  #left = MOST_AT_ONCE;
  #since = 0;

  /** The lines of a message that came at `now`, in milliseconds. */
  through(lines: readonly string[], now: number): readonly string[] {
    const filled = this.#left + ((now - this.#since) / 1000) * MOST_PER_S;
    this.#since = now;
    const passed = Math.min(lines.length, Math.floor(Math.min(filled, MOST_AT_ONCE)));
    this.#left = Math.min(filled, MOST_AT_ONCE) - passed;
    return lines.slice(lines.length - passed);
  }
}

/** Listens at a WebSocket address, again whenever it is lost, until the signal ends it. Throws a
 *  sentence for people where it is no such address. */
export function listenForGaze(address: string, heard: GazeHeard, signal: AbortSignal): void {
  let url: URL;
  try {
    url = new URL(address);
  } catch {
    url = new URL("about:blank");
  }
  if (url.protocol !== "ws:" && url.protocol !== "wss:") {
    throw new Error(`gaze is ${address}; give a WebSocket address, as ws://127.0.0.1:5005`);
  }
  const sieve = new Sieve();
  let pause = FIRST_PAUSE;
  const open = (): void => {
    if (signal.aborted) return;
    const socket = new WebSocket(url);
    const end = (): void => socket.close();
    let wasOpen = false;
    signal.addEventListener("abort", end, { once: true });
    socket.addEventListener("open", () => {
      wasOpen = true;
      pause = FIRST_PAUSE;
      heard.connected(true);
    });
    socket.addEventListener("message", ({ data }: MessageEvent<unknown>) => {
      if (typeof data !== "string" || data.length > LONGEST) return;
      const lines = data.split("\n").filter((line) => line.trim() !== "");
      for (const line of sieve.through(lines, performance.now())) heard.record(line);
    });
    socket.addEventListener("close", () => {
      signal.removeEventListener("abort", end);
      if (signal.aborted) return;
      if (wasOpen || pause === FIRST_PAUSE) heard.connected(false);
      setTimeout(open, pause);
      pause = Math.min(2 * pause, LONGEST_PAUSE);
    });
  };
  open();
}
