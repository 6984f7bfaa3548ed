/** New lights, and small steps of lights as seen by the camera. Pure functions. */

import { KINDS } from "./light-kinds.js";
import type { Camera, Light, Triple } from "./shot.js";

/** A light's members by name. */
export type Members = Record<string, number | Triple | string | undefined>;

/** Where a light is, or else the way it shines; nothing of one that has neither. */
export const placeOf = (light: Light): Triple | undefined => {
  const { position, direction } = light as { position?: Triple; direction?: Triple };
  return position ?? direction;
};

const sum = (a: Triple, b: Triple, scale = 1) => a.map((x, i) => x + scale * (b[i] as number)) as Triple;
const distance = (a: Triple, b: Triple) => Math.hypot(...sum(a, b, -1));
const unit = (v: Triple, instead: Triple) => {
  const length = Math.hypot(...v);
  return length > 1e-9 ? (v.map((x) => x / length) as Triple) : instead;
};

/** The way the camera looks over the ground, and what is right of it. */
function ground(camera: Camera): { ahead: Triple; right: Triple } {
  const [x, y, z] = sum(camera.target, camera.position, -1);
  const up = camera.up ?? [0, 1, 0];
  // Straight down or up, what is up in the picture lies ahead.
  const flat: Triple = Math.hypot(x, z) > 1e-3 * Math.abs(y) ? [x, 0, z] : [up[0], 0, up[2]];
  const ahead = unit(flat, [0, 0, -1]);
  return { ahead, right: [-ahead[2], 0, ahead[0]] };
}

/** Places that are tried for a new light, on a spiral. */
const TRIES = 40;

/**
 * A new light a little before what the camera looks at, beside others that are there, as bright there as others at their
 * distance; a sun that shines as `sunlight` says, or nearly so.
 */
export function newLight(type: Light["type"], camera: Camera, lights: Light[], sunlight: () => Triple): Light {
  const { fields } = KINDS[type];
  const isSun = !fields.some(({ name }) => name === "position");
  const away = distance(camera.position, camera.target);
  const middle = isSun ? unit(sunlight(), [0, -1, 0]) : sum(camera.position, sum(camera.target, camera.position, -1), 0.7);
  const { right } = ground(camera);
  // Suns lie on a map of all directions: farther apart.
  const gap = isSun ? 0.4 : 0.14;
  /** The direction in which a handle lies. */
  const seen = (place: Triple) => unit(isSun ? place : sum(place, camera.position, -1), right);
  const others = lights.filter((light) => isSun !== ("position" in light));
  const place = (i: number) => {
    const far = gap * Math.sqrt(i) * (isSun ? 1 : away);
    return sum(sum(middle, right, far * Math.cos(2.4 * i)), [0, 1, 0], far * Math.sin(2.4 * i));
  };
  const isFree = (at: Triple) =>
    others.every((other) => distance(seen(at), seen(placeOf(other) ?? [0, 0, 0])) > 0.6 * gap);
  let i = 0;
  while (i < TRIES && !isFree(place(i))) i += 1;
  const position = place(i % TRIES);
  // The illuminance of 4 lux at a third of the way.
  const intensity = isSun ? 2 : Number((4 * (away / 3) ** 2).toPrecision(2));
  const known: Members = { intensity, color: [1, 1, 1], [isSun ? "direction" : "position"]: position };
  const light: Members = { type };
  for (const { name, fresh } of fields) {
    const value = known[name] ?? fresh;
    if (value !== undefined) light[name] = value;
  }
  // Radiance: the same from far away.
  const { width, height, radius } = light as Record<string, number>;
  const area = width && height ? width * height : Math.PI * (radius ?? 0) ** 2;
  if (KINDS[type].units[0] === "nit") light.intensity = Number((intensity / area).toPrecision(2));
  return light as unknown as Light;
}

const STEPS: Record<string, Triple> = {
  ArrowLeft: [-1, 0, 0],
  ArrowRight: [1, 0, 0],
  ArrowUp: [0, 0, 1],
  ArrowDown: [0, 0, -1],
  PageUp: [0, 1, 0],
  PageDown: [0, -1, 0],
};

/**
 * A light after a key: arrows move it right, left, away and nearer over the ground as the camera sees it,
 * PageUp and PageDown up and down; a fiftieth of its distance, with `far` five. What shines from a
 * directional light comes from further right, left, ahead or behind. Nothing for other keys.
 */
export function stepped(light: Light, camera: Camera, key: string, far: boolean): Light | undefined {
  const step = STEPS[key];
  if (!step) return undefined;
  const { ahead, right } = ground(camera);
  const along = sum(sum(right.map((x) => x * step[0]) as Triple, ahead, step[2]), [0, step[1], 0]);
  const share = far ? 0.1 : 0.02;
  if ("position" in light) {
    const size = Math.max(distance(light.position, camera.position), 1e-3);
    return { ...light, position: sum(light.position, along, size * share) };
  }
  if (!("direction" in light)) return undefined;
  const from = unit(light.direction, [0, -1, 0]);
  return { ...light, direction: unit(sum(from, along, -2 * share), from) };
}

/** Linear RGB as an sRGB colour of the page, `#rrggbb`; brighter than white is scaled down. */
export function hexColor(color: Triple = [1, 1, 1]): string {
  const most = Math.max(1, ...color);
  const part = (x: number) => {
    const linear = x / most;
    const encoded = linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055;
    return Math.round(encoded * 255).toString(16).padStart(2, "0");
  };
  return `#${color.map(part).join("")}`;
}

/** The other way. */
export function linearColor(hex: string): Triple {
  return [1, 3, 5].map((at) => {
    const encoded = parseInt(hex.slice(at, at + 2), 16) / 255;
    const linear = encoded <= 0.04045 ? encoded / 12.92 : ((encoded + 0.055) / 1.055) ** 2.4;
    return Number(linear.toPrecision(4));
  }) as Triple;
}
