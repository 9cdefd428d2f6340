// How is the head turned by a device that is held before the eyes?

import type { Pose } from "../engine/api.ts";

/** Whether this device reports how it is held. */
export function hasOrientation(): boolean {
  return "DeviceOrientationEvent" in window && matchMedia("(pointer: coarse)").matches;
}

/** Some systems ask the person first, and only after a touch. */
interface Asking {
  requestPermission?: () => Promise<"granted" | "denied">;
}

/** Follows the device until the signal ends it. Yaw counts from how it is held at first. Rejects
 *  with a sentence for people where that is not allowed. */
export async function followDevice(
  turn: (pose: Pose | null) => void,
  signal: AbortSignal,
): Promise<void> {
  const asking: Asking = DeviceOrientationEvent as unknown as Asking;
  const answer = await (asking.requestPermission?.() ?? Promise.resolve("granted"));
  if (answer !== "granted") {
    throw new Error("The browser does not report how the device is held: allow this page motion.");
  }
  let first: number | null = null;
  const heard = (event: DeviceOrientationEvent): void => {
    const { alpha, beta, gamma } = event;
    if (alpha === null || beta === null || gamma === null) return;
    const pose = poseOf(alpha, beta, gamma, screen.orientation.angle);
    first ??= pose.yawDeg;
    turn({ ...pose, yawDeg: pose.yawDeg - first });
  };
  window.addEventListener("deviceorientation", heard, { signal });
  signal.addEventListener("abort", () => turn(null), { once: true });
}

const DEGREE = Math.PI / 180;

/** Where the back of a device looks, whose angles are as W3C's Device Orientation has them
 *  (intrinsic turns about z, x, y from lying flat) on a screen that is turned by `angle`. */
export function poseOf(alpha: number, beta: number, gamma: number, angle: number): Required<Pose> {
  const [a, b, c] = [alpha * DEGREE, beta * DEGREE, gamma * DEGREE];
  const [sa, ca, sb, cb, sc, cc] = [a, b, c].flatMap((x) => [Math.sin(x), Math.cos(x)]) as [
    number,
    number,
    number,
    number,
    number,
    number,
  ];
  // Columns of the turn: the device's right, top and face in east, north, up.
  const right: Vector = [ca * cc - sa * sb * sc, cc * sa + ca * sb * sc, -cb * sc];
  const top: Vector = [-cb * sa, ca * cb, sb];
  const face: Vector = [cc * sa * sb + ca * sc, sa * sc - ca * cc * sb, cb * cc];
  const s = Math.sin(angle * DEGREE);
  const k = Math.cos(angle * DEGREE);
  const across = mixed(right, k, top, -s);
  const up = mixed(right, s, top, k);
  const [x, y, z] = [-face[0], -face[1], -face[2]];
  return {
    yawDeg: Math.atan2(x, y) / DEGREE,
    pitchDeg: Math.asin(Math.max(-1, Math.min(1, z))) / DEGREE,
    rollDeg: Math.atan2(-across[2], up[2]) / DEGREE,
  };
}

type Vector = readonly [number, number, number];

function mixed(a: Vector, k: number, b: Vector, l: number): Vector {
  return [a[0] * k + b[0] * l, a[1] * k + b[1] * l, a[2] * k + b[2] * l];
}
