/** Units of light, colour temperatures, and where a sun stands. Pure functions. */

import type { Light, Triple } from "../wire/shot.js";

const radians = (degrees: number) => (degrees * Math.PI) / 180;
const cosine = (degrees: number) => Math.cos(radians(Math.min(Math.max(degrees, 0), 90)));

/**
 * How many of a unit one unit of `intensity` is. Lumens of a point light: 4π a candela. Of a spot: the integral of
 * KHR_lights_punctual's falloff over the cone, 2π ((1 - cos inner) + (cos inner - cos outer) / 3); with a hard edge that
 * is the cone's solid angle, 2π (1 - cos outer), as in Filament. (three.js counts π for any spot.)
 */
export function perIntensity(light: Light, unit: string): number {
  if (unit !== "lumen") return 1;
  if (!("outer_cone_deg" in light)) return 4 * Math.PI;
  const { outer_cone_deg: angle, inner_cone_deg = angle } = light;
  const outer = cosine(angle);
  const inner = Math.max(cosine(inner_cone_deg), outer);
  return 2 * Math.PI * (1 - inner + (inner - outer) / 3);
}

/** The coolest and the hottest colour temperature, and the step between two, kelvin. */
export const KELVIN = { min: 1000, max: 12_000, step: 50 };

/**
 * The colour of a black body: linear sRGB, the largest part 1. Chromaticity (CIE 1960 u, v; 1,000 to 15,000 K) by Krystek,
 * "An algorithm to calculate correlated colour temperature", Color Research & Application 10 (1985), 38-40. Parts outside
 * of sRGB, blue below 1,900 K, are 0.
 */
export function kelvinColor(t: number): Triple {
  const u = (0.860117757 + 1.54118254e-4 * t + 1.28641212e-7 * t * t) / (1 + 8.42420235e-4 * t + 7.08145163e-7 * t * t);
  const v = (0.317398726 + 4.22806245e-5 * t + 4.20481691e-8 * t * t) / (1 - 2.89741816e-5 * t + 1.61456053e-7 * t * t);
  // X and Z for Y = 1: x = 3u / d, y = 2v / d with d = 2u - 8v + 4.
  const x = (1.5 * u) / v;
  const z = (2 - 0.5 * u - 5 * v) / v;
  const rgb = [3.2404542 * x - 1.5371385 - 0.4985314 * z, 1.8760108 - 0.969266 * x + 0.041556 * z, 0.0556434 * x - 0.2040259 + 1.0572252 * z];
  const most = Math.max(...rgb);
  return rgb.map((part) => Number(Math.max(part / most, 0).toPrecision(4))) as Triple;
}

/** Colour temperatures and their colours; made with the first question. */
let colors: [number, Triple][] = [];

/** The colour temperature whose colour is the nearest; nothing for colours that are far from all of them. */
export function colorKelvin(color: Triple = [1, 1, 1]): number | undefined {
  if (!colors.length) {
    for (let t = KELVIN.min; t <= KELVIN.max; t += KELVIN.step) colors.push([t, kelvinColor(t)]);
  }
  const most = Math.max(...color);
  let [nearest, least] = [0, 0.12];
  for (const [t, of] of colors) {
    const far = Math.hypot(...of.map((part, i) => part - (color[i] as number) / most));
    if (far < least) [nearest, least] = [t, far];
  }
  return nearest || undefined;
}

/** Where light that travels this way comes from, degrees: azimuth from north (-z) to east (+x), 0 to 360, and elevation. */
export function sunAngles([x, y, z]: Triple): [azimuth: number, elevation: number] {
  const degrees = (y: number, x: number) => (Math.atan2(y, x) * 180) / Math.PI;
  return [(degrees(-x, z) + 360) % 360, degrees(-y, Math.hypot(x, z))];
}

/** The other way: a unit vector, the way the light travels. */
export function sunDirection(azimuth: number, elevation: number): Triple {
  const [a, e] = [radians(azimuth), radians(elevation)];
  return [-Math.sin(a) * Math.cos(e), -Math.sin(e), Math.cos(a) * Math.cos(e)];
}

/** A direction of the compass in words: N, NE, … */
export const compass = (azimuth: number): string => ["N", "NE", "E", "SE", "S", "SW", "W", "NW"][Math.round(azimuth / 45) % 8] as string;
