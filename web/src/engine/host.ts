// What does an engine do, in a worker or on the page's own thread?
//
// Bytes come from the loader, planes from the decoders; core and render, as wasm, say which and
// show them.

import { choosesItself, demoPolicy, firstPolicy } from "./api.ts";
import type { EngineProblem, PackFacts, Pixels, PolicyName, Pose, SoundPackets } from "./api.ts";
import type { EyeRequest, GazeRecord, Stats, Target, Towards, View } from "./api.ts";
import type { Calls, HostOptions, Tell } from "./calls.ts";
import { Courier } from "./courier.ts";
import { Poster, softwareSize } from "./poster.ts";
import { problem, problemOf } from "./problem.ts";
import { Device, FLAG, loadWasm, type Pack, Show } from "./wasm.ts";

/** How often figures are reported while something changes, in milliseconds. */
const STATS_MS = 500;
/** Longest wait for a picture of the screen before a step, in milliseconds. */
const LATE_MS = 250;
/** How often it is looked whether the device is there, in milliseconds. */
const LOOK_MS = 500;
/** Longest wait for a picture to settle before its pixels are read, in milliseconds. */
const SETTLE_MS = 20_000;

/** A device that has not drawn the first picture by then leaves it to the processor, in ms. */
const SLOW_MS = 150;

const seconds = () => performance.now() / 1000;

/** What there is to draw on, by the name that the browser gives it; null without a device. */
async function findDevice(): Promise<string | null> {
  if (!("gpu" in navigator)) return null;
  const best = { powerPreference: "high-performance" } as const;
  const adapter = await navigator.gpu.requestAdapter(best).catch(() => null);
  if (adapter === null) return null;
  const { vendor, architecture, device, description } = adapter.info;
  return [vendor, description || device || architecture].filter((word) => word !== "").join(" ");
}

function factsOf(pack: Pack, software: boolean): PackFacts {
  const facts = JSON.parse(pack.about()) as PackFacts;
  if (!software) return { ...facts, drawing: "gpu" };
  return { ...facts, drawing: "software", policies: ["coarsest"] };
}

export class Host implements Calls {
  readonly #tell: Tell;
  #show: Show | null = null;
  /** What stands until the first picture is seen. */
  #poster: Poster | null = null;
  #courier: Courier | null = null;
  #began = 0;
  #policy: PolicyName = "viewport";
  #first: { seconds: number; trips: number } | null = null;
  #settled = false;
  /** A step is on its way: soon, or with the next picture of the screen. */
  #soon = false;
  #next = false;
  readonly #bell = new MessageChannel();
  #recovering = false;
  #told = 0;
  #drawing = false;
  /** A policy that waits for its tables. */
  #changing: Promise<void> = Promise.resolve();
  #watch: ReturnType<typeof setInterval> | undefined;
  #closed = false;
  /** No device draws: only the coarsest level, on few pixels. */
  #software = false;
  /** What the browser calls the device; empty where it does not say. */
  #device = "";
  /** Pixels drawn over pixels of the canvas on the page. */
  #scale = 1;
  #frameMs = 0;
  #waiting: (() => void)[] = [];

