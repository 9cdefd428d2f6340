// How does the picture get into a headset?
//
// For each eye the engine draws into its canvas, and what comes of it is blitted into the headset's
// layer, all within one callback of the headset.

import type { EngineApi, EyeRequest } from "../engine/api.ts";
import type { XrTarget } from "./xr-target.ts";
import { WebGlTarget } from "./xr-webgl.ts";

/** Whether there is a headset to enter. */
export async function hasHeadset(): Promise<boolean> {
  return (await navigator.xr?.isSessionSupported("immersive-vr").catch(() => false)) === true;
}

/** Enters the headset; call it in a click. `entered` hears of the first picture that all its views
 *  got; the promise settles when the viewer is out again. */
export async function enterHeadset(engine: EngineApi, entered: () => void): Promise<void> {
  const { xr } = navigator;
  if (xr === undefined) throw new Error("This browser has no WebXR.");
  const session = await xr.requestSession("immersive-vr", { optionalFeatures: ["local"] });
  const thread = engine.thread;
  try {
    const over = new Promise<void>((resolve) => {
      session.addEventListener("end", () => resolve(), { once: true });
    });
    await engine.toThread("main");
    const target: XrTarget = await WebGlTarget.in(session);
    const space = await session
      .requestReferenceSpace("local")
      .catch(() => session.requestReferenceSpace("viewer"));
    let seen = false;
    const frame = (_time: number, now: XRFrame): void => {
      session.requestAnimationFrame(frame);
      const views = now.getViewerPose(space)?.views ?? [];
      const all = draw(engine, target, views) === views.length && views.length > 0;
      if (all && !seen) entered();
      seen ||= all;
    };
    session.requestAnimationFrame(frame);
    await over;
  } finally {
    await session.end().catch(() => undefined);
    await engine.toThread(thread);
  }
}

/** Draws all views; returns how many got a picture. */
function draw(engine: EngineApi, target: XrTarget, views: readonly XRView[]): number {
  let eyes = 0;
  target.begin();
  for (const view of views) {
    const size = target.sizeOf(view);
    const picture = size === null ? null : engine.drawEye(eyeOf(view, size));
    if (picture === null) continue;
    target.show(view, picture);
    picture.close();
    eyes += 1;
  }
  target.end();
  return eyes;
}

/** What an engine is asked to draw for a view. */
export function eyeOf(view: XRView, size: readonly [number, number]): EyeRequest {
  const { orientation: { x, y, z, w }, position } = view.transform;
  const m = view.projectionMatrix;
  const [scaleX = 1, scaleY = 1, shiftX = 0, shiftY = 0] = [m[0], m[5], m[8], m[9]];
  return {
    eye: view.eye === "right" ? "right" : "left",
    position: [position.x, position.y, position.z],
    orientation: [x, y, z, w],
    tangents: [
      (1 - shiftX) / scaleX,
      (1 + shiftX) / scaleX,
      (1 + shiftY) / scaleY,
      (1 - shiftY) / scaleY,
    ],
    size,
  };
}
