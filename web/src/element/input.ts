// How do pointers, wheels and keys on the stage become actions?

import { type Actions, actionOfKey, endOfKey } from "./actions.ts";

/** How much closer a wheel brings for each pixel that it would have scrolled. */
const WHEEL = 0.0015;
/** Pixels that a line and a page of a wheel stand for. */
const LINE = 16;
const PAGE = 400;

type Place = readonly [number, number];

/** No direction to fly in: only how fast changes. */
const NOWHERE = [0, 0, 0] as const;

/** Where input comes from. */
export interface Heard {
  readonly stage: HTMLElement;
  /** Holds the stage, and hears the keys. */
  readonly host: HTMLElement;
  /** Whether the stage shows a scene. */
  readonly inScene: boolean;
}

/** Watches a stage until the signal ends it. */
export function watchInput(heard: Heard, actions: Actions, signal: AbortSignal): void {
  const { stage, host, inScene } = heard;
  new Pointers(stage, actions).watch(signal);
  const wheel = (event: WheelEvent): void => {
    event.preventDefault();
    const unit = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? LINE : PAGE;
    const pixels = event.deltaY * (event.deltaMode === WheelEvent.DOM_DELTA_PIXEL ? 1 : unit);
    const factor = Math.exp(-Math.max(-PAGE, Math.min(PAGE, pixels)) * WHEEL);
    actions.zoom(factor, placeOn(stage, event));
  };
  stage.addEventListener("wheel", wheel, { passive: false, signal });
  const key = (event: KeyboardEvent): void => {
    if (event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey) return;
    if (isOfControl(event)) return;
    if (inScene && event.key === "Shift") return actions.fly(NOWHERE, false, true);
    const action = actionOfKey(event, inScene, stage.clientWidth);
    if (action === null) return;
    event.preventDefault();
    actions.gesture();
    action(actions);
  };
  host.addEventListener("keydown", key, { signal });
  if (!inScene) return;
  const letGo = (event: KeyboardEvent): void => {
    if (event.key === "Shift") actions.fly(NOWHERE, false, false);
    else endOfKey(event, inScene)?.(actions);
  };
  host.addEventListener("keyup", letGo, { signal });
  // A key that is let go elsewhere is not heard of.
  for (const name of ["focusout", "contextmenu"] as const) {
    host.addEventListener(name, () => actions.stopFlying(), { signal });
  }
}

/** Whether a key belongs to the control that has the focus. */
function isOfControl(event: KeyboardEvent): boolean {
  const [target] = event.composedPath();
  if (target instanceof HTMLInputElement) {
    return target.type !== "range" || /^(Arrow|Home|End|Page)/.test(event.key);
  }
  if (target instanceof HTMLSelectElement) return true;
  const pressed = event.key === " " || event.key === "Enter";
  return target instanceof HTMLButtonElement && pressed;
}

function placeOn(stage: HTMLElement, event: MouseEvent): Place {
  const { left, top } = stage.getBoundingClientRect();
  return [event.clientX - left, event.clientY - top];
}

/** Fingers and mice that are down: one drags, two pinch. */
class Pointers {
  private readonly down = new Map<number, Place>();

  constructor(
    private readonly stage: HTMLElement,
    private readonly actions: Actions,
  ) {}

  watch(signal: AbortSignal): void {
    const { stage, actions } = this;
    const on = (name: "pointerdown" | "pointermove", heard: (event: PointerEvent) => void) =>
      stage.addEventListener(name, heard, { signal });
    on("pointerdown", (event) => {
      if (event.button !== 0) return;
      actions.gesture();
      stage.setPointerCapture(event.pointerId);
      this.down.set(event.pointerId, placeOn(stage, event));
      stage.classList.add("held");
    });
    on("pointermove", (event) => this.move(event));
    const up = (event: PointerEvent): void => {
      this.down.delete(event.pointerId);
      if (this.down.size === 0) stage.classList.remove("held");
      if (event.pointerType !== "mouse") actions.pointer(null);
    };
    stage.addEventListener("pointerup", up, { signal });
    stage.addEventListener("pointercancel", up, { signal });
    stage.addEventListener("pointerleave", () => actions.pointer(null), { signal });
  }

  private move(event: PointerEvent): void {
    const place = placeOn(this.stage, event);
    const before = this.down.get(event.pointerId);
    this.actions.pointer(place);
    if (before === undefined) return;
    const others = [...this.down].filter(([id]) => id !== event.pointerId);
    this.down.set(event.pointerId, place);
    const other = others[0]?.[1];
    if (other === undefined) {
      this.actions.drag(place[0] - before[0], place[1] - before[1]);
      return;
    }
    const middle = halfway(place, other);
    const was = halfway(before, other);
    this.actions.drag(middle[0] - was[0], middle[1] - was[1]);
    const [apart, wasApart] = [between(place, other), between(before, other)];
    if (apart > 1 && wasApart > 1) this.actions.zoom(apart / wasApart, middle);
  }
}

function halfway(a: Place, b: Place): Place {
  return [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
}

function between(a: Place, b: Place): number {
  return Math.hypot(a[0] - b[0], a[1] - b[1]);
}
