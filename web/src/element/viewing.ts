// What happens between a pack that is open and the controls around it?

import { demoPolicy, type EngineApi, type GazeRecord, type PackFacts } from "../engine/api.ts";
import type { PolicyName, Pose, Stats, Target, Towards, View } from "../engine/api.ts";
import type { Actions, Toggle } from "./actions.ts";
import { type Tell, problemOf } from "./events.ts";
import { listenForGaze } from "./gaze-socket.ts";
import { followDevice } from "./orientation.ts";
import type { Overlay } from "./overlay.ts";
import type { Shell } from "./shell.ts";
import { Sound } from "./sound.ts";
import { parts, spokenTime } from "./words.ts";
import { enterHeadset, hasHeadset } from "./xr.ts";

/** The policies that a content's calibration decides between. */
const JUDGED: readonly PolicyName[] = ["perceptual", "acuity"];

/** What a viewing is given. */
export interface Surroundings {
  readonly host: HTMLElement;
  readonly shell: Shell;
  readonly overlay: Overlay;
  readonly tell: Tell;
  /** Ends the viewing. */
  readonly signal: AbortSignal;
}

/** How a viewing begins. */
export interface ViewingSettings {
  readonly paused: boolean;
  readonly muted: boolean;
  readonly policy: PolicyName;
}

/** One open pack and its controls. */
export class Viewing implements Actions {
  private readonly sound: Sound;
  private soundIsPossible = false;
  private soundIsWanted: boolean;
  private touched = false;
  private playing: boolean;
  /** The first picture is there, and time runs. */
  private pictured = false;
  private time = 0;
  private policy: PolicyName = "viewport";
  /** The policy of the demo; the content may decide otherwise once its calibration is there. */
  private demo: PolicyName;
  /** The viewer has chosen a policy. */
  private chosen = false;
  /** Where a skip has led that no figures have reported yet. */
  private skipping: number | null = null;
  private sensor: AbortController | null = null;
  /** The last trouble that was said. */
  private said = "";

  constructor(
    private readonly engine: EngineApi,
    private readonly around: Surroundings,
    settings: ViewingSettings,
  ) {
    this.sound = new Sound(engine);
    this.playing = !settings.paused;
    this.soundIsWanted = !settings.muted;
    const { signal, overlay, shell, tell } = around;
    overlay.offer(engine.pack);
    shell.offerKeys(engine.pack);
    shell.showPlaying(this.playing);
    shell.showTime(0, engine.pack.seconds);
    shell.showsTime = engine.pack.frames > 1;
    this.demo = demoPolicy(engine.pack);
    shell.buttons.demo.hidden = !engine.pack.policies.includes(this.demo);
    this.showPolicy(settings.policy);
    this.listen();
    this.fit();
    void this.offerSound();
    void this.offerHeadset();
    signal.addEventListener("abort", () => {
      this.sensor?.abort();
      this.sound.turnOff();
      engine.close();
    });
    shell.showNote(engine.pack.drawing === "software" ? SOFTWARE : null);
    tell("ready", engine.pack);
    shell.say(spokenFacts(engine.pack), "heard");
  }

  stats(): Promise<Stats> {
    return this.engine.stats();
  }

  get pack(): PackFacts {
    return this.engine.pack;
  }

  gaze(record: GazeRecord | string | null): void {
    this.engine.gaze(record);
  }

  turn(pose: Pose | null): void {
    this.engine.turn(pose);
  }

  look(view: View): void {
    this.engine.look(view);
  }

  seek(seconds: number): void {
    const { pack } = this.engine;
    // The end of the last picture is the beginning of the first one's next round.
    const last = pack.seconds * (1 - 0.5 / pack.frames);
    const there = Math.max(0, Math.min(seconds, last));
    this.skipping = there;
    this.engine.seek(there);
    this.around.shell.showTime(there, this.engine.pack.seconds);
    if (this.playing && this.pictured) this.sound.start(there);
  }

  /** Follows a sender of gazes until the signal ends it. */
  follow(address: string, signal: AbortSignal): void {
    const { shell, tell } = this.around;
    const heard = {
      record: (line: string): void => this.engine.gaze(line),
      connected: (is: boolean): void => {
        tell("gazeconnection", is);
        if (is) shell.say("The gaze's sender is heard.", "seen");
        else shell.say(`No gaze comes from ${address}; it is tried again by itself.`, "seen");
        if (!is) this.engine.gaze(null);
      },
    };
    signal.addEventListener("abort", () => this.engine.gaze(null), { once: true });
    listenForGaze(address, heard, signal);
  }

  gesture(): void {
    if (this.touched) return;
    this.touched = true;
    if (this.soundIsPossible && this.soundIsWanted) void this.turnSound(true);
  }

  drag(dx: number, dy: number): void {
    const [x, y] = this.density();
    this.engine.drag(dx * x, dy * y);
  }

  fly(towards: Towards, isHeld: boolean, isHurried: boolean): void {
    this.engine.fly(towards, isHeld, isHurried);
  }

