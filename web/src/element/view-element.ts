// What is <foveal-view>?

import {
  firstPolicy,
  type EngineOptions,
  type GazeRecord,
  type PackFacts,
  POLICIES,
  type PolicyName,
  type Pose,
  type Stats,
} from "../engine/api.ts";
import { Engine } from "../engine/engine.ts";
import { detailOf } from "./detail.ts";
import { DIRECTION, viewOf } from "./direction.ts";
import { type FovealViewEvents, type Tell, problemOf } from "./events.ts";
import { watchInput } from "./input.ts";
import { keepLaid } from "./laying.ts";
import { hasOrientation } from "./orientation.ts";
import { Overlay } from "./overlay.ts";
import { Shell } from "./shell.ts";
import { Viewing, deviceSize } from "./viewing.ts";

/** Attributes that reopen the pack when they change. */
const OPENS = ["src", "demo", "privacy", "once", "slope"] as const;
/** Those that count when it is opened. */
const AT_FIRST = ["muted", "paused"] as const;

/**
 * Shows a pack, with controls.
 *
 * Attributes: `src`, the pack; `demo`, the pointer is the gaze; `policy`, which levels are wanted;
 * `target`, for which score, or `slope`, for which acuity; `gaze`, the WebSocket address of a
 * tracker; `privacy="coarse"`, the host learns less of where one looks; `yaw`, `pitch`, `fov`,
 * where the view of a sphere begins, in degrees; `muted`, `paused`, `once`; `poster`, a picture to
 * begin with; `bare`, without controls; `label`, its name for those who listen.
 */
export class FovealView extends HTMLElement {
  static readonly observedAttributes: readonly string[] = [
    ...OPENS,
    ...AT_FIRST,
    ...DIRECTION,
    "policy",
    "target",
    "gaze",
    "poster",
    "bare",
    "label",
  ];

  private readonly shell: Shell;
  private readonly overlay: Overlay;
  private open: AbortController | null = null;
  private gazing: AbortController | null = null;
  private viewing: Viewing | null = null;
  private opening = false;

  constructor() {
    super();
    const root = this.attachShadow({ mode: "open", delegatesFocus: true });
    this.overlay = new Overlay({
      policy: (name) => this.viewing?.setPolicy(name),
      levels: (shown) => this.viewing?.showLevels(shown),
    });
    this.shell = new Shell(root, this.overlay.panel);
    this.shell.buttons.sensor.hidden = !hasOrientation();
    this.wire();
  }

  /** The pack, once it is understood. */
  get pack(): PackFacts | null {
    return this.viewing?.pack ?? null;
  }

  /** A gaze from elsewhere, as an object or a line of the record; null gives it back to the
   *  pointer. Throws what is wrong with it. */
  gaze(record: GazeRecord | string | null): void {
    this.viewing?.gaze(record);
  }

  /** Where the head points; with a pose, turns it there (null: as the hand turned it). */
  async pose(pose?: Pose | null): Promise<Required<Pose>> {
    if (pose !== undefined) this.viewing?.turn(pose);
    const [yawDeg, pitchDeg, rollDeg] = (await this.stats()).headDeg;
    return { yawDeg, pitchDeg, rollDeg };
  }

  /** Goes to a time of the content, in seconds. */
  seek(seconds: number): void {
    this.viewing?.seek(seconds);
  }

  play(): void {
    this.viewing?.play();
  }

  pause(): void {
    this.viewing?.pause();
  }

  /** Figures of the moment; rejects while no pack is open. */
  stats(): Promise<Stats> {
    return this.viewing?.stats() ?? Promise.reject(new Error("no pack is open"));
  }

  connectedCallback(): void {
    this.reopen();
  }

  disconnectedCallback(): void {
    this.close();
  }

  attributeChangedCallback(name: string, before: string | null, value: string | null): void {
    if (before === value) return;
    if (name === "bare") this.shell.bar.hidden = value !== null;
    if (name === "label") this.name();
    if (name === "poster" && this.viewing === null) this.shell.showPoster(value);
    if (!this.isConnected) return;
    if (name === "gaze") this.followGaze();
    if (name === "policy") this.setPolicy(value);
    if (name === "target") this.setTarget();
    if (DIRECTION.some((one) => one === name)) {
      const say = (sentence: string): void => this.shell.say(sentence, "seen");
      this.viewing?.look(viewOf((one) => (one === name ? value : null), say));
    }
    if (OPENS.some((one) => one === name)) this.reopen();
  }

  private readonly tell: Tell = (name, detail) => {
    this.dispatchEvent(new CustomEvent(name, { detail }));
  };

  private close(): void {
    this.open?.abort();
    this.gazing?.abort();
    this.open = null;
    this.viewing = null;
  }

  /** Opens what the attributes say, once however many of them changed. */
  private reopen(): void {
    if (this.opening) return;
    this.opening = true;
    queueMicrotask(() => {
      this.opening = false;
      this.close();
      if (this.isConnected && this.hasAttribute("src")) void this.begin();
    });
  }