  constructor(tell: Tell) {
    this.#tell = tell;
    this.#bell.port1.onmessage = () => {
      this.#soon = false;
      this.#run();
    };
  }

  async open(begin: HostOptions): Promise<PackFacts> {
    this.#began = seconds();
    const { options } = begin;
    const courier = new Courier(begin, {
      wake: () => this.#wake(),
      tell: this.#tell,
      ended: (why) => this.#end(why),
    });
    this.#courier = courier;
    const [pack, device] = await Promise.all([courier.open(loadWasm()), findDevice()]);
    this.#software = device === null;
    this.#device = device ?? "";
    const facts = factsOf(pack, this.#software);
    await courier.prepare(facts);
    this.#policy = this.#software ? "coarsest" : firstPolicy(options, facts);
    const told = {
      name: begin.name,
      policy: this.#policy,
      target: options.target,
      slope: options.slope,
      coarse: options.privacy === "coarse",
      size: this.#scaled(options.size),
      screenSize: begin.screenSize,
      screen: begin.screen,
      fieldDeg: options.fieldDeg ?? 100,
      paused: options.paused ?? false,
      once: options.once ?? false,
      log: options.log ?? false,
    };
    if (begin.poster && !this.#software) {
      this.#poster = new Poster(pack, told, begin);
      courier.preview(this.#poster.show);
      this.#run();
    }
    try {
      const gpu = this.#software ? undefined : await Device.open();
      this.#show = new Show(begin.canvas, pack, gpu, JSON.stringify(told));
    } catch (error) {
      const text = String(error);
      throw problem(/adapter|device/i.test(text) ? "no-webgpu" : "broken-pack", true, text);
    }
    pack.free();
    if (begin.time > 0) this.#show.seek(begin.time, seconds());
    if (options.view) this.look(options.view);
    courier.serve(this.#show);
    void courier.tables().then(() => {
      if (choosesItself(options, facts)) this.#chooseCheaper(facts);
      this.#wake();
    });
    // A device that is lost while nothing moves says nothing by itself.
    this.#watch = setInterval(() => this.#show?.isLost() && this.#wake(), LOOK_MS);
    this.#tell("ready", facts);
    this.#run();
    return facts;
  }

  /** Takes the policy that needs fewer pixels of this content, unless another was asked for. */
  #chooseCheaper(facts: PackFacts): void {
    const cheaper = this.#show?.cheaperPolicy() as PolicyName | undefined;
    const isAsWas = this.#policy === demoPolicy(facts);
    if (cheaper !== undefined && cheaper !== this.#policy && isAsWas) this.setPolicy(cheaper);
  }

  /** The size that is drawn for a canvas of this size. */
  #scaled(size: readonly [number, number]): readonly [number, number] {
    const drawn = this.#software ? softwareSize(size) : size;
    this.#scale = Math.max(...drawn) / Math.max(...size);
    return drawn;
  }

  /** Steps soon: something came or was asked for. */
  #wake(): void {
    if (this.#soon || this.#closed) return;
    this.#soon = true;
    this.#bell.port2.postMessage(null);
  }

  /** Steps at the next picture of the screen. */
  #again(): void {
    if (this.#next || this.#closed) return;
    this.#next = true;
    // Whichever comes first takes the other away: what stays would make a second chain of steps.
    const run = () => {
      clearTimeout(late);
      cancelAnimationFrame(soon);
      this.#next = false;
      this.#run();
    };
    // In a headset, or where the screen is busy, pictures of the page come late or never.
    const late = setTimeout(run, LATE_MS);
    const soon = requestAnimationFrame(run);
  }

  #run(): void {
    const [show, courier] = [this.#show, this.#courier];
    if (!courier || this.#closed) return;
    if (!show) return this.#stepPoster();
    if (show.isLost()) {
      void this.#recover();
      return;
    }
    try {
      this.#step(show, courier);
    } catch (error) {
      this.#end(problemOf(error));
    }
  }

  #step(show: Show, courier: Courier): void {
    const began = seconds();
    const told = show.step(began);
    if (told & FLAG.hopeless) {
      return this.#end(problem("broken-pack", true, "no frame has a whole coarsest level"));
    }
    if (told & FLAG.wants) courier.ask();
    if (told & FLAG.draw) this.#draw();
    if (told & FLAG.ended) this.#tell("ended", this.#time(show));
    const settled = (told & FLAG.settled) !== 0;
    const newly = settled && !this.#settled;
    this.#settled = settled;
    if (newly) {
      this.#tell("settled", this.#stats(show, courier));
      for (const done of this.#waiting.splice(0)) done();
    }
    if (began * 1000 - this.#told > STATS_MS) {
      this.#told = began * 1000;
      show.setRate(courier.bytesPerSecond);
      courier.check();
      this.#tell("stats", this.#stats(show, courier));
    }
    if (told & FLAG.again) this.#again();
  }

  /** Draws at the next picture of the screen: more often would not be seen. */
  #draw(): void {
    if (this.#drawing) return;
    this.#drawing = true;
    requestAnimationFrame(() => {
      this.#drawing = false;
      const [show, courier] = [this.#show, this.#courier];
      if (!show || !courier || this.#closed || show.isLost()) return;
      const began = seconds();
      show.draw();
      const passed = seconds() - began;
      show.drawn(passed);
      this.#frameMs += (passed * 1000 - this.#frameMs) * (this.#frameMs === 0 ? 1 : 0.1);
      if (this.#first) return;
      void show.seen().then(() => this.#seen(show, courier));
      setTimeout(() => this.#stepPoster(), SLOW_MS);
    });
  }

  /** The first picture is on the canvas: time begins. */
  #seen(show: Show, courier: Courier): void {
    if (this.#first || this.#closed || show !== this.#show) return;
    this.#endPoster();
    show.begin(seconds());
    this.#first = { seconds: seconds() - this.#began, trips: courier.trips };
    this.#tell("picture", this.#first.seconds);
    this.#wake();
  }

  /** Draws the poster once what it shows has come. */
  #stepPoster(): void {
    if (!this.#poster) return;
    const picture = this.#poster.step(seconds());
    if (!this.#show) this.#courier?.ask();
    if (!picture) return;
    this.#tell("poster", picture);
    this.#endPoster();
  }

  #endPoster(): void {
    this.#courier?.forgetPoster();
    this.#poster?.show.free();
    this.#poster = null;
  }

  #stats(show: Show, courier: Courier): Stats {
    const shown = JSON.parse(show.stats(seconds())) as Stats;
    return {
      ...shown,
      ...courier.stats(),
      drawing: this.#device === "" ? shown.drawing : `${this.#device} (webgpu)`,
      // What was asked for since the last step is not shown yet.
      settled: this.#settled,
      frameMs: this.#frameMs,
      firstPicture: this.#first?.seconds ?? null,
      firstPictureTrips: this.#first?.trips ?? null,
    };
  }

  /** A lost device is replaced; what was on it comes from memory. */
  async #recover(): Promise<void> {
    if (this.#recovering) return;
    this.#recovering = true;
    this.#tell("lost", "gpu");
    for (let wait = 100; !this.#closed; wait = Math.min(2 * wait, 5000)) {
      try {
        this.#show?.restart(await Device.open());
        break;
      } catch {
        await new Promise((done) => setTimeout(done, wait));
      }
    }
    this.#recovering = false;
    this.#settled = false;
    this.#tell("restored", "gpu");
    this.#courier?.ask();
    this.#wake();
  }

  #end(why: EngineProblem): void {
    this.#tell("error", why);
    if (!why.fatal) return;
    this.#closed = true;
    this.#courier?.close();
    for (const done of this.#waiting.splice(0)) done();
  }

  /** Does something with the show, and looks what changed. */
  #do(deed: (show: Show, now: number) => void, kind: "gaze" | "internal" = "internal"): void {
    if (!this.#show || this.#closed) return;
    try {
      deed(this.#show, seconds());
    } catch (error) {
      this.#tell("error", problem(kind, false, String(error)));
    }
    this.#settled = false;
    this.#wake();
  }

  resize(width: number, height: number): void {
    this.#do((show) => show.resize(...this.#scaled([width, height])));
  }

  drag(dx: number, dy: number): void {
    this.#do((show) => show.drag(dx * this.#scale, dy * this.#scale));
  }

  fly(towards: Towards, isHeld: boolean, isHurried: boolean): void {
    this.#do((show, now) => show.fly(new Float64Array(towards), isHeld, isHurried, now));
  }

  stopFlying(): void {
    this.#do((show, now) => show.stopFlying(now));
  }

  zoom(factor: number, [x, y]: readonly [number, number]): void {
    this.#do((show) => show.zoom(factor, x * this.#scale, y * this.#scale));
  }

  turn(pose: Pose | null): void {
    this.#do((show) => show.turn(pose?.yawDeg ?? 0, pose?.pitchDeg ?? 0, pose?.rollDeg ?? 0));
  }

  look({ yawDeg = Number.NaN, pitchDeg = Number.NaN, fovDeg = Number.NaN }: View): void {
    this.#do((show) => show.look(yawDeg, pitchDeg, fovDeg));
  }

  reset(): void {
    this.#do((show) => show.reset());
  }

  pointer(place: readonly [number, number] | null): void {
    const [x, y] = [(place?.[0] ?? 0) * this.#scale, (place?.[1] ?? 0) * this.#scale];
    this.#do((show, now) => (place ? show.point(x, y) : show.leave(now)));
  }

  gaze(record: GazeRecord | string | null): void {
    const text = typeof record === "string" ? record : JSON.stringify(record);
    this.#do(
      (show, now) => (record === null ? show.forgetGaze() : show.gaze(text, now)),
      "gaze",
    );
  }

  #time(show: Show): number {
    return (JSON.parse(show.stats(seconds())) as Stats).time;
  }

  play(): void {
    this.#do((show, now) => {
      show.play(now);
      this.#tell("play", this.#time(show));
    });
  }

  pause(): void {
    this.#do((show, now) => {
      show.pause(now);
      this.#tell("pause", this.#time(show));
    });
  }

  seek(to: number): void {
    this.#do((show, now) => show.seek(to, now));
  }

  step(frames: number): void {
    this.#do((show, now) => show.stepFrames(frames, now));
  }

  heard(at: number): void {
    this.#show?.heard(at, seconds());
  }

  setPolicy(name: PolicyName): void {
    if (this.#software) return;
    // Something stands in until its tables are there.
    this.#do((show) => {
      show.setPolicy(name);
      this.#policy = name;
    });
    this.#changing = this.#courier?.tables() ?? Promise.resolve();
  }

  setTarget(target?: Target): void {
    this.#do((show) => show.setTarget(target === undefined ? undefined : JSON.stringify(target)));
  }

  async nextTarget(by: number): Promise<Target | null> {
    let next: string | undefined;
    this.#do((show) => {
      next = show.nextTarget(by);
    });
    return next === undefined ? null : (JSON.parse(next) as Target);
  }

  showLevels(shown: boolean): void {
    this.#do((show) => show.showLevels(shown));
    this.#do((show) => show.draw());
  }

  hurry(): void {
    this.#courier?.hurry();
    this.#wake();
  }

  loseDevice(): void {
    this.#show?.loseDevice();
    setTimeout(() => this.#wake(), 50);
  }

  async stats(): Promise<Stats> {
    if (!this.#show || !this.#courier) throw problem("internal", false, "not open");
    return this.#stats(this.#show, this.#courier);
  }

  async soundPackets(from: number, to: number): Promise<SoundPackets | null> {
    const look = () => (this.#show ? this.#show.soundPackets(from, to) : []);
    const parts = (await this.#courier?.until(look)) ?? [];
    if (parts.length < 5) return null;
    const [channels, preSkip, packetSamples, total, first] = parts as number[] as [
      number, number, number, number, number,
    ];
    const packets = parts.slice(5) as Uint8Array[];
    return { sampleRate: 48_000, channels, preSkip, packetSamples, first, packets, total };
  }

  async pixels(): Promise<Pixels> {
    await this.#changing;
    await this.#whenSettled();
    if (!this.#show) throw problem("internal", false, "not open");
    const [width, height, data] = (await this.#show.pixels()) as [number, number, Uint8Array];
    return { width, height, data };
  }

  #whenSettled(): Promise<void> {
    if (this.#settled || this.#closed) return Promise.resolve();
    return new Promise((done) => {
      this.#waiting.push(done);
      setTimeout(done, SETTLE_MS);
      this.#wake();
    });
  }

  async sessionLog(): Promise<string> {
    return this.#show?.log() ?? "";
  }

  async leave(): Promise<{ offset: number; bytes: Uint8Array }[]> {
    this.#closed = true;
    const pieces = this.#courier?.take() ?? [];
    this.#courier?.close();
    clearInterval(this.#watch);
    this.#bell.port1.close();
    this.#endPoster();
    this.#show?.free();
    this.#show = null;
    return pieces;
  }

  /** Draws what an eye of a headset sees onto a canvas of its size. */
  drawEye(canvas: OffscreenCanvas, request: EyeRequest): boolean {
    if (!this.#show || this.#closed) return false;
    const eye = new Float64Array([
      ...request.orientation,
      ...request.tangents,
      ...request.position,
    ]);
    const drawn = this.#show.drawEye(canvas, request.eye === "right", eye, seconds());
    // In a headset pictures of the page come late or never.
    if (drawn) this.#show.begin(seconds());
    this.#wake();
    return drawn;
  }
}
