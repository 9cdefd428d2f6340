// Which parts does the element have on the page?

import type { PackFacts } from "../engine/api.ts";
import type { KeyRow } from "./actions.ts";
import { element, icon } from "./dom.ts";
import { KEYS } from "./keys.ts";
import { STYLE } from "./style.ts";
import { clock, spokenTime } from "./words.ts";

/** Outlines of the buttons' drawings. */
const ICONS = {
  play: "M8 5l11 7-11 7z",
  pause: "M8 5v14M16 5v14",
  sound: "M4 9v6h4l5 4V5L8 9zM17 9a4 4 0 0 1 0 6",
  silent: "M4 9v6h4l5 4V5L8 9zM17 10l4 4M21 10l-4 4",
  figures: "M5 20v-6M12 20V5M19 20V10",
  demo: "M2 12s4-7 10-7 10 7 10 7-4 7-10 7-10-7-10-7zM12 9a3 3 0 1 1 0 6a3 3 0 0 1 0-6z",
  sensor: "M12 3v5M12 16v5M3 12h5M16 12h5M12 12h.01",
  headset: "M3 8h18v9h-5l-2-3h-4l-2 3H3z",
  fullscreen: "M4 9V4h5M15 4h5v5M20 15v5h-5M9 20H4v-5",
  keys: "M9 9a3 3 0 1 1 4 3c-1 .5-1 1-1 2M12 18h.01",
} as const;

/** What can be pressed. */
export type ButtonName = keyof typeof LABELS;

const LABELS = {
  play: "Play",
  sound: "Sound",
  figures: "Figures",
  demo: "Demo: your pointer acts as your gaze",
  sensor: "Turn by moving the device",
  headset: "Enter the headset",
  fullscreen: "Full screen",
  keys: "Keys",
} as const;

const BUTTONS = Object.keys(LABELS) as readonly ButtonName[];

/** The parts of one element. */
export class Shell {
  readonly stage = element("div", { class: "stage", tabindex: 0, role: "application" });
  readonly seek = element("input", { type: "range", min: 0, max: 0, step: "any", value: 0 });
  readonly time = element("span", { class: "time", "aria-hidden": "true" }, "0:00");
  readonly bar = element("div", { class: "bar", role: "group", "aria-label": "Playback" });
  readonly buttons: Readonly<Record<ButtonName, HTMLButtonElement>>;
  private readonly status = element("p", { class: "status quiet", role: "status" });
  private readonly problem = element("div", { class: "problem", role: "alert", hidden: true });
  private readonly note = element("div", { class: "note", role: "note", hidden: true });
  private readonly keys: HTMLDialogElement;
  private readonly keyRows = element("table");
  private readonly poster = element("img", { class: "poster", alt: "", hidden: true });
  private clearing = 0;

  constructor(root: ShadowRoot, figures: HTMLElement) {
    const sheet = new CSSStyleSheet();
    sheet.replaceSync(STYLE);
    root.adoptedStyleSheets = [sheet];
    const make = (name: ButtonName): [ButtonName, HTMLButtonElement] => [
      name,
      element("button", { type: "button", title: LABELS[name], "aria-label": LABELS[name] }),
    ];
    this.buttons = Object.fromEntries(BUTTONS.map(make)) as Record<ButtonName, HTMLButtonElement>;
    for (const name of BUTTONS) this.buttons[name].append(icon(ICONS[name]));
    this.seek.setAttribute("aria-label", "Time");
    const { play, ...others } = this.buttons;
    this.bar.append(play, this.seek, this.time, ...Object.values(others));
    for (const name of ["sensor", "headset", "sound"] as const) this.buttons[name].hidden = true;
    for (const name of ["figures", "demo", "sensor"] as const) this.press(name, false);
    this.keys = keysDialog(this.keyRows);
    this.stage.append(this.poster);
    const over = element("div", { class: "over" });
    over.append(figures, this.status, this.problem);
    const picture = element("div", { class: "picture" });
    picture.append(this.stage, over);
    root.append(picture, element("div", {}, this.note, this.bar), this.keys);
  }

