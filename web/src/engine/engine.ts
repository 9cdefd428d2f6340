// How does a page hold an engine?

import type { EngineApi, EngineOptions } from "./api.ts";

/** Opens engines: the pack's beginning is read before the promise settles. */
export const Engine = {
  /** Puts a canvas into `place` and shows the pack on it. Rejects with an EngineProblem. */
  open(_place: HTMLElement, _options: EngineOptions): Promise<EngineApi> {
    return Promise.reject(new Error("not built yet"));
  },
};
