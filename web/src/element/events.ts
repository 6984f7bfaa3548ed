/** The element's events. */

import type { Camera, Channel, Light, Nodes } from "../wire/shot.js";
import type { Solver } from "../wire/stats.js";

/** Events of the element, by name. */
export interface RebounceEventMap {
  /** The file is loaded and its first frame drawn. */
  load: CustomEvent<{ url: string }>;
  /** More of the file has come; `total` and `ratio` are 0 while the length is not known. */
  progress: CustomEvent<{ loaded: number; total: number; ratio: number }>;
  /** A bake in the page goes on: its stage, the share of its time that has passed, and the seconds left; "done" at the end. */
  "bake-progress": CustomEvent<{ stage: string; ratio: number; secondsLeft: number }>;
  /** Something failed; where there is no picture left, the message is shown in the element too. */
  error: CustomEvent<{ code: string; message: string }>;
  /** The camera has changed, by hand or by script. */
  "camera-change": CustomEvent<{ camera: Camera }>;
  /** The lights have changed, by hand, by script or by an animation. */
  "light-change": CustomEvent<{ lights: Light[] }>;
  /** Nodes have moved, by hand, by script or by an animation. */
  "node-change": CustomEvent<{ nodes: Nodes }>;
  /** Another solver computes bounced light: radiosity while a node is elsewhere, or the one of the attribute. */
  "solver-change": CustomEvent<{ solver: Solver }>;
  /** The light mixer has changed, by hand or by script. */
  "mix-change": CustomEvent<{ mix: Channel[] }>;
  /** The pointer is over another light's handle, or over none: -1. */
  "light-hover": CustomEvent<{ light: number }>;
  /** Another light is chosen, or none: -1. */
  "light-select": CustomEvent<{ light: number }>;
  /** An animation begins or goes on. */
  play: CustomEvent<{ name: string }>;
  /** It stops where it stands. */
  pause: CustomEvent<{ name: string }>;
  /** It has come to the end of its last repetition. */
  finished: CustomEvent<{ name: string }>;
}

/** Sends an event; it does not bubble. */
export function tell<K extends keyof RebounceEventMap>(
  target: EventTarget,
  type: K,
  detail: RebounceEventMap[K]["detail"],
): void {
  target.dispatchEvent(new CustomEvent(type, { detail }));
}
