// What can a viewer do to what is shown, by hand, key or menu?

import type { Towards } from "../engine/api.ts";
import { KEYS } from "./keys.ts";

/** Everything that input leads to; places are in CSS pixels of the stage. */
export interface Actions {
  /** The first touch, click or key: from now on the page may make sound. */
  gesture(): void;
  drag(dx: number, dy: number): void;
  /** Flies through a scene, or no longer flies, to the right, up and ahead. */
  fly(towards: Towards, isHeld: boolean, isHurried: boolean): void;
  /** Stays where it is in a scene. */
  stopFlying(): void;
  zoom(factor: number, place: readonly [number, number] | null): void;
  reset(): void;
  pointer(place: readonly [number, number] | null): void;
  toggle(what: Toggle): void;
  /** Seconds from where it is. */
  skip(seconds: number): void;
  step(frames: number): void;
  /** To the beginning (0) or to the end (1). */
  seekShare(share: number): void;
  /** So many policies on, or back. */
  nextPolicy(by: number): void;
  /** So many target scores on, or back. */
  nextTarget(by: number): void;
}

/** What is either on or off; `overlay` goes from the keys to the figures to nothing. */
export type Toggle =
  | "play"
  | "sound"
  | "figures"
  | "levels"
  | "fullscreen"
  | "keys"
  | "overlay";

/** A line of the table of keys. */
export type KeyRow = (typeof KEYS)[number];

type Deed = KeyRow["keys"][number];

/** A key that is pressed or let go. */
export interface Pressed {
  readonly key: string;
  readonly shiftKey: boolean;
}

/** What a pressed key does to a stage of this width; null where it does nothing. */
export function actionOfKey(
  pressed: Pressed,
  inScene: boolean,
  width: number,
): ((actions: Actions) => void) | null {
  const deed = deedIn(inScene, pressed);
  return deed === null ? null : (actions) => perform(deed, actions, { ...pressed, width });
}

/** What a key that is let go ends; null where it ends nothing. */
export function endOfKey(pressed: Pressed, inScene: boolean): ((actions: Actions) => void) | null {
  const deed = deedIn(inScene, pressed);
  if (deed?.does !== "fly") return null;
  return (actions) => actions.fly(deed.by, false, pressed.shiftKey);
}

/** As `action_of` and `action_in_scene` of crates/core/src/view/keys.rs. */
function deedIn(inScene: boolean, pressed: Pressed): Deed | null {
  const own = inScene ? deedOf(pressed, (row) => row.needs === "scene") : null;
  return own ?? deedOf(pressed, (row) => row.needs !== "scene");
}

function deedOf({ key, shiftKey }: Pressed, counts: (row: KeyRow) => boolean): Deed | null {
  const name = key.length === 1 ? key.toLowerCase() : key;
  const rows: readonly KeyRow[] = KEYS.filter(counts);
  const deeds: readonly Deed[] = rows.flatMap((row): readonly Deed[] => row.keys);
  const find = (wanted: string): Deed | undefined => deeds.find((deed) => deed.key === wanted);
  return (shiftKey ? find(`Shift+${name}`) : undefined) ?? find(name) ?? null;
}

/** How a deed is done: by a key with Shift or without, on a stage of this width. */
interface Done {
  readonly shiftKey: boolean;
  readonly width: number;
}

function perform(deed: Deed, actions: Actions, { shiftKey, width }: Done): void {
  switch (deed.does) {
    case "pause":
      return actions.toggle("play");
    case "skip":
      return actions.skip(deed.by);
    case "step":
      return actions.step(deed.by);
    case "first":
      return actions.seekShare(0);
    case "last":
      return actions.seekShare(1);
    case "move":
      return actions.drag(deed.by[0] * width, deed.by[1] * width);
    case "fly":
      return actions.fly(deed.by, true, shiftKey);
    case "zoom":
      return actions.zoom(deed.by, null);
    case "reset":
      return actions.reset();
    case "policy":
      return actions.nextPolicy(deed.by);
    case "target":
      return actions.nextTarget(deed.by);
    case "fullScreen":
      return actions.toggle("fullscreen");
    case "sound":
    case "levels":
    case "figures":
    case "overlay":
      return actions.toggle(deed.does);
    default:
      // A key that is added to the table is answered here, or nothing compiles.
      return deed satisfies never;
  }
}
