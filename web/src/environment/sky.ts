/**
 * Daylight skies: the picture and the sun of a clear day, as `rebounce bake --sky` has them; the twin of
 * shared/src/environment/daylight. Loaded when a `sky` is first wanted.
 */

import { Failure } from "../wire/failure.js";
import type { Triple } from "../wire/shot.js";
import { skyModel } from "./hosek-wilkie.js";
import { pack, type Picture } from "./picture.js";
import { airMass, elevation, radians, towardSun } from "./solar.js";

export { PictureLights } from "./lights.js";

/** Pixels in a row, and rows; the horizon is between the middle two. */
const [WIDTH, HEIGHT] = [256, 128];
/** Haze of the command's sky: a clear day. */
const TURBIDITY = 3;
/** Reflectance of the ground below the horizon. */
const GROUND: Triple = [0.2, 0.2, 0.2];
/** Angular radius of the sun at its mean distance, degrees. */
const RADIUS_DEG = 0.2665;
/** Illuminance of the sun above the air, thousands of lux. */
const ABOVE_AIR = 133.1;
/** Wavelength of red, green and blue, micrometres, and what ozone absorbs there, 1/cm. */
const CHANNELS = [[0.61, 0.12], [0.54, 0.075], [0.464, 0.0077]] as const;
/** Ozone above a place, cm. */
const OZONE_CM = 0.35;
/** Twilight (Janiczek and DeYoung 1987): from which elevation in degrees, and the coefficients of the decimal logarithm of
 * the illuminance in lux, a polynomial in the elevation over 90 degrees. */
const TWILIGHT = [
  [-5, 2.88, 21.81, -258.11, -858.36],
  [-12, 2.7, 12.17, -431.69, -1899.83],
  [-18, 13.84, 262.72, 1447.42, 2797.93],
] as const;

/** The sky that the attribute names: latitude in degrees, day of the year, solar hour. Throws `bad-environment`. */
export function picture(text: string): Picture {
  const parts = text.split(",").map((part) => (part.trim() ? Number(part) : NaN));
  const [latitude = NaN, day = NaN, hour = NaN] = parts;
  if (!(parts.length === 3 && Math.abs(latitude) <= 90 && day >= 1 && day <= 366 && hour >= 0 && hour <= 24)) {
    const wanted = "latitude (-90 to 90), day of the year (1 to 366) and hour (0 to 24) are needed, as in 48,172,15.5";
    throw new Failure("bad-environment", `There is no sky “${text}”: ${wanted}; the light stays as it is.`);
  }
  return daylightSky(towardSun(latitude, day, hour));
}

/** The sky with the sun in a unit direction, thousands of candela; the picture's middle is +x, a quarter to its right +z. */
export function daylightSky(toward: Triple, turbidity = TURBIDITY, albedo = GROUND): Picture {
  const height = elevation(toward);
  const model = skyModel(height, turbidity, albedo);
  const brightness = twilight(height);
  const irradiance = sunlight(height, turbidity);

  const cosines = new Float64Array(WIDTH);
  // What falls on the ground of the sun, and of the rows so far.
  const fallen = irradiance.map((light) => light * Math.max(toward[1], 0)) as Triple;
  const packed = pack(WIDTH, HEIGHT, (y, row) => {
    if (y >= HEIGHT / 2) {
      for (let i = 0; i < row.length; i += 1) row[i] = ((albedo[i % 3] as number) * (fallen[i % 3] as number)) / Math.PI;
      return;
    }
    const polar = (Math.PI * (y + 0.5)) / HEIGHT;
    const [across, up] = [Math.sin(polar), Math.cos(polar)];
    for (let x = 0; x < WIDTH; x += 1) {
      const azimuth = 2 * Math.PI * ((x + 0.5) / WIDTH - 0.5);
      const cosine = across * (Math.cos(azimuth) * toward[0] + Math.sin(azimuth) * toward[2]) + up * toward[1];
      cosines[x] = Math.min(Math.max(cosine, -1), 1);
    }
    model(up, cosines, row);
    const solidAngle = (2 * Math.PI * (Math.cos((Math.PI * y) / HEIGHT) - Math.cos((Math.PI * (y + 1)) / HEIGHT))) / WIDTH;
    for (let i = 0; i < row.length; i += 1) {
      (row[i] as number) *= brightness;
      (fallen[i % 3] as number) += (row[i] as number) * up * solidAngle;
    }
  });
  const most = Math.max(...irradiance);
  return {
    ...packed,
    sun: (rotation_deg, factor) => {
      const [sin, cos] = [Math.sin(radians(rotation_deg)), Math.cos(radians(rotation_deg))];
      const [x, y, z] = toward;
      return {
        type: "directional",
        name: "Sun",
        direction: [-(cos * x + sin * z), -y, sin * x - cos * z],
        intensity: most * factor,
        color: irradiance.map((light) => (most ? light / most : 1)) as Triple,
        radius_deg: RADIUS_DEG,
      };
    },
  };
}

/** Irradiance of the sun at a height in degrees, thousands of lux: what the air lets through (Preetham et al. 1999, A.1),
 * and of the disk what is above the horizon. */
function sunlight(height: number, turbidity: number): Triple {
  const above = Math.min(Math.max(0.5 + height / (2 * RADIUS_DEG), 0), 1);
  const mass = airMass(Math.max(height, 0));
  return CHANNELS.map(([wavelength, ozone]) => {
    const haze = Math.max(0.04608 * turbidity - 0.04586, 0) * wavelength ** -1.3;
    const depth = 0.008735 * wavelength ** -4.08 + haze + OZONE_CM * ozone;
    return Math.exp(-depth * mass) * ABOVE_AIR * above;
  }) as unknown as Triple;
}

/** Illuminance of twilight over that at sunset: 1 with the sun at or above the horizon. */
function twilight(height: number): number {
  const at = Math.min(Math.max(height, -18), 0);
  const [, ...coefficients] = TWILIGHT.find(([from]) => at >= from) ?? TWILIGHT[2];
  const logarithm = coefficients.reduceRight((sum: number, coefficient) => sum * (at / 90) + coefficient, 0);
  return 10 ** (logarithm - TWILIGHT[0][1]);
}