  stopFlying(): void {
    this.engine.stopFlying();
  }

  zoom(factor: number, place: readonly [number, number] | null): void {
    const { clientWidth, clientHeight } = this.around.shell.stage;
    this.engine.zoom(factor, this.device(place ?? [clientWidth / 2, clientHeight / 2]));
  }

  reset(): void {
    this.engine.reset();
  }

  pointer(place: readonly [number, number] | null): void {
    this.engine.pointer(place === null ? null : this.device(place));
  }

  skip(seconds: number): void {
    this.seek((this.skipping ?? this.time) + seconds);
  }

  step(frames: number): void {
    this.engine.pause();
    this.engine.step(frames);
  }

  seekShare(share: number): void {
    this.seek(share * this.engine.pack.seconds);
  }

  toggle(what: Toggle): void {
    const { overlay, shell, host } = this.around;
    switch (what) {
      case "play":
        if (this.playing) this.engine.pause();
        else this.engine.play();
        break;
      case "sound":
        if (this.soundIsPossible) void this.turnSound(!this.sound.isOn);
        break;
      case "figures":
        this.showFigures(overlay.panel.hidden !== false);
        break;
      case "levels":
        overlay.showsLevels = !overlay.showsLevels;
        this.engine.showLevels(overlay.showsLevels);
        break;
      case "fullscreen":
        if (document.fullscreenElement !== null) void document.exitFullscreen();
        else void host.requestFullscreen().catch(() => undefined);
        break;
      case "keys":
        shell.showsKeys = !shell.showsKeys;
        break;
      case "overlay":
        this.turnThePage();
        break;
    }
  }

  /** From the keys to the figures to nothing. */
  private turnThePage(): void {
    const { overlay, shell } = this.around;
    const [keys, figures] = [shell.showsKeys, !overlay.panel.hidden];
    shell.showsKeys = !keys && !figures;
    this.showFigures(keys);
  }

  nextPolicy(by: number): void {
    const { policies } = this.engine.pack;
    const at = policies.findIndex((name) => name === this.policy);
    const name = policies[(Math.max(at, 0) + by + policies.length) % policies.length];
    if (name === undefined) return;
    this.setPolicy(name);
    this.around.shell.say(`Policy ${name}`, "seen");
  }

  /** What a change of the figures' choices does. */
  setPolicy(name: PolicyName): void {
    this.chosen = true;
    this.engine.setPolicy(name);
    this.showPolicy(name);
  }

  nextTarget(by: number): void {
    const { shell } = this.around;
    void this.engine.nextTarget(by).then((target) => {
      if (target === null) shell.say(`Policy ${this.policy} chooses for no score.`, "seen");
      else shell.say(target === "none" ? "No target score" : `Target score ${target}`, "seen");
    });
  }

  setTarget(target?: Target): void {
    this.engine.setTarget(target);
  }

  /** Makes the pointer the eye, or all that is in view sharp again. */
  toggleDemo(): void {
    const isOn = this.policy === this.demo;
    this.setPolicy(isOn ? "viewport" : this.demo);
    this.around.shell.say(isOn ? "All that is in view gets sharp." : DEMO_WORDS, "seen");
  }

  private showPolicy(name: PolicyName): void {
    this.policy = name;
    this.around.shell.press("demo", name === this.demo);
  }

  showLevels(shown: boolean): void {
    this.engine.showLevels(shown);
  }

  play(): void {
    this.engine.play();
  }

  pause(): void {
    this.engine.pause();
  }

  private showFigures(shown: boolean): void {
    const { overlay, shell } = this.around;
    overlay.panel.hidden = !shown;
    shell.press("figures", shown);
    if (shown) void this.engine.stats().then((stats) => overlay.show(stats));
  }

  /** Device pixels over a CSS pixel of the stage. */
  private density(): readonly [number, number] {
    const { stage } = this.around.shell;
    const [width, height] = this.size;
    return [width / Math.max(1, stage.clientWidth), height / Math.max(1, stage.clientHeight)];
  }

  private device([x, y]: readonly [number, number]): readonly [number, number] {
    const [dx, dy] = this.density();
    return [x * dx, y * dy];
  }

  private size: readonly [number, number] = [1, 1];

  /** Keeps the canvas as large as the stage. */
  private fit(): void {
    const { stage } = this.around.shell;
    this.size = deviceSize(stage);
    const watch = new ResizeObserver(() => {
      const [width, height] = deviceSize(stage);
      if (width === this.size[0] && height === this.size[1]) return;
      this.size = [width, height];
      this.engine.resize(width, height);
    });
    watch.observe(stage);
    this.around.signal.addEventListener("abort", () => watch.disconnect());
  }

