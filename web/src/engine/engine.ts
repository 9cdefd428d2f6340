// How does a page hold an engine?

import type { EngineApi, EngineEvents, EngineOptions, EyeRequest, PackFacts } from "./api.ts";
import type { EngineProblem, PolicyName, Stats, Target } from "./api.ts";
import type { Answers, HostOptions, Tells } from "./calls.ts";
import type { Host } from "./host.ts";
import { type Side, startHere, startWorker } from "./sides.ts";
import { problem, problemOf } from "./problem.ts";
import { screenOf } from "./screen.ts";

type Pieces = HostOptions["pieces"];
type Heard = { [K in keyof EngineEvents]: Set<(value: EngineEvents[K]) => void> };

/** Tries to start a worker again, and the wait between them in milliseconds. */
const MOST_STARTS = 5;
const START_WAIT = 300;

class PageEngine implements EngineApi {
  readonly #place: HTMLElement;
  readonly #options: EngineOptions;
  readonly #heard: Heard;
  #side: Side | null = null;
  #canvas: HTMLCanvasElement;
  /** Canvases whose picture stays until there is another. */
  #before: HTMLCanvasElement[] = [];
  #pack: PackFacts | null = null;
  #thread: "worker" | "main";
  #size: readonly [number, number];
  #policy: PolicyName | null = null;
  /** The target and slope of now; the first are those of the options. */
  #detail: Pick<EngineOptions, "target" | "slope">;
  #levels = false;
  #playing: boolean;
  #time = 0;
  #starts = 0;
  #closed = false;
  #eyes: OffscreenCanvas | null = null;
  readonly drag = this.#told("drag");
  readonly fly = this.#told("fly");
  readonly stopFlying = this.#told("stopFlying");
  readonly zoom = this.#told("zoom");
  readonly turn = this.#told("turn");
  readonly look = this.#told("look");
  readonly reset = this.#told("reset");
  readonly pointer = this.#told("pointer");
  readonly gaze = this.#told("gaze");
  readonly heard = this.#told("heard");
  readonly stats = this.#asked("stats");
  readonly soundPackets = this.#asked("soundPackets");
  readonly pixels = this.#asked("pixels");
  readonly sessionLog = this.#asked("sessionLog");

  constructor(place: HTMLElement, options: EngineOptions) {
    this.#place = place;
    this.#options = options;
    this.#thread = options.thread ?? "worker";
    this.#size = options.size;
    const { target, slope } = options;
    this.#detail = {
      ...(target === undefined ? {} : { target }),
      ...(slope === undefined ? {} : { slope }),
    };
    this.#playing = !(options.paused ?? false);
    this.#canvas = document.createElement("canvas");
    const names: (keyof EngineEvents)[] = [
      "ready", "poster", "picture", "settled", "stats", "error", "changed",
      "lost", "restored", "play", "pause", "ended",
    ];
    this.#heard = Object.fromEntries(names.map((name) => [name, new Set()])) as unknown as Heard;
    addEventListener("online", this.#online);
  }

  readonly #online = () => this.#side?.tell("hurry");

