// Where does a picture lie on a stage of another size?
//
// From the moment the stage changes until the next picture is drawn, the one before is laid so that
// what it shows is where the next one will show it: it keeps its proportions, and the pointer is
// over what it points at.

import type { PackFacts } from "../engine/api.ts";

type Size = readonly [number, number];

/** What a pack says of how large it is shown. */
export type Content = Pick<PackFacts, "projection" | "size">;

/** The transform that lays a picture of `drawn` pixels, from the left top, on a stage. */
export function laid(content: Content, drawn: Size, stage: Size): string {
  const [width, height] = drawn;
  // The same shape but for whole pixels: it covers the stage.
  const isSame = Math.abs((width * stage[1]) / stage[0] - height) <= 1;
  const scale = reach(content, stage) / reach(content, drawn);
  const [x, y] = isSame ? [stage[0] / width, stage[1] / height] : [scale, scale];
  const [left, top] = [(stage[0] - x * width) / 2, (stage[1] - y * height) / 2];
  return `translate(${left.toFixed(3)}px, ${top.toFixed(3)}px) scale(${x}, ${y})`;
}

/** What a picture's scale grows with: the view of a sphere or a scene has its angle along the
 *  larger side, flat content fits in. */
function reach({ projection, size }: Content, [width, height]: Size): number {
  if (projection !== "flat") return Math.max(width, height);
  return Math.min(width / size[0], height / size[1]);
}

/** Keeps every canvas of a stage laid until the signal ends it. */
export function keepLaid(
  stage: HTMLElement,
  content: () => Content | null,
  signal: AbortSignal,
): void {
  const canvases = (): NodeListOf<HTMLCanvasElement> => stage.querySelectorAll("canvas");
  const lay = (): void => {
    // What is under a part of a pixel covers all of it; the stage cuts it off.
    const side = (css: string): number =>
      Math.ceil(Number.parseFloat(css) * devicePixelRatio - 0.01) / devicePixelRatio;
    const { width, height } = getComputedStyle(stage);
    const whole = [side(width), side(height)] as const;
    if (!(whole[0] > 0 && whole[1] > 0)) return;
    for (const canvas of canvases()) {
      const drawn = [canvas.clientWidth, canvas.clientHeight] as const;
      const of = content() ?? { projection: "flat", size: drawn };
      if (drawn[0] > 0 && drawn[1] > 0) {
        canvas.style.transform = laid(of, drawn, whole);
      }
    }
  };
  const sizes = new ResizeObserver(lay);
  const found = (): void => {
    for (const canvas of canvases()) sizes.observe(canvas);
    lay();
  };
  const canvasesCome = new MutationObserver(found);
  canvasesCome.observe(stage, { childList: true });
  sizes.observe(stage);
  found();
  signal.addEventListener("abort", () => {
    sizes.disconnect();
    canvasesCome.disconnect();
  });
}
