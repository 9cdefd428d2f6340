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
  /** What says something of some packs only. */
  private readonly ofSome: { readonly part: HTMLElement; readonly of: Of }[] = [];

  constructor(choices: OverlayChoices) {
    const rows = element("dl");
    for (const [name, title] of FIGURES) {
      const value = element("dd", { title }, "–");
      const term = element("dt", { title }, name);
      this.values.set(name, value);
      rows.append(term, value);
      const of = OF_SOME.get(name);
      if (of !== undefined) this.ofSome.push({ part: term, of }, { part: value, of });
    }
    const late = element("p", {}, LATE);
    this.ofSome.push({ part: late, of: "frames" });
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
      element("label", {}, this.heat, " Colour by level"),
    );
  }

  /** Offers the policies that this pack has the tables for, and the figures that it has. */
  offer(pack: PackFacts): void {
    const [frames, scene] = [pack.frames > 1, pack.kind === "scene"];
    const has = { frames, tiles: !scene, scene };
    for (const { part, of } of this.ofSome) part.hidden = !has[of];
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

/** Which packs have a figure: those with frames in time, of tiles, or of scenes. */
type Of = "frames" | "tiles" | "scene";

const OF_SOME: ReadonlyMap<string, Of> = new Map([
  ["late pictures", "frames"],
  ["left-out pictures", "frames"],
  ["pixels shown", "tiles"],
  ["tiles, finest first", "tiles"],
  ["decoding a tile", "tiles"],
  ["zoom", "tiles"],
  ["detail shown", "scene"],
  ["units, finest first", "scene"],
  ["sharpness", "scene"],
]);

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
    "detail shown",
    "Of all triangles and points of the finest level",
    (s) => `${percent(s.share)}, ${s.trianglesDrawn.toLocaleString("en")} triangles drawn`,
  ],
  [
    "units, finest first",
    "Units on screen of each level",
    (s) => s.levels.join(" · "),
  ],
  ["sharpness", "Whether all that is wanted is shown", (s) => sharpness(s)],
  [
    "fetched",
    "What the host sent since the page was opened",
    (s) => `${bytes(s.bytesFetched)}, ${s.requests} ${s.requests === 1 ? "request" : "requests"}`,
  ],
  [
    "throughput",
    "Recent delivery of the link while anything was on its way",
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
    "Of the pack in memory, and of what is shown on the graphics device",
    (s) => `${bytes(s.cachedBytes)}, ${bytes(s.gpuBytes)}`,
  ],
  ["drawn by", "The graphics device, or the processor", (s) => s.drawing],
  [
    "zoom",
    "Closer than at the beginning",
    (s) => `${s.zoom.toFixed(1)} ×, ${sharpness(s)}`,
  ],
];

function sharpness({ settled }: Stats): string {
  return settled ? "all sharp" : "getting sharp";
}