  /** Says something to those who see and those who listen; `seen` ones stay for some seconds. */
  say(text: string, seen: "seen" | "heard"): void {
    window.clearTimeout(this.clearing);
    this.status.classList.toggle("quiet", seen === "heard");
    this.status.textContent = text;
    this.clearing = window.setTimeout(() => {
      this.status.textContent = "";
    }, 6000);
  }

  /** Says why nothing can be shown, with a way on; null when something can. */
  showProblem(text: string | null, again?: () => void): void {
    this.problem.hidden = text === null;
    this.problem.replaceChildren();
    if (text === null) return;
    this.problem.append(element("p", {}, text));
    if (again === undefined) return;
    const button = element("button", { type: "button", class: "word" }, "Try again");
    button.addEventListener("click", again, { once: true });
    this.problem.append(button);
  }

  /** A sentence under the picture that stays; null for none. */
  showNote(text: string | null): void {
    this.note.hidden = text === null;
    this.note.replaceChildren(element("p", {}, text ?? ""));
  }

  /** A picture to look at until there is one. */
  showPoster(url: string | null): void {
    this.poster.hidden = url === null;
    if (url !== null) this.poster.src = url;
  }

  /** Lists the keys that do something to this pack. */
  offerKeys(pack: PackFacts): void {
    this.keyRows.replaceChildren(...KEYS.filter((row) => does(row, pack)).map(keyRow));
  }

  /** Whether the keys are listed. */
  get showsKeys(): boolean {
    return this.keys.open;
  }

  set showsKeys(shown: boolean) {
    if (!shown) this.keys.close();
    else if (!this.keys.open) this.keys.showModal();
  }

  /** Where in the content it is. */
  showTime(seconds: number, of: number): void {
    this.time.textContent = `${clock(seconds)} / ${clock(of)}`;
    this.seek.max = String(of);
    if (!this.seek.matches(":active")) this.seek.value = String(seconds);
    this.seek.setAttribute("aria-valuetext", `${spokenTime(seconds)} of ${spokenTime(of)}`);
  }

  /** Whether there is time to go through; a still has none. */
  set showsTime(shows: boolean) {
    for (const part of [this.buttons.play, this.seek, this.time]) part.hidden = !shows;
  }

  showPlaying(playing: boolean): void {
    this.relabel("play", playing ? "Pause" : "Play", playing ? ICONS.pause : ICONS.play);
  }

  showSound(on: boolean): void {
    this.relabel("sound", on ? "Mute" : "Unmute", on ? ICONS.sound : ICONS.silent);
  }

  press(name: ButtonName, pressed: boolean): void {
    this.buttons[name].setAttribute("aria-pressed", String(pressed));
  }

  private relabel(name: ButtonName, label: string, path: string): void {
    const button = this.buttons[name];
    button.title = label;
    button.setAttribute("aria-label", label);
    button.replaceChildren(icon(path));
  }
}

/** Whether the keys of a row do something to a pack. */
function does({ needs }: KeyRow, pack: PackFacts): boolean {
  switch (needs) {
    case "frames":
      return pack.frames > 1;
    case "heard":
      return pack.hasSound;
    case "atlas":
      return pack.kind === "video" && pack.drawing === "gpu";
    case "scene":
      return pack.kind === "scene";
    case "nothing":
      return true;
  }
}

function keyRow({ shown, says }: KeyRow): HTMLElement {
  const keys = shown.split("  ").flatMap((key) => [element("kbd", {}, key), " "]);
  return element("tr", {}, element("th", { scope: "row" }, ...keys), element("td", {}, says));
}

function keysDialog(rows: HTMLTableElement): HTMLDialogElement {
  const close = element("button", { type: "button", class: "word" }, "Close");
  const dialog = element(
    "dialog",
    { class: "keys", "aria-label": "Keys" },
    rows,
    close,
  );
  close.addEventListener("click", () => dialog.close());
  return dialog;
}
