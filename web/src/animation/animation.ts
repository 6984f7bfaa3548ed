/** Keyframes of lights, nodes and poses: their form, and the lights at a moment. Pure functions, no state. */

import { Failure } from "../wire/failure.js";
import type { Light, Triple } from "../wire/shot.js";

/** What of a light can be animated. */
export type AnimatedProperty = "position" | "direction" | "intensity" | "color";

/** One property of one light over time. */
export interface LightTrack {
  /** Which light: its place in the list, from 0. */
  light: number;
  node?: undefined;
  property: AnimatedProperty;
  /** When the keys are, seconds, rising. */
  times: number[];
  /** The keys' values one after the other: three numbers a key, one for an intensity. */
  values: number[];
  /** How it goes from key to key; linear when absent. Directions turn at an even pace. */
  interpolation?: "linear" | "step";
}

/** One property of one node over time. */
export interface NodeTrack {
  /** Which node: its name. */
  node: string;
  light?: undefined;
  property: "translation" | "rotation";
  /** When the keys are, seconds, rising. */
  times: number[];
  /** The keys' values one after the other: three numbers a key, four of a quaternion for a rotation. */
  values: number[];
  /** How it goes from key to key; linear when absent. Rotations turn at an even pace, the shorter way. */
  interpolation?: "linear" | "step";
}

/** The pose of what deforms over time. */
export interface PoseTrack {
  /** Which of the file's animations of skins and morph targets: its name. */
  node: string;
  light?: undefined;
  property: "pose";
  /** When the keys are, seconds, rising. */
  times: number[];
  /** Of each key, the time in the file's animation whose pose it has, seconds. */
  values: number[];
  /** How it goes from key to key; linear when absent. */
  interpolation?: "linear" | "step";
}

/** Tracks that are played together. */
export interface LightAnimation {
  name: string;
  /** Seconds. */
  duration: number;
  tracks: (LightTrack | NodeTrack | PoseTrack)[];
}

type Track = LightTrack | NodeTrack | PoseTrack;

/** Properties of lights and of nodes, and their numbers a key. */
const LIGHT = { position: 3, direction: 3, intensity: 1, color: 3 };
const NODE = { translation: 3, rotation: 4, pose: 1 };
const WIDTH = { ...LIGHT, ...NODE };

/** A copy of a list of animations from anywhere. Throws a `Failure` with the code `bad-json` and what is wrong. */
export function checkedAnimations(value: unknown): LightAnimation[] {
  return list(value, "animations").map((animation, a) => {
    const at = `animations[${a}]`;
    const { name, duration, tracks } = object(animation, at);
    if (typeof name !== "string") bad(`${at}.name must be a text`);
    if (!(finite(duration) && duration >= 0)) bad(`${at}.duration must be seconds, not negative`);
    return { name, duration, tracks: list(tracks, `${at}.tracks`).map((t, i) => track(t, `${at}.tracks[${i}]`)) };
  });
}

function track(value: unknown, at: string): Track {
  const { light, node, property, times, values, interpolation = "linear" } = object(value, at);
  const isNode = typeof node === "string";
  if (!isNode && !(Number.isInteger(light) && (light as number) >= 0)) bad(`${at}.light must be a light's place in the list, from 0`);
  const properties = isNode ? NODE : LIGHT;
  if (!Object.hasOwn(properties, property as string)) bad(`${at}.property must be one of ${Object.keys(properties).join(", ")}`);
  if (interpolation !== "linear" && interpolation !== "step") bad(`${at}.interpolation must be linear or step`);
  const keys = numbers(times, `${at}.times`);
  const flat = numbers(values, `${at}.values`);
  const what = property as Track["property"];
  const width = WIDTH[what];
  if (keys.length === 0) bad(`${at}.times must hold a key`);
  if (keys.some((time, i) => i > 0 && time < (keys[i - 1] as number))) bad(`${at}.times must rise`);
  if (flat.length !== keys.length * width) {
    bad(`${at}.values must hold ${width} numbers a key; it holds ${flat.length} for ${keys.length}`);
  }
  const unsigned = what === "intensity" || what === "color";
  if (unsigned && flat.some((x) => x < 0)) bad(`${at}.values must not be negative`);
  return { ...(isNode ? { node } : { light }), property: what, times: keys, values: flat, interpolation } as Track;
}

