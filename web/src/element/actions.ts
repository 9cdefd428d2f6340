// What can a viewer do to what is shown, by hand, key or menu?

/** Everything that input leads to; places are in CSS pixels of the stage. */
export interface Actions {
  /** The first touch, click or key: from now on the page may make sound. */
  gesture(): void;
  drag(dx: number, dy: number): void;
  zoom(factor: number, place: readonly [number, number] | null): void;
  reset(): void;
  pointer(place: readonly [number, number] | null): void;
  toggle(what: Toggle): void;
  /** Seconds from where it is. */
  skip(seconds: number): void;
  step(frames: number): void;
  /** To the beginning (0) or to the end (1). */
  seekShare(share: number): void;
}

/** What is either on or off. */
export type Toggle = "play" | "sound" | "figures" | "levels" | "fullscreen" | "keys";

/** Part of the stage's width that an arrow key turns. */
const TURN = 1 / 16;
/** A key's zoom. */
const CLOSER = 1.25;
/** What a key skips, in seconds. */
const SKIP = 5;

/** What a key does to a stage of this size; null where it does nothing. */
export function actionOfKey(
  key: string,
  withModifier: boolean,
  [width, height]: readonly [number, number],
): ((actions: Actions) => void) | null {
  const turn = (right: number, down: number) => (actions: Actions) => {
    actions.drag(-right * width * TURN, -down * height * TURN);
  };
  switch (key) {
    case "ArrowLeft":
      return withModifier ? (a) => a.skip(-SKIP) : turn(-1, 0);
    case "ArrowRight":
      return withModifier ? (a) => a.skip(SKIP) : turn(1, 0);
    case "ArrowUp":
      return turn(0, -1);
    case "ArrowDown":
      return turn(0, 1);
    case "+":
    case "=":
      return (a) => a.zoom(CLOSER, null);
    case "-":
    case "_":
      return (a) => a.zoom(1 / CLOSER, null);
    case "0":
      return (a) => a.reset();
    case ",":
      return (a) => a.step(-1);
    case ".":
      return (a) => a.step(1);
    case "Home":
      return (a) => a.seekShare(0);
    case "End":
      return (a) => a.seekShare(1);
    default:
      return toggleOfKey(key.toLowerCase());
  }
}

function toggleOfKey(key: string): ((actions: Actions) => void) | null {
  const toggles: Readonly<Record<string, Toggle>> = {
    " ": "play",
    m: "sound",
    o: "figures",
    l: "levels",
    f: "fullscreen",
    "?": "keys",
  };
  const what = toggles[key];
  return what === undefined ? null : (actions) => actions.toggle(what);
}

/** What the keys do, for people. */
export const KEYS: readonly (readonly [string, string])[] = [
  ["Arrow keys", "look around"],
  ["+  −  0", "closer, farther, back to the start"],
  ["Space", "play or pause"],
  ["Shift + ← →", "5 seconds back or on"],
  [",  .", "one picture back or on"],
  ["Home  End", "to the beginning or the end"],
  ["M", "sound"],
  ["O  L", "figures, levels in colour"],
  ["F", "full screen"],
];
