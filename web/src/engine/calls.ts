// What does the page's side of an engine ask of the side that works?

import type { EngineEvents, EngineOptions, Pixels, SoundPackets, Stats } from "./api.ts";
import type { GazeRecord, PackFacts, PolicyName, Pose, Target, Towards, View } from "./api.ts";

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
export interface Answers {
  open(options: HostOptions): Promise<PackFacts>;
  stats(): Promise<Stats>;
  soundPackets(from: number, to: number): Promise<SoundPackets | null>;
  pixels(): Promise<Pixels>;
  nextTarget(by: number): Promise<Target | null>;
  sessionLog(): Promise<string>;
  /** Stops, and hands over all bytes. */
  leave(): Promise<{ offset: number; bytes: Uint8Array }[]>;
}

/** Calls that are only made. */
export interface Tells {
  resize(width: number, height: number): void;
  drag(dx: number, dy: number): void;
  fly(towards: Towards, isHeld: boolean, isHurried: boolean): void;
  stopFlying(): void;
  zoom(factor: number, place: readonly [number, number]): void;
  turn(pose: Pose | null): void;
  look(view: View): void;
  reset(): void;
  pointer(place: readonly [number, number] | null): void;
  gaze(record: GazeRecord | string | null): void;
  play(): void;
  pause(): void;
  seek(seconds: number): void;
  step(frames: number): void;
  heard(seconds: number): void;
  setPolicy(name: PolicyName): void;
  setTarget(target?: Target): void;
  showLevels(shown: boolean): void;
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
