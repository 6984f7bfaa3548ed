/** Pictures of all directions, equirectangular, as the viewer takes them: rgb9e5. */

import type { DirectionalLight } from "../wire/light-kinds.js";

/** A picture of all directions. */
export interface Picture {
  width: number;
  /** Radiance of a texel of 1. */
  scale: number;
  /** rgb9e5, rows from the top. */
  texels: Uint32Array;
  /** The sun that belongs to the picture and is not in it, where that is turned by degrees and has this factor. */
  sun?: (rotation_deg: number, factor: number) => DirectionalLight;
}

/** The widest picture that is kept, texels; wider ones are reduced. */
const WIDEST = 4096;
/** The widest that is read. */
const MOST = 16_384;
/** The exponent of black. */
const NONE = -9999;

/** Throws where a picture of a file has a size that cannot be used. */
export function checkSize(wide: number, tall: number): void {
  if (!(wide > 0 && tall > 0 && wide <= MOST) || Math.abs(wide - 2 * tall) > 1) {
    throw new Error(`it has ${wide} x ${tall} pixels, and must be twice as wide as high, at most ${MOST}`);
  }
}

/** Makes a picture. `radiance` fills in a row of linear RGB, W/(sr m²): it is asked for one after the other, from the top. Throws where one is negative or not finite. */
export function pack(wide: number, tall: number, radiance: (y: number, row: Float64Array) => void): Picture {
  const factor = Math.ceil(wide / WIDEST);
  const [width, height] = [Math.floor(wide / factor), Math.max(Math.floor(tall / factor), 1)];
  if (factor > 1) console.warn(`<rebounce-viewer>: the environment of ${wide} x ${tall} pixels is reduced to ${width} x ${height}.`);
  // Three parts of nine bits, and the exponent of the parts' unit.
  const texels = new Uint32Array(width * height);
  const exponents = new Int16Array(width * height);
  const row = new Float64Array(3 * wide);
  const sums = new Float64Array(3 * width);
  for (let y = 0; y < height * factor; y += 1) {
    radiance(y, row);
    for (let x = 0; x < wide; x += 1) {
      const to = 3 * Math.floor(x / factor);
      for (let c = 0; c < 3; c += 1) {
        const value = row[3 * x + c] as number;
        if (!(value >= 0 && value < Infinity)) {
          throw new Error(`its pixel x = ${x}, y = ${y} (from the top left) has ${value} for ${["red", "green", "blue"][c]}, and must be finite and not negative: paint it over`);
        }
        // A reduced row leaves out what does not fill a pixel of its own.
        if (to < sums.length) (sums[to + c] as number) += value;
      }
    }
    if (y % factor < factor - 1) continue;
    const to = width * Math.floor(y / factor);
    for (let x = 0; x < width; x += 1) {
      const [r, g, b] = [sums[3 * x] as number, sums[3 * x + 1] as number, sums[3 * x + 2] as number];
      const most = Math.max(r, g, b);
      // The greatest part is from 2^8 to below 2^9.
      const exponent = most > 0 ? Math.floor(Math.log2(most)) - 8 : NONE;
      const scale = most > 0 ? 2 ** -exponent : 0;
      const part = (value: number) => Math.min(Math.round(value * scale), 511);
      texels[to + x] = part(r) | (part(g) << 9) | (part(b) << 18);
      exponents[to + x] = exponent;
    }
    sums.fill(0);
  }
  return { width, ...withExponents(texels, exponents, factor ** 2) };
}

/** Puts exponents of five bits into texels, the greatest that there is at the top. */
function withExponents(texels: Uint32Array, exponents: Int16Array, divisor: number): Omit<Picture, "width"> {
  const most = exponents.reduce((a, b) => (a > b ? a : b), -126);
  for (let i = 0; i < texels.length; i += 1) {
    // The unit of rgb9e5 is 2^(exponent - 24).
    const exponent = (exponents[i] as number) - most + 31;
    const bits = texels[i] as number;
    const down = Math.max(-exponent, 0);
    const part = (shift: number) => (down > 9 ? 0 : ((bits >> shift) & 511) >> down) << shift;
    texels[i] = (part(0) | part(9) | part(18) | (Math.max(exponent, 0) << 27)) >>> 0;
  }
  return { scale: 2 ** (most - 7) / divisor, texels };
}
