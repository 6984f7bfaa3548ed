/** Textures of floats, for `load` in shaders. */

import { DataTexture, ExternalTexture, FloatType, NearestFilter, NoColorSpace, RGBAFormat } from "three/webgpu";

/** A texture of the device, for three.js to read with `load`. */
export function external(texture: unknown): ExternalTexture {
  const { width, height } = texture as { width: number; height: number };
  const made = new ExternalTexture(texture as never);
  const plain = { type: FloatType, minFilter: NearestFilter, magFilter: NearestFilter, generateMipmaps: false };
  Object.assign(made, { ...plain, colorSpace: NoColorSpace, image: { width, height } });
  made.needsUpdate = true;
  return made;
}

/** A texture of these RGBA texels. */
export function data(texels: Float32Array<ArrayBuffer>, width: number, height: number): DataTexture {
  const texture = new DataTexture(texels, width, height, RGBAFormat, FloatType);
  texture.needsUpdate = true;
  return texture;
}

/** Texture of nothing, until there is something. */
export const nothing = (): DataTexture => data(new Float32Array(4), 1, 1);