  private listen(): void {
    const { engine } = this;
    const { shell, overlay, tell } = this.around;
    const seconds = engine.pack.seconds;
    engine.on("picture", (after) => {
      shell.showPoster(null);
      if (!this.pictured && this.playing) this.sound.start(this.skipping ?? this.time);
      this.pictured = true;
      tell("picture", after);
    });
    engine.on("settled", (stats) => {
      // Where nothing moves any more no other figures follow.
      if (!overlay.panel.hidden) overlay.show(stats);
      tell("settled", stats);
    });
    engine.on("stats", (stats) => {
      this.time = stats.time;
      const isOn = this.policy === this.demo && !this.chosen;
      if (isOn && JUDGED.includes(stats.policy)) this.demo = stats.policy;
      this.showPolicy(stats.policy);
      this.skipping = null;
      shell.showTime(stats.time, seconds);
      if (!overlay.panel.hidden) overlay.show(stats);
      tell("stats", stats);
    });
    engine.on("play", (time) => this.plays(true, time));
    engine.on("pause", (time) => this.plays(false, time));
    engine.on("ended", (time) => {
      this.plays(false, time);
      tell("ended", time);
    });
    engine.on("error", (problem) => {
      if (problem.fatal) this.sound.stop();
      // A sender of wrong gazes sends many.
      else if (problem.message !== this.said) shell.say(problem.message, "seen");
      this.said = problem.message;
      tell("problem", problem);
    });
    engine.on("changed", (text) => {
      shell.say("The host has a newer file; this is it.", "seen");
      tell("changed", text);
    });
    engine.on("lost", (what) => {
      shell.say(LOST[what], "seen");
      tell("lost", what);
    });
    engine.on("restored", (what) => {
      this.said = "";
      shell.say("It goes on.", "seen");
      tell("restored", what);
    });
  }

  private plays(playing: boolean, time: number): void {
    const { shell, tell } = this.around;
    this.playing = playing;
    this.time = time;
    shell.showPlaying(playing);
    if (playing && this.pictured) this.sound.start(time);
    else this.sound.stop();
    tell(playing ? "play" : "pause", time);
    shell.say(playing ? "Plays" : `Paused at ${spokenTime(time)}`, "heard");
  }

  private async offerSound(): Promise<void> {
    const { shell, signal } = this.around;
    this.soundIsPossible = await Sound.isPossible(this.engine);
    if (signal.aborted) return;
    shell.buttons.sound.hidden = !this.soundIsPossible;
    shell.showSound(false);
    if (this.touched && this.soundIsPossible && this.soundIsWanted) await this.turnSound(true);
  }

  private async turnSound(on: boolean): Promise<void> {
    this.soundIsWanted = on;
    this.touched = true;
    const plays = this.playing && this.pictured;
    if (on) await this.sound.turnOn(plays, (await this.engine.stats()).time);
    else this.sound.turnOff();
    this.around.shell.showSound(on);
  }

  /** Starts or ends following how the device is held. */
  async toggleSensor(): Promise<void> {
    const { shell, signal } = this.around;
    if (this.sensor !== null) {
      this.sensor.abort();
      this.sensor = null;
      shell.press("sensor", false);
      return;
    }
    const following = new AbortController();
    this.sensor = following;
    signal.addEventListener("abort", () => following.abort(), { signal: following.signal });
    try {
      await followDevice((pose) => this.engine.turn(pose), following.signal);
      shell.press("sensor", true);
    } catch (error) {
      this.sensor = null;
      shell.say(problemOf(error).message, "seen");
    }
  }

  private async offerHeadset(): Promise<void> {
    const there = this.engine.pack.drawing === "gpu" && (await hasHeadset());
    if (!this.around.signal.aborted) this.around.shell.buttons.headset.hidden = !there;
  }

  /** Goes into the headset, and back when the viewer leaves it. */
  async enterHeadset(): Promise<void> {
    const { shell, tell } = this.around;
    shell.press("headset", true);
    try {
      await enterHeadset(this.engine, () => tell("headset", true));
    } catch (error) {
      shell.say(`The headset cannot be entered: ${problemOf(error).message}`, "seen");
    } finally {
      shell.press("headset", false);
      tell("headset", false);
    }
  }
}

const LOST = {
  gpu: "The graphics device is gone; it is asked for again.",
  worker: "Drawing stopped; it begins again.",
  network: "The host cannot be reached. What is here stays, and the rest comes when it is back.",
} as const;

const DEMO_WORDS =
  "Demo: your pointer acts as your gaze; look at it. Only what you could see is fetched.";

const SOFTWARE =
  "This browser does not support WebGPU, so only the coarsest picture is shown. For all of it, " +
  "open this page in a current Chrome, Edge, Safari or Firefox, with a graphics device.";

/** Columns and rows of device pixels of an element; at least one each. */
export function deviceSize(of: HTMLElement): readonly [number, number] {
  const side = (css: number): number => Math.max(1, Math.round(css * devicePixelRatio));
  return [side(of.clientWidth), side(of.clientHeight)];
}

function spokenFacts(pack: PackFacts): string {
  if (pack.kind === "scene") return `Scene of ${parts(pack)}`;
  const around = pack.projection === "flat" ? "" : " all around";
  if (pack.frames === 1) return `Picture${around}`;
  return `Video${around}, ${spokenTime(pack.seconds)}${pack.hasSound ? ", with sound" : ""}`;
}