  private async begin(): Promise<void> {
    const open = new AbortController();
    const { signal } = open;
    this.open = open;
    const { shell, overlay, tell } = this;
    const refused: string[] = [];
    const refuse = (sentence: string): number => refused.push(sentence);
    const view = viewOf((name) => this.getAttribute(name), refuse);
    const detail = detailOf((name) => this.getAttribute(name), refuse);
    shell.showProblem(null);
    shell.bar.hidden = this.hasAttribute("bare");
    shell.showNote(null);
    shell.showPoster(this.getAttribute("poster"));
    this.name();
    keepLaid(shell.stage, () => this.pack, signal);
    const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
    const options = { ...this.options(this.hasAttribute("paused") || calm), ...detail, view };
    try {
      const engine = await Engine.open(shell.stage, options);
      if (signal.aborted) {
        engine.close();
        return;
      }
      const settings = {
        paused: options.paused === true,
        muted: this.hasAttribute("muted"),
        policy: firstPolicy(options, engine.pack),
      };
      const around = { host: this, shell, overlay, tell, signal };
      this.viewing = new Viewing(engine, around, settings);
      if (refused.length > 0) shell.say(refused.join(" "), "seen");
      const inScene = engine.pack.kind === "scene";
      watchInput({ stage: shell.stage, host: this, inScene }, this.viewing, signal);
      engine.on("error", (problem) => {
        if (problem.fatal && !signal.aborted) this.fail(problem);
      });
      this.followGaze();
    } catch (thrown) {
      if (!signal.aborted) this.fail(thrown);
    }
  }

  private options(paused: boolean): EngineOptions {
    const policy = this.policyOf(this.getAttribute("policy"));
    return {
      src: this.getAttribute("src") ?? "",
      demo: this.hasAttribute("demo"),
      // Any value there asks for privacy.
      privacy: ["tiles", null].includes(this.getAttribute("privacy")) ? "tiles" : "coarse",
      size: deviceSize(this.shell.stage),
      paused,
      once: this.hasAttribute("once"),
      ...(policy === undefined ? {} : { policy }),
    };
  }

  /** Says why nothing is shown. */
  private fail(thrown: unknown): void {
    const problem = problemOf(thrown);
    this.viewing = null;
    // Nothing is there to be played.
    this.shell.bar.hidden = true;
    this.shell.showProblem(problem.message, () => this.reopen());
    this.tell("problem", problem);
  }

  private followGaze(): void {
    this.gazing?.abort();
    this.gazing = null;
    const address = this.getAttribute("gaze");
    if (address === null || this.viewing === null) return;
    this.gazing = new AbortController();
    try {
      this.viewing.follow(address, this.gazing.signal);
    } catch (error) {
      this.shell.say(problemOf(error).message, "seen");
    }
  }

  private setPolicy(value: string | null): void {
    const policy = this.policyOf(value);
    if (policy !== undefined) this.viewing?.setPolicy(policy);
  }

  /** Chooses for the score that the attributes say; says so where that is none. */
  private setTarget(): void {
    const refuse = (sentence: string): void => this.shell.say(sentence, "seen");
    const { target, slope } = detailOf((name) => this.getAttribute(name), refuse);
    if (slope === undefined) this.viewing?.setTarget(target);
    // Without a target next to it, a slope counts again.
    else this.reopen();
  }

  /** The policy of a name; says so where there is none. */
  private policyOf(value: string | null): PolicyName | undefined {
    const policy = POLICIES.find((name) => name === value);
    if (policy === undefined && value !== null) {
      this.shell.say(`There is no policy ${value}; there are ${POLICIES.join(", ")}.`, "seen");
    }
    return policy;
  }

  private name(): void {
    const file = (this.getAttribute("src") ?? "").split("/").pop() ?? "";
    const label = this.getAttribute("label") ?? (file.replace(/\.foveal$/, "") || "Video");
    this.shell.stage.setAttribute("aria-label", `${label}. Arrow keys look around; H lists keys.`);
  }

  /** Connects buttons and the slider with what they do. */
  private wire(): void {
    const { buttons, seek } = this.shell;
    for (const name of ["play", "figures", "fullscreen", "keys"] as const) {
      buttons[name].addEventListener("click", () => {
        this.viewing?.gesture();
        this.viewing?.toggle(name);
      });
    }
    buttons.sound.addEventListener("click", () => this.viewing?.toggle("sound"));
    buttons.demo.addEventListener("click", () => this.viewing?.toggleDemo());
    buttons.sensor.addEventListener("click", () => void this.viewing?.toggleSensor());
    buttons.headset.addEventListener("click", () => void this.viewing?.enterHeadset());
    seek.addEventListener("input", () => this.viewing?.seek(seek.valueAsNumber));
  }
}

/** Typed listening, as with the events of other elements. */
export interface FovealView {
  addEventListener<K extends keyof FovealViewEvents>(
    name: K,
    heard: (event: CustomEvent<FovealViewEvents[K]>) => void,
    options?: boolean | AddEventListenerOptions,
  ): void;
  addEventListener(
    name: string,
    heard: EventListenerOrEventListenerObject,
    options?: boolean | AddEventListenerOptions,
  ): void;
}

declare global {
  interface HTMLElementTagNameMap {
    "foveal-view": FovealView;
  }
}

/** Makes <foveal-view> known to this page; harmless when it is. */
export function defineFovealView(): void {
  if (customElements.get("foveal-view") === undefined) {
    customElements.define("foveal-view", FovealView);
  }
}
