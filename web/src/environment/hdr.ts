/** Reads Radiance pictures (.hdr). */

import { checkSize, pack, type Picture } from "./picture.js";

/** Radiance of a step, by the exponent of RGBE. */
const UNITS = Float64Array.from({ length: 256 }, (_, e) => e && 2 ** (e - 136));

/** Reads a file. Throws an error that says what is wrong with it. */
export function readHdr(bytes: Uint8Array): Picture {
  let at = 0;
  const line = () => {
    const end = bytes.indexOf(10, at);
    if (end < 0) throw new Error("it ends within its header");
    const text = String.fromCharCode(...bytes.subarray(at, Math.min(end, at + 999)));
    at = end + 1;
    return text.trim();
  };
  let [exposure, format] = [1, ""];
  for (let text = line(); text; text = line()) {
    const [name, value = ""] = text.split("=");
    if (name === "EXPOSURE") exposure *= Number(value);
    if (name === "FORMAT") format = value;
  }
  const [, rows, columns] = /^-Y (\d+) \+X (\d+)$/.exec(line()) ?? [];
  const [wide, tall] = [Number(columns), Number(rows)];
  if (format !== "32-bit_rle_rgbe" || !(exposure > 0) || !columns) throw new Error("it is of a form of .hdr that is not read");
  checkSize(wide, tall);
  const pixels = new Uint8Array(4 * wide);
  const picture = pack(wide, tall, (_, row) => {
    at = readRow(bytes, at, pixels, wide);
    for (let x = 0; x < wide; x += 1) {
      const unit = UNITS[pixels[4 * x + 3] as number] as number;
      for (let c = 0; c < 3; c += 1) row[3 * x + c] = (pixels[4 * x + c] as number) * unit;
    }
  });
  return { ...picture, scale: picture.scale / exposure };
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
