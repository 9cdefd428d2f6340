import { expect, test } from "vitest";
import { poseOf } from "./orientation.ts";

const near = (pose: ReturnType<typeof poseOf>, yaw: number, pitch: number, roll: number): void => {
  expect(pose.yawDeg).toBeCloseTo(yaw, 6);
  expect(pose.pitchDeg).toBeCloseTo(pitch, 6);
  expect(pose.rollDeg).toBeCloseTo(roll, 6);
};

test("a device held upright looks ahead, level", () => {
  near(poseOf(0, 90, 0, 0), 0, 0, 0);
});

test("turning it to the right turns the head to the right", () => {
  near(poseOf(-30, 90, 0, 0), 30, 0, 0);
});

test("tipping its top towards the viewer looks up, away looks down", () => {
  near(poseOf(0, 110, 0, 0), 0, 20, 0);
  near(poseOf(0, 70, 0, 0), 0, -20, 0);
});

test("held on its side, with the screen turned along, it looks the same way", () => {
  const upright = poseOf(0, 90, 0, 0);
  // Turned a quarter to the left: its right edge is on top, the screen is at 90 degrees.
  const sideways = poseOf(90, 0, -90, 90);
  near(sideways, upright.yawDeg, upright.pitchDeg, upright.rollDeg);
});
