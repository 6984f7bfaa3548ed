/** Poses of what deforms: the moments of a file's animations of skins and morph targets. */

import type { Viewer } from "../rebounce_radiosity.js";
import { number, wrong } from "../wire/check.js";
import { listed } from "./nodes.js";

/** Place of an animation in the file's list, and seconds. */
export type Pose = [animation: number, time: number];

/** At rest. */
export const REST: Pose = [-1, 0];

/** Names of the animations that deform something, in their order. */
export const posesIn = (viewer: Viewer): string[] => listed(viewer.poseNames());

/** The pose of a shot: its animation by name or number, the first one without. Throws `bad-json` for one that the file has not. */
export function poseOf(viewer: Viewer, animation?: string, time?: number): Pose {
  if (animation === undefined && time === undefined) return REST;
  const names = posesIn(viewer);
  if (!names.length) throw wrong(animation === undefined ? "time" : "animation", "nothing of this file deforms");
  const seconds = number("time", time, 0);
  if (animation === undefined) return [0, seconds];
  const named = names.indexOf(String(animation));
  const place = named < 0 && names[Number(animation)] !== undefined ? Number(animation) : named;
  if (place < 0) throw wrong("animation", `no animation “${animation}” deforms anything; there are ${names.join(", ")}`);
  return [place, seconds];
}
