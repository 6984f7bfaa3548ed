/** Reads OpenEXR pictures. Loaded when the first one is wanted. */

import parseExr from "parse-exr";
import { exrHeader } from "./exr-header.js";
import { checkSize, pack, type Picture } from "./picture.js";

/** What parse-exr calls its kinds of output. */
const [FLOAT, HALF] = [1015, 1016] as const;
/** More pixels for a byte of the file than any compression stores, but for small pictures. */
const [PIXELS_PER_BYTE, SMALL] = [1024, 1024 * 512];

/** Reads a file. Throws an error that says what is wrong with it. */
export function readExr(bytes: Uint8Array): Picture {
  const { wide, tall, isHalf } = exrHeader(bytes);
  checkSize(wide, tall);
  if (wide * tall > Math.max(PIXELS_PER_BYTE * bytes.length, SMALL)) throw new Error(`it claims ${wide} x ${tall} pixels in ${bytes.length} bytes`);
  let data: ArrayLike<number>;
  try {
    data = parseExr(bytes.buffer as ArrayBuffer, isHalf ? HALF : FLOAT).data;
  } catch (error) {
    throw new Error(`it is damaged, or too large (${(error as Error).message}): download it again`, { cause: error });
  }
  const floats = isHalf ? halves() : undefined;
  return pack(wide, tall, (y, row) => {
    // Four numbers a pixel, rows from the bottom.
    let from = 4 * wide * (tall - 1 - y);
    for (let x = 0; x < wide; x += 1, from += 4) {
      for (let c = 0; c < 3; c += 1) {
        const number = data[from + c] as number;
        row[3 * x + c] = floats ? (floats[number] as number) : number;
      }
    }
  });
}

/** All numbers of 16 bits. */
function halves(): Float32Array {
  return Float32Array.from({ length: 65_536 }, (_, bits) => {
    const [sign, exponent, part] = [bits >> 15 ? -1 : 1, (bits >> 10) & 31, bits & 1023];
    if (exponent === 31) return part ? NaN : sign * Infinity;
    return sign * (exponent ? 2 ** (exponent - 25) * (1024 + part) : 2 ** -24 * part);
  });
}
