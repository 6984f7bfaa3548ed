// A KTX2 texture as users have them: Basis Universal, UASTC, to be transcoded in the page.

import { createDefaultContainer, KHR_DF_MODEL_UASTC, KHR_DF_PRIMARIES_BT709, KHR_DF_TRANSFER_SRGB, write } from "three/examples/jsm/libs/ktx-parse.module.js";

/** UASTC's mode of blocks of one colour, and the bits of its number (UASTC LDR 4 × 4, "void extent"). */
const MODE = [0x17, 5];
const BLOCK_BYTES = 16;
const SIDE = 8;

/** A block of 4 × 4 texels of one opaque colour, bytes. The hints for ETC stay zero. */
function block(colour) {
  const bits = [MODE, ...[...colour, 255].map((part) => [part, 8])].flatMap(([value, length]) =>
    Array.from({ length }, (_, i) => (value >> i) & 1));
  return Array.from({ length: BLOCK_BYTES }, (_, i) => bits.slice(8 * i, 8 * i + 8).reduce((byte, bit, k) => byte | (bit << k), 0));
}

/** A square texture of one sRGB colour, as base64. */
export function solidKtx2(colour) {
  const container = createDefaultContainer();
  Object.assign(container, { pixelWidth: SIDE, pixelHeight: SIDE, levelCount: 1 });
  const [descriptor] = container.dataFormatDescriptor;
  Object.assign(descriptor, {
    colorModel: KHR_DF_MODEL_UASTC,
    colorPrimaries: KHR_DF_PRIMARIES_BT709,
    transferFunction: KHR_DF_TRANSFER_SRGB,
    texelBlockDimension: [3, 3, 0, 0],
    bytesPlane: [BLOCK_BYTES, 0, 0, 0, 0, 0, 0, 0],
    samples: [{ bitOffset: 0, bitLength: 127, channelType: 0, samplePosition: [0, 0, 0, 0], sampleLower: 0, sampleUpper: 0xffffffff }],
  });
  const levelData = Uint8Array.from(Array.from({ length: (SIDE / 4) ** 2 }, () => block(colour)).flat());
  container.levels = [{ levelData, uncompressedByteLength: levelData.byteLength }];
  return Buffer.from(write(container)).toString("base64");
}
