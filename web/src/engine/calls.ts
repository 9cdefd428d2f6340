// What does the page's side of an engine ask of the side that works?

import type { EngineApi, EngineEvents, EngineOptions, PackFacts } from "./api.ts";

/** What a host begins with. */
export interface HostOptions {
  readonly canvas: OffscreenCanvas;
  readonly options: EngineOptions;
  /** The pack's address, whole. */
  readonly url: string;
  /** Its file name, for the session log. */
  readonly name: string;
  readonly screenSize: readonly [number, number];
  readonly screen: { readonly diagonal_inches: number; readonly distance_m: number };
  /** Bytes that another thread fetched. */
  readonly pieces: readonly { offset: number; bytes: Uint8Array }[];
  /** Whether nothing is seen yet, so that a coarse picture is better than to wait. */
  readonly poster: boolean;
  /** Where the content is, in seconds. */
  readonly time: number;
}

/** Calls that are answered. */
export interface Answers
  extends Pick<EngineApi, "stats" | "soundPackets" | "pixels" | "nextTarget" | "sessionLog"> {
  open(options: HostOptions): Promise<PackFacts>;
  /** Stops, and hands over all bytes. */
  leave(): Promise<{ offset: number; bytes: Uint8Array }[]>;
}

type Told =
  | "resize" | "drag" | "fly" | "stopFlying" | "zoom" | "turn" | "look" | "reset" | "pointer"
  | "gaze" | "play" | "pause" | "seek" | "step" | "heard" | "setPolicy" | "setTarget"
  | "showLevels";

/** Calls that are only made. */
export interface Tells extends Pick<EngineApi, Told> {
  hurry(): void;
  loseDevice(): void;
}

export type Calls = Answers & Tells;

/** What a host reports; the same names as on the page. */
export type Tell = <K extends keyof EngineEvents>(name: K, value: EngineEvents[K]) => void;

/** From the page to the worker. */
export interface Call {
  /** 0 where no answer is awaited. */
  readonly id: number;
  readonly name: keyof Calls;
  readonly values: readonly unknown[];
}

/** From the worker to the page. */
export type Said =
  | { readonly id: number; readonly value: unknown }
  | { readonly id: number; readonly error: unknown }
  | { readonly event: keyof EngineEvents; readonly value: unknown };
