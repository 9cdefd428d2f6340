import { expect, test } from "vitest";
import { eyeOf } from "./xr.ts";

/** A projection by WebXR's own formula from tangents to the four edges. */
function projection(left: number, right: number, up: number, down: number): Float32Array {
  const m = new Float32Array(16);
  m[0] = 2 / (left + right);
  m[5] = 2 / (up + down);
  m[8] = (right - left) / (left + right);
  m[9] = (up - down) / (up + down);
  m[11] = -1;
  return m;
}

test("an eye is where its view is, with the tangents that its projection was made of", () => {
  const view = {
    eye: "right",
    projectionMatrix: projection(0.8, 1.1, 0.9, 1.2),
    transform: {
      orientation: { x: 0, y: 0.6, z: 0, w: 0.8 },
      position: { x: 0.1, y: 1.6, z: -0.2, w: 1 },
    },
  } as unknown as XRView;
  const request = eyeOf(view, [300, 200]);
  expect(request.eye).toBe("right");
  expect(request.position).toEqual([0.1, 1.6, -0.2]);
  expect(request.orientation).toEqual([0, 0.6, 0, 0.8]);
  request.tangents.forEach((tangent, at) => {
    expect(tangent).toBeCloseTo([0.8, 1.1, 0.9, 1.2][at] ?? 0, 5);
  });
});
