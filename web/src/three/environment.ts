/** A picture of all directions that three.js has loaded, as that of a file's environment. */

import { DataUtils, FloatType, HalfFloatType, type DataTexture } from "three/webgpu";
import { checkSize, pack, type Picture } from "../environment/picture.js";
import { Failure } from "../wire/failure.js";

/** Packs an equirectangular texture of floats, as three's loaders of .hdr and .exr give it. Throws `bad-environment` for another. */
export function pictureOf({ image, type, flipY }: DataTexture): Picture {
  const { data, width, height } = image as { data?: Float32Array | Uint16Array; width: number; height: number };
  const channels = (data?.length ?? 0) / (width * height);
  const value = type === HalfFloatType ? DataUtils.fromHalfFloat : type === FloatType ? (x: number) => x : undefined;
  try {
    if (!data || !value || !(channels >= 3)) throw new Error("it must be a DataTexture of floats, RGB or RGBA");
    checkSize(width, height);
    return pack(width, height, (y, row) => {
      const first = channels * width * (flipY ? y : height - 1 - y);
      for (let x = 0; x < width; x += 1) {
        for (let c = 0; c < 3; c += 1) row[3 * x + c] = value(data[first + channels * x + c] as number);
      }
    });
  } catch (error) {
    throw new Failure("bad-environment", `The environment cannot be used: ${(error as Error).message}.`, { cause: error });
  }
}
