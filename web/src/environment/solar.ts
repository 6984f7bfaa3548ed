/** Where the sun stands, and how much air is before it. */

import type { Triple } from "../wire/shot.js";

/** Tilt of the earth's axis, degrees. */
const TILT = 23.44;

export const radians = (degrees: number): number => (degrees * Math.PI) / 180;

/**
 * The way to the sun: y is up, -z north, x east. Latitude in degrees, north positive; day of the year, 1 to 366; solar
 * hour, 0 to 24. The declination is Cooper's (1969).
 */
export function towardSun(latitude: number, day: number, hour: number): Triple {
  const tilt = radians(TILT) * Math.sin((2 * Math.PI * (284 + day)) / 365);
  const turn = radians(15 * (hour - 12));
  const place = radians(latitude);
  const [sin, cos] = [Math.sin(place), Math.cos(place)];
  const north = Math.sin(tilt) * cos - Math.cos(tilt) * sin * Math.cos(turn);
  const up = Math.sin(tilt) * sin + Math.cos(tilt) * cos * Math.cos(turn);
  return [-Math.cos(tilt) * Math.sin(turn), up, -north];
}

/** Height above the horizon of a unit direction, degrees. */
export const elevation = ([, up]: Triple): number => (Math.asin(Math.min(Math.max(up, -1), 1)) * 180) / Math.PI;

/** How much air light passes through, in vertical thicknesses, from a height above the horizon in degrees
 * (Kasten and Young 1989). */
export function airMass(height: number): number {
  return 1 / (Math.sin(radians(height)) + 0.50572 * (height + 6.07995) ** -1.6364);
}
