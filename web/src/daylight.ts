/**
 * Daylight: the sun of a place and an hour as a light, and a day as an animation.
 *
 * A module of its own: the element does not need it. y is up; directions are in the scene's world space.
 */

import type { LightAnimation } from "./animation/animation.js";
import { airMass, elevation, radians, towardSun } from "./environment/solar.js";
import type { DirectionalLight, Triple } from "./wire/shot.js";

/** Where the scene stands. */
export interface Place {
  /** Degrees; north of the equator is positive. */
  latitude: number;
  /** Day of the year, 1 to 365; 80 is the spring equinox, 172 the summer solstice of the north. */
  day?: number;
  /** Where north is: degrees from -z towards +x; with 0, east is +x. */
  north?: number;
  /** What illuminances are multiplied by, so that the sun and the scene's lamps go into one picture. */
  scale?: number;
}

/** Illuminance of the sun above the air, lux. */
const ABOVE_AIR = 133_100;
/** Optical depth of clear air above sea level for red, green and blue: molecules, haze and ozone. */
const DEPTHS: Triple = [0.195, 0.237, 0.328];
/** How much red, green and blue light count for lux. */
const LUMINANCE: Triple = [0.2126, 0.7152, 0.0722];
/** Half the sun's width in the sky, degrees. */
const RADIUS = 0.27;

export { airMass };

/**
 * The sun at an hour of solar time (0 to 24; at 12 it is highest). The luminance of intensity times
 * colour is the illuminance in lux under a clear sky; at night the intensity is 0.
 */
export function sun({ hour, latitude, day = 80, north = 0, scale = 1 }: Place & { hour: number }): DirectionalLight {
  const toward = towardSun(latitude, day, hour);
  const [east, up, south] = toward;
  const [s, c] = [Math.sin(radians(north)), Math.cos(radians(north))];
  // The way the light travels: from the sun.
  const direction: Triple = [south * s - east * c, -up, -(east * s + south * c)];

  const height = elevation(toward);
  // The share of the disk above the horizon, and what of its light the air lets through.
  const disk = Math.min(Math.max(0.5 + height / (2 * RADIUS), 0), 1);
  const mass = airMass(Math.max(height, 0));
  const distance = 1 + 0.033 * Math.cos((2 * Math.PI * day) / 365);
  const through = DEPTHS.map((depth) => Math.exp(-depth * mass)) as Triple;
  const most = Math.max(...through);
  return {
    type: "directional",
    direction,
    intensity: ABOVE_AIR * distance * most * disk * scale,
    color: through.map((x) => x / most) as Triple,
  };
}

/** Illuminance of a light on a surface that faces it, lux. */
export function illuminance({ intensity, color = [1, 1, 1] }: DirectionalLight): number {
  return intensity * LUMINANCE.reduce((sum, weight, i) => sum + weight * (color[i] as number), 0);
}

/** What a day cycle is made of. */
export interface DayOptions extends Place {
  /** Which light is the sun: its place in the list, from 0; it must be a directional one. */
  light?: number;
  /** How long the day takes, seconds. */
  duration?: number;
  /** First and last hour. */
  from?: number;
  to?: number;
  name?: string;
}

/** The sun's way through a day, with four keys an hour, as an animation of one light. */
export function dayCycle({ light = 0, duration = 24, from = 0, to = 24, name = "day", ...place }: DayOptions): LightAnimation {
  const steps = Math.max(1, Math.ceil(Math.abs(to - from) * 4));
  const shares = Array.from({ length: steps + 1 }, (_, i) => i / steps);
  const suns = shares.map((share) => sun({ ...place, hour: from + (to - from) * share }));
  const track = (property: "direction" | "intensity" | "color") => ({
    light,
    property,
    times: shares.map((share) => share * duration),
    values: suns.flatMap((key) => key[property] ?? [1, 1, 1]),
  });
  return { name, duration, tracks: [track("direction"), track("intensity"), track("color")] };
}
