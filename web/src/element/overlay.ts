// Which figures are shown over the picture?

import { type PackFacts, POLICIES, type PolicyName, type Stats } from "../engine/api.ts";
import { element } from "./dom.ts";
import { bytes, percent, rate, score } from "./words.ts";

/** What can be changed among the figures. */
export interface OverlayChoices {
  policy(name: PolicyName): void;
  levels(shown: boolean): void;
}


/** Most levels that a pack has. */
const LEVELS = 8;

/** A panel of figures, with the choice of a policy. */
export class Overlay {
  readonly panel: HTMLElement;
  private readonly policies = element("select", { "aria-label": "Policy" });
  private readonly heat = element("input", { type: "checkbox" });
  private readonly values = new Map<string, HTMLElement>();
  /** What says nothing of a picture, which is never late. */
  private readonly ofVideo: HTMLElement[] = [];

  constructor(choices: OverlayChoices) {
    const rows = element("dl");
    for (const [name, title] of FIGURES) {
      const value = element("dd", { title }, "–");
      const term = element("dt", { title }, name);
      this.values.set(name, value);
      rows.append(term, value);
      if (OF_VIDEO.has(name)) this.ofVideo.push(term, value);
    }
    const late = element("p", {}, LATE);
    this.ofVideo.push(late);
    this.policies.addEventListener("change", () => {
      const chosen = POLICIES.find((name) => name === this.policies.value);
      if (chosen !== undefined) choices.policy(chosen);
    });
    this.heat.addEventListener("change", () => choices.levels(this.heat.checked));
    this.panel = element(
      "section",
      { class: "figures", "aria-label": "Figures", hidden: true },
      rows,
      late,
      element("label", {}, "Policy ", this.policies),
      element("label", {}, this.heat, " Colour tiles by level"),
    );
  }

  /** Offers the policies that this pack has the tables for, and the figures that it has. */
  offer(pack: PackFacts): void {
    for (const part of this.ofVideo) part.hidden = pack.frames === 1;
    this.policies.replaceChildren(...pack.policies.map((name) => element("option", {}, name)));
  }

  get showsLevels(): boolean {
    return this.heat.checked;
  }

  set showsLevels(shown: boolean) {
    this.heat.checked = shown;
  }

  /** Shows the figures of the moment. */
  show(stats: Stats): void {
    if (document.activeElement !== this.policies) this.policies.value = stats.policy;
    for (const [name, , of] of FIGURES) {
      const value = this.values.get(name);
      if (value !== undefined) value.textContent = of(stats);
    }
  }
}

/** What two of the figures count, for those who do not see titles. */
const LATE =
  "A late picture came after its time. One that was left out never came: the next was due, and " +
  "time goes on. Many of either: the link or this device is slower than the video.";

const OF_VIDEO: ReadonlySet<string> = new Set(["late pictures", "left-out pictures"]);

/** Names, what they stand for, and values. */
const FIGURES: readonly (readonly [string, string, (stats: Stats) => string])[] = [
  ["policy", "By which levels are chosen", (s) => s.policy],
  [
    "score",
    "In JOD, where 10 is every finest tile: what is asked for, and what is expected of what was " +
      "chosen once all of it is shown",
    (s) => score(s.target, s.expectedScore),
  ],
  ["pixels shown", "Of all pixels of the finest level", (s) => percent(s.share)],
  [
    "tiles, finest first",
    "Tiles on screen of each level",
    (s) => s.levels.slice(0, LEVELS).join(" · "),
  ],
  [
    "fetched",
    "What the host sent since the page was opened",
    (s) => `${bytes(s.bytesFetched)}, ${s.requests} requests`,
  ],
  [
    "throughput",
    "What the link brought of late while anything was on its way",
    (s) => (s.throughput > 0 ? rate(s.throughput) : "–"),
  ],
  ["decoding a tile", "From its bytes to its pixels", (s) => `${s.decodeMs.toFixed(1)} ms`],
  ["drawing a picture", "What the page works for it", (s) => `${s.frameMs.toFixed(1)} ms`],
  [
    "late pictures",
    "Came after their time",
    (s) => `${s.framesLate} of ${s.framesShown}`,
  ],
  [
    "left-out pictures",
    "Never came: the next was due",
    (s) => `${s.framesLeftOut} of ${s.framesShown + s.framesLeftOut}`,
  ],
  [
    "memory: bytes, GPU",
    "Of the video's file in memory, and of tiles on the graphics device",
    (s) => `${bytes(s.cachedBytes)}, ${bytes(s.gpuBytes)}`,
  ],
  ["drawn by", "The graphics device, or the processor", (s) => s.drawing],
  [
    "zoom",
    "Closer than at the beginning",
    (s) => `${s.zoom.toFixed(1)} ×, ${s.settled ? "all sharp" : "getting sharp"}`,
  ],
];