  get pack(): PackFacts {
    if (!this.#pack) throw problem("internal", false, "not open");
    return this.#pack;
  }

  get canvas(): HTMLCanvasElement {
    return this.#canvas;
  }

  get thread(): "worker" | "main" {
    return this.#thread;
  }

  /** Begins on a fresh canvas; a canvas that a worker draws on cannot be had back. */
  async start(pieces: Pieces = []): Promise<void> {
    const before = this.#side;
    const made = document.createElement("canvas");
    [made.width, made.height] = this.#size as [number, number];
    const canvas = made.transferControlToOffscreen();
    const tell = (name: keyof EngineEvents, value: never) => {
      if (side === this.#side) this.#say(name, value);
    };
    const side: Side =
      this.#thread === "worker"
        ? startWorker(tell, () => this.#workerLost(side))
        : await startHere(tell);
    this.#side = side;
    before?.end();
    const poster = this.#before.length === 0 && before === null;
    if (this.#canvas.parentNode === this.#place) {
      this.#canvas.before(made);
      this.#before.push(this.#canvas);
    } else {
      this.#place.append(made);
    }
    made.className = this.#canvas.className;
    this.#canvas = made;
    const url = new URL(this.#options.src, document.baseURI).href;
    const policy = this.#policy ?? this.#options.policy;
    const { target: _, slope: __, ...rest } = this.#options;
    const options: EngineOptions = {
      ...rest,
      ...this.#detail,
      size: this.#size,
      paused: !this.#playing,
      ...(policy ? { policy } : {}),
    };
    const name = decodeURIComponent(new URL(url).pathname.split("/").pop() ?? "");
    const about = { options, url, name, pieces, poster, time: this.#time };
    const begin = { canvas, ...about, ...screenOf(options) };
    this.#pack = await side.ask("open", [begin], [canvas, ...buffers(pieces)]);
    this.#starts = 0;
    if (this.#levels) side.tell("showLevels", true);
  }

  #workerLost(side: Side): void {
    if (side !== this.#side || this.#closed) return;
    this.#say("lost", "worker");
    if (++this.#starts > MOST_STARTS) {
      return this.#say("error", problem("internal", true, "the worker ends again and again"));
    }
    setTimeout(() => {
      if (this.#closed) return;
      this.start().then(
        () => this.#say("restored", "worker"),
        (error: unknown) => this.#say("error", problemOf(error)),
      );
    }, START_WAIT * this.#starts);
  }

  #say<K extends keyof EngineEvents>(name: K, value: EngineEvents[K]): void {
    if (name === "stats" || name === "settled") this.#time = (value as Stats).time;
    if (name === "ended") this.#playing = false;
    if (name === "poster") this.#layOver(value as ImageBitmap);
    if (name === "picture") for (const gone of this.#before.splice(0)) gone.remove();
    for (const heard of this.#heard[name]) heard(value);
    if (name === "changed" && !this.#closed) {
      this.start().catch((error: unknown) => this.#say("error", problemOf(error)));
    }
  }

  /** Lays a picture over the canvas until there is another. */
  #layOver(picture: ImageBitmap): void {
    const laid = document.createElement("canvas");
    [laid.width, laid.height] = [picture.width, picture.height];
    laid.getContext("bitmaprenderer")?.transferFromImageBitmap(picture);
    laid.className = this.#canvas.className;
    this.#canvas.after(laid);
    this.#before.push(laid);
  }

  on<K extends keyof EngineEvents>(name: K, heard: (value: EngineEvents[K]) => void): () => void {
    this.#heard[name].add(heard);
    return () => this.#heard[name].delete(heard);
  }

  #tell<K extends keyof Tells>(name: K, ...values: Parameters<Tells[K]>): void {
    this.#side?.tell(name, ...values);
  }

  #ask<K extends keyof Answers>(
    name: K,
    ...values: Parameters<Answers[K]>
  ): ReturnType<Answers[K]> {
    if (!this.#side || this.#closed) throw problem("internal", false, "closed");
    return this.#side.ask(name, values) as ReturnType<Answers[K]>;
  }

  /** A call that goes to the host as it is. */
  #told<K extends keyof Tells>(name: K): (...values: Parameters<Tells[K]>) => void {
    return (...values) => this.#tell(name, ...values);
  }

  #asked<K extends keyof Answers>(
    name: K,
  ): (...values: Parameters<Answers[K]>) => ReturnType<Answers[K]> {
    return (...values) => this.#ask(name, ...values);
  }

  resize(width: number, height: number): void {
    this.#size = [width, height];
    this.#tell("resize", width, height);
  }

  play(): void {
    this.#playing = true;
    this.#tell("play");
  }

  pause(): void {
    this.#playing = false;
    this.#tell("pause");
  }

  seek(seconds: number): void {
    this.#time = seconds;
    this.#tell("seek", seconds);
  }

  step(frames: number): void {
    this.#playing = false;
    this.#tell("step", frames);
  }

  setPolicy(name: PolicyName): void {
    this.#policy = name;
    this.#tell("setPolicy", name);
  }

  setTarget(target?: Target): void {
    this.#detail = target === undefined ? {} : { target };
    this.#tell("setTarget", target);
  }

  async nextTarget(by: number): Promise<Target | null> {
    const target = await this.#ask("nextTarget", by);
    if (target !== null) this.#detail = { target };
    return target;
  }

  showLevels(shown: boolean): void {
    this.#levels = shown;
    this.#tell("showLevels", shown);
  }

  /** Loses what `what` names, as tests do. */
  lose(what: "gpu" | "worker"): void {
    if (what === "gpu") this.#tell("loseDevice");
    else if (this.#side) this.#side.crash();
  }

  async toThread(thread: "worker" | "main"): Promise<void> {
    if (thread === this.#thread) return;
    this.#time = (await this.stats()).time;
    const pieces = await this.#ask("leave");
    this.#thread = thread;
    await this.start(pieces);
  }

  drawEye(request: EyeRequest): ImageBitmap | null {
    const host: Host | null = this.#side?.host ?? null;
    if (!host) throw problem("internal", false, "eyes are drawn with thread main");
    const [width, height] = request.size;
    this.#eyes ??= new OffscreenCanvas(width, height);
    if (this.#eyes.width !== width) this.#eyes.width = width;
    if (this.#eyes.height !== height) this.#eyes.height = height;
    return host.drawEye(this.#eyes, request) ? this.#eyes.transferToImageBitmap() : null;
  }

  close(): void {
    if (this.#closed) return;
    removeEventListener("online", this.#online);
    const side = this.#side;
    this.#closed = true;
    this.#side = null;
    side?.end();
    for (const gone of [this.#canvas, ...this.#before.splice(0)]) gone.remove();
  }
}

function buffers(pieces: Pieces): ArrayBuffer[] {
  return [...new Set(pieces.map(({ bytes }) => bytes.buffer as ArrayBuffer))];
}

/** Opens engines. */
export const Engine = {
  /**
   * Puts a canvas into `place` and shows the pack on it; the promise settles once the pack is
   * understood. Rejects with an {@link EngineProblem}, and leaves nothing behind then.
   */
  async open(place: HTMLElement, options: EngineOptions): Promise<EngineApi> {
    const engine = new PageEngine(place, options);
    try {
      await engine.start();
      return engine;
    } catch (error) {
      engine.close();
      throw problemOf(error) satisfies EngineProblem;
    }
  },
};

