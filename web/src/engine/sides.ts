// Where does an engine work: in a worker, or here?

import type { Answers, Call, Calls, Said, Tells } from "./calls.ts";
import type { EngineEvents } from "./api.ts";
import type { Host } from "./host.ts";
import { problem } from "./problem.ts";
import address from "./worker.ts?worker&url";

type Tell = (name: keyof EngineEvents, value: never) => void;

/** What does the work. */
export interface Side {
  /** The host itself, where it is on this thread. */
  readonly host: Host | null;
  ask<K extends keyof Answers>(
    name: K,
    values: Parameters<Answers[K]>,
    transfer?: Transferable[],
  ): ReturnType<Answers[K]>;
  tell<K extends keyof Tells>(name: K, ...values: Parameters<Tells[K]>): void;
  end(): void;
  /** Ends as if it broke. */
  crash(): void;
}

/** A host in a worker; `lost` is called when the worker breaks. */
export class Remote implements Side {
  readonly host = null;
  readonly #worker: Worker;
  readonly #lost: () => void;
  readonly #waiting = new Map<
    number,
    { resolve(value: unknown): void; reject(error: unknown): void }
  >();
  #calls = 0;

  constructor(worker: Worker, tell: Tell, lost: () => void) {
    this.#worker = worker;
    this.#lost = lost;
    worker.onmessage = ({ data }: MessageEvent<Said>) => {
      if ("event" in data) return tell(data.event, data.value as never);
      const waiting = this.#waiting.get(data.id);
      this.#waiting.delete(data.id);
      if ("error" in data) waiting?.reject(data.error);
      else waiting?.resolve(data.value);
    };
    worker.onerror = (event) => {
      event.preventDefault();
      this.crash();
    };
  }

  ask<K extends keyof Answers>(
    name: K,
    values: Parameters<Answers[K]>,
    transfer: Transferable[] = [],
  ): ReturnType<Answers[K]> {
    const id = ++this.#calls;
    const call: Call = { id, name: name as keyof Calls, values };
    const answer = new Promise((resolve, reject) => this.#waiting.set(id, { resolve, reject }));
    this.#worker.postMessage(call, transfer);
    return answer as ReturnType<Answers[K]>;
  }

  tell<K extends keyof Tells>(name: K, ...values: Parameters<Tells[K]>): void {
    this.#worker.postMessage({ id: 0, name: name as keyof Calls, values } satisfies Call);
  }

  end(): void {
    this.#worker.terminate();
    for (const { reject } of this.#waiting.values()) {
      reject(problem("internal", false, "the worker ended"));
    }
    this.#waiting.clear();
  }

  crash(): void {
    this.end();
    this.#lost();
  }
}

/** Starts a worker; for a page of another origin one that imports it. */
export function startWorker(tell: Tell, lost: () => void): Side {
  const url = new URL(address, import.meta.url);
  if (url.origin === location.origin) {
    return new Remote(new Worker(url, { type: "module" }), tell, lost);
  }
  const text = `import ${JSON.stringify(url.href)};`;
  const blob = URL.createObjectURL(new Blob([text], { type: "text/javascript" }));
  return new Remote(new Worker(blob, { type: "module" }), tell, lost);
}

/** A host on this thread. */
export async function startHere(tell: Tell): Promise<Side> {
  const { Host } = await import("./host.ts");
  const host: Host = new Host((name, value) => tell(name, value as never));
  const call = (name: keyof Calls, values: readonly unknown[]) =>
    (host[name] as (...values: readonly unknown[]) => unknown).apply(host, values as unknown[]);
  return {
    host,
    ask: <K extends keyof Answers>(name: K, values: Parameters<Answers[K]>) =>
      call(name, values) as ReturnType<Answers[K]>,
    tell: (name, ...values) => void call(name, values),
    end: () => void host.leave(),
    crash: () => void host.leave(),
  };
}
