/**
 * Radiance of the clear sky: Hosek and Wilkie, An Analytic Model for Full Spectral Sky-Dome Radiance, 2012; the twin of
 * shared/src/environment/daylight/hosek_wilkie.rs, with the same file of data.
 */

import base64 from "hosek_wilkie_rgb.bin";
import type { Triple } from "../wire/shot.js";

/** Coefficients of the distribution. */
const COEFFICIENTS = 9;
/** Turbidities of the data, 1 to 10. */
const TURBIDITIES = 10;
/** Control points of a Bézier curve. */
const CONTROLS = 6;
/** Numbers of one quantity of one channel. */
const QUANTITY = 2 * TURBIDITIES * CONTROLS;
/** Luminous efficacy at the peak, lm/W: the data are per channel what Y is of CIE XYZ. */
const LUMENS = 683;

/** The data: 32-bit floats, least byte first. */
const numbers = new Float32Array(Uint8Array.from(atob(base64), (byte) => byte.charCodeAt(0)).buffer);

/** Radiance of a row of directions that rise as high, thousands of candela a square metre, into `row`: linear RGB. */
export type SkyRow = (up: number, cosines: ArrayLike<number>, row: Float64Array) => void;

/**
 * The sky with the sun at an elevation in degrees (below the horizon as at 0), a turbidity of 1 to 10 and an albedo of
 * the ground. Rows are asked for by the directions' y and the cosines of their angles to the sun, whose disk is not in it.
 */
export function skyModel(elevation_deg: number, turbidity: number, albedo: Triple): SkyRow {
  const height = Math.cbrt(Math.min(Math.max(elevation_deg / 90, 0), 1));
  const weights = [1, 5, 10, 10, 5, 1].map((binomial, k) => binomial * (1 - height) ** (5 - k) * height ** k);
  const haze = Math.min(Math.max(turbidity - 1, 0), TURBIDITIES - 1);
  const [low, share] = [Math.floor(haze), haze % 1];
  const high = Math.min(low + 1, TURBIDITIES - 1);
  /** A number of the data; `first` is its first place, `stride` the distance of control points. */
  const interpolated = (first: number, stride: number, ground: number) => {
    const curve = (albedo: number, turbidity: number) => {
      const start = first + (albedo * TURBIDITIES + turbidity) * CONTROLS * stride;
      return weights.reduce((sum, weight, k) => sum + weight * (numbers[start + k * stride] as number), 0);
    };
    const at = (albedo: number) => curve(albedo, low) * (1 - share) + curve(albedo, high) * share;
    return at(0) * (1 - ground) + at(1) * ground;
  };
  const channels = albedo.map((ground, c) => ({
    coefficients: Array.from({ length: COEFFICIENTS }, (_, i) => interpolated(c * COEFFICIENTS * QUANTITY + i, COEFFICIENTS, ground)),
    radiance: (interpolated(3 * COEFFICIENTS * QUANTITY + c * QUANTITY, 1, ground) * LUMENS) / 1000,
  }));
  return (up, cosines, row) => {
    for (const [channel, { coefficients, radiance }] of channels.entries()) {
      // Of the paper's Eq. 8; in the data H is last.
      const [a, b, c, d, e, f, g, i, h] = coefficients as [number, number, number, number, number, number, number, number, number];
      const horizon = radiance * (1 + a * Math.exp(b / (up + 0.01)));
      const zenith = c + i * Math.sqrt(up);
      for (let x = 0; x < cosines.length; x += 1) {
        const cosine = cosines[x] as number;
        const near = Math.max(1 + h * h - 2 * h * cosine, 1e-6);
        const mie = (1 + cosine * cosine) / (near * Math.sqrt(near));
        const glow = zenith + d * Math.exp(e * Math.acos(cosine)) + f * cosine * cosine + g * mie;
        row[3 * x + channel] = Math.max(horizon * glow, 0);
      }
    }
  };
}
