/** Reads Radiance pictures (.hdr): the texels that the viewer takes. Loaded when an `environment` is first wanted. */

import { Failure } from "../wire/failure.js";

/** A picture of all directions, equirectangular. */
export interface Picture {
  width: number;
  /** Radiance of a texel of 1. */
  scale: number;
  /** rgb9e5, rows from the top. */
  texels: Uint32Array;
}

/** The widest picture that is kept, texels; wider ones are reduced. */
const WIDEST = 4096;
/** The widest that is read. */
const MOST = 16_384;

/** The exponent of black. */
const NONE = -999;
/** Radiance of a step, by the exponent of RGBE. */
const UNITS = Float64Array.from({ length: 256 }, (_, e) => e && 2 ** (e - 136));

/** Downloads a picture and reads it. Rejects with a `Failure`, or the signal's AbortError. */
export async function fetchPicture(url: string, signal: AbortSignal): Promise<Picture> {
  const wrong = (code: string, reason: string, cause?: unknown) =>
    new Failure(code, `The environment ${url} could not be loaded: ${reason}; the light stays as it is.`, { cause });
  let response: Response;
  let bytes: Uint8Array;
  try {
    response = await fetch(url, { signal });
    if (!response.ok) throw wrong("http", `the server answered ${response.status}`);
    bytes = new Uint8Array(await response.arrayBuffer());
  } catch (error) {
    signal.throwIfAborted();
    throw error instanceof Failure ? error : wrong("network", "the download broke off, or never began", error);
  }
  try {
    return readPicture(bytes);
  } catch (error) {
    throw wrong("bad-environment", (error as Error).message, error);
  }
}

/** Reads a file. Throws an error that says what is wrong with it. */
export function readPicture(bytes: Uint8Array): Picture {
  let at = 0;
  const line = () => {
    const end = bytes.indexOf(10, at);
    if (end < 0) throw new Error("it ends within its header");
    const text = String.fromCharCode(...bytes.subarray(at, Math.min(end, at + 999)));
    at = end + 1;
    return text.trim();
  };
  if (bytes[0] !== 35 || bytes[1] !== 63) throw new Error("it is no Radiance picture (.hdr), the one format that the page reads");
  let [exposure, format] = [1, ""];
  for (let text = line(); text; text = line()) {
    const [name, value = ""] = text.split("=");
    if (name === "EXPOSURE") exposure *= Number(value);
    if (name === "FORMAT") format = value;
  }
  const [, rows, columns] = /^-Y (\d+) \+X (\d+)$/.exec(line()) ?? [];
  const [wide, tall] = [Number(columns), Number(rows)];
  if (format !== "32-bit_rle_rgbe" || !(exposure > 0) || !wide || !tall) throw new Error("it is of a form of .hdr that is not read");
  if (Math.abs(wide - 2 * tall) > 1 || wide > MOST) {
    throw new Error(`it has ${wide} x ${tall} pixels, and must be twice as wide as high, at most ${MOST}`);
  }
  const factor = Math.ceil(wide / WIDEST);
  const [width, height] = [Math.floor(wide / factor), Math.max(Math.floor(tall / factor), 1)];
  // Three parts of nine bits, and the exponent of the parts' unit.
  const texels = new Uint32Array(width * height);
  const exponents = new Int16Array(width * height);
  const row = new Uint8Array(4 * wide);
  const sums = new Float64Array(3 * width);
  for (let y = 0; y < height * factor; y += 1) {
    at = readRow(bytes, at, row, wide);
    const to = width * Math.floor(y / factor);
    for (let x = 0; x < width; x += 1) {
      let i = 4 * factor * x;
      if (factor === 1) {
        // As it is: the unit of eight bits is twice that of nine.
        texels[to + x] = ((row[i] as number) << 1) | ((row[i + 1] as number) << 10) | ((row[i + 2] as number) << 19);
        exponents[to + x] = row[i + 3] ? (row[i + 3] as number) - 137 : NONE;
        continue;
      }
      let [r, g, b] = [0, 0, 0];
      for (let k = 0; k < factor; k += 1, i += 4) {
        const unit = UNITS[row[i + 3] as number] as number;
        r += (row[i] as number) * unit;
        g += (row[i + 1] as number) * unit;
        b += (row[i + 2] as number) * unit;
      }
      r = (sums[3 * x] as number) += r;
      g = (sums[3 * x + 1] as number) += g;
      b = (sums[3 * x + 2] as number) += b;
      if (y % factor < factor - 1) continue;
      const most = Math.max(r, g, b);
      // The greatest part is from 2^8 to below 2^9.
      const exponent = most > 0 ? Math.floor(Math.log2(most)) - 8 : NONE;
      const scale = most > 0 ? 2 ** -exponent : 0;
      const part = (value: number) => Math.min(Math.round(value * scale), 511);
      texels[to + x] = part(r) | (part(g) << 9) | (part(b) << 18);
      exponents[to + x] = exponent;
    }
    if (y % factor < factor - 1) continue;
    sums.fill(0);
  }
  return { width, ...withExponents(texels, exponents, exposure * factor ** 2) };
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

/** Reads a row of RGBE pixels, plain or run-length encoded in either of the two ways; where the next one begins. */
function readRow(bytes: Uint8Array, from: number, row: Uint8Array, width: number): number {
  let at = from;
  const byte = () => {
    if (at >= bytes.length) throw new Error("it ends before its last pixel: download it again");
    return bytes[at++] as number;
  };
  const isNew = bytes[at] === 2 && bytes[at + 1] === 2 && width >= 8 && width < 32_768 && (bytes[at + 2] as number) < 128;
  if (isNew) {
    at += 4;
    for (let c = 0; c < 4; c += 1) {
      for (let x = 0; x < width; ) {
        let count = byte();
        const isRun = count > 128;
        if (isRun) count -= 128;
        if (!count || x + count > width) throw new Error("a row of it is damaged");
        const value = isRun ? byte() : 0;
        for (; count; count -= 1, x += 1) row[4 * x + c] = isRun ? value : byte();
      }
    }
    return at;
  }
  for (let x = 0, shift = 0; x < width; ) {
    const pixel = [byte(), byte(), byte(), byte()] as const;
    if (pixel[0] !== 1 || pixel[1] !== 1 || pixel[2] !== 1) {
      row.set(pixel, 4 * x);
      x += 1;
      shift = 0;
      continue;
    }
    // The pixel before, so many times more.
    const count = pixel[3] * 2 ** shift;
    if (!x || x + count > width) throw new Error("a row of it is damaged");
    for (const end = x + count; x < end; x += 1) row.copyWithin(4 * x, 4 * x - 4, 4 * x);
    shift += 8;
  }
  return at;
}
