// Which figures are shown over the picture?

import { type PackFacts, POLICIES, type PolicyName, type Stats } from "../engine/api.ts";
import { element } from "./dom.ts";
import { bytes, percent, rate } from "./words.ts";

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

  constructor(choices: OverlayChoices) {
    const rows = element("dl");
    for (const [name, title] of FIGURES) {
      const value = element("dd", {}, "–");
      this.values.set(name, value);
      rows.append(element("dt", {}, title), value);
    }
    this.policies.addEventListener("change", () => {
      const chosen = POLICIES.find((name) => name === this.policies.value);
      if (chosen !== undefined) choices.policy(chosen);
    });
    this.heat.addEventListener("change", () => choices.levels(this.heat.checked));
    this.panel = element(
      "section",
      { class: "figures", "aria-label": "Figures", hidden: true },
      rows,
      element("label", {}, "Policy ", this.policies),
      element("label", {}, this.heat, " Colour tiles by level"),
    );
  }

  /** Offers the policies that this pack has the tables for. */
  offer(pack: PackFacts): void {
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

const FIGURES: readonly (readonly [string, string, (stats: Stats) => string])[] = [
  ["share", "pixels shown of all", (s) => percent(s.share)],
  ["levels", "tiles, finest first", (s) => s.levels.slice(0, LEVELS).join(" · ")],
  ["bytes", "fetched", (s) => `${bytes(s.bytesFetched)}, ${s.requests} requests`],
  ["throughput", "throughput", (s) => (s.throughput > 0 ? rate(s.throughput) : "–")],
  ["decode", "decoding a tile", (s) => `${s.decodeMs.toFixed(1)} ms`],
  ["frame", "a picture", (s) => `${s.frameMs.toFixed(1)} ms`],
  ["frames", "pictures: late, left out", (s) => `${s.framesLate}, ${s.framesLeftOut}`],
  ["memory", "memory: bytes, GPU", (s) => `${bytes(s.cachedBytes)}, ${bytes(s.gpuBytes)}`],
  ["zoom", "zoom", (s) => `${s.zoom.toFixed(1)} ×, ${s.settled ? "all sharp" : "getting sharp"}`],
];