const finite = (value: unknown): value is number => typeof value === "number" && Number.isFinite(value);

function list(value: unknown, at: string): unknown[] {
  if (!Array.isArray(value)) bad(`${at} must be a list`);
  return value;
}

function numbers(value: unknown, at: string): number[] {
  const found = ArrayBuffer.isView(value) ? Array.from(value as Float32Array) : list(value, at);
  if (!found.every(finite)) bad(`${at} must hold finite numbers`);
  return found as number[];
}

function object(value: unknown, at: string): Record<string, unknown> {
  if (typeof value !== "object" || value === null) bad(`${at} must be an object`);
  return value as Record<string, unknown>;
}

function bad(what: string): never {
  throw new Failure("bad-json", `animations: ${what}`);
}

/** The value of a track at a time, seconds: its first key's before it, its last key's after it. */
export function valueAt(track: Track, time: number): number[] {
  const { times, values, property } = track;
  const size = WIDTH[property];
  const key = (i: number) => values.slice(i * size, (i + 1) * size);
  let after = times.findIndex((t) => t > time);
  if (after < 0) after = times.length;
  const before = Math.max(after - 1, 0);
  if (after === 0 || after === times.length || track.interpolation === "step") return key(before);
  const [from, to] = [times[before] as number, times[after] as number];
  const share = (time - from) / (to - from);
  const [a, b] = [key(before), key(after)];
  // Of a rotation, the quaternion with the other sign may be nearer.
  if (property === "rotation") return turned(dot(a, b) < 0 ? a.map((x) => -x) : a, b, share);
  return (property === "direction" ? turned : mixed)(a, b, share);
}

const mixed = (a: number[], b: number[], share: number) => a.map((x, i) => x + ((b[i] as number) - x) * share);

/** From one direction to another at an even pace; unit length. Opposite ones turn over any side. */
function turned(from: number[], to: number[], share: number): number[] {
  const [a, b] = [unit(from), unit(to)];
  const cos = Math.min(Math.max(dot(a, b), -1), 1);
  // What of b stands upright on a; where they are one line, any upright vector does.
  let side = b.map((x, i) => x - cos * (a[i] as number));
  if (Math.hypot(...side) < 1e-9) {
    const [x, y, z] = a as Triple;
    side = Math.abs(x) < 0.7 ? [0, -z, y] : [z, 0, -x];
  }
  const angle = Math.acos(cos) * share;
  const across = unit(side);
  return a.map((x, i) => x * Math.cos(angle) + (across[i] as number) * Math.sin(angle));
}

const dot = (a: number[], b: number[]) => a.reduce((sum, x, i) => sum + x * (b[i] as number), 0);

function unit(v: number[]): number[] {
  const length = Math.hypot(...v);
  return length > 0 ? v.map((x) => x / length) : [0, -1, 0];
}

/** The lights at a moment of an animation, seconds. Tracks of what a light has not are passed over. */
export function lightsAt(lights: readonly Light[], animation: LightAnimation, time: number): Light[] {
  const result = lights.map((light) => ({ ...light }) as Record<string, unknown>);
  for (const track of animation.tracks) {
    const light = result[track.light ?? -1];
    if (!light || !(track.property in light)) continue;
    const value = valueAt(track, time);
    light[track.property] = track.property === "intensity" ? value[0] : value;
  }
  return result as unknown as Light[];
}

/** Whether what the animation moves is the same in both lists. */
export function agrees(animation: LightAnimation, a: readonly Light[], b: readonly Light[]): boolean {
  const text = (lights: readonly Light[], { light = -1, property }: Track) =>
    JSON.stringify((lights[light] as Partial<Record<string, unknown>> | undefined)?.[property]);
  return animation.tracks.every((track) => text(a, track) === text(b, track));
}

/** The animations after a light was added (`by` 1) or taken away (`by` -1) at a place of the list. */
export function shifted(animations: readonly LightAnimation[], index: number, by: 1 | -1): LightAnimation[] {
  return animations.map((animation) => ({
    ...animation,
    tracks: animation.tracks
      .filter(({ light }) => by > 0 || light !== index)
      .map((track) => ((track.light ?? -1) >= index ? ({ ...track, light: (track.light as number) + by } as Track) : track)),
  }));
}
