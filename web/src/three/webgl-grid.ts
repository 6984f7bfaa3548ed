/** Probes for three's `WebGLRenderer`: a light that it takes for a `LightProbeGrid`, which has no planes to keep walls from leaking. */

import { Box3, Data3DTexture, DataUtils, HalfFloatType, Light, LinearFilter, RGBAFormat, Vector3 } from "three/webgpu";
import type { Probes } from "./probes.js";
import type { Space } from "./space.js";

/** Slices before and after each of the seven parts of the atlas. */
const PADDING = 1;

/** The light. */
export class WebGLGrid extends Light {
  readonly isLightProbeGrid = true;
  override readonly type = "RebounceWebGLGrid";
  readonly boundingBox = new Box3();
  readonly resolution = new Vector3(1, 1, 1);
  priority = 0;
  texture: Data3DTexture | null = null;

  constructor() {
    super(0xffffff, 1);
    this.name = "bounced light";
  }

  /** Takes over what probes hold now.
   * @internal */
  copyProbes(probes: Probes, radiance: Float32Array, space: Space): void {
    const { first, spacing, counts, moves } = probes.grid;
    const worldFromLocal = space.localFromWorld.clone().invert();
    const low = first.clone().subScalar(spacing / 2);
    this.boundingBox.set(low, low.clone().add(new Vector3(...counts).multiplyScalar(spacing))).applyMatrix4(worldFromLocal);
    this.resolution.set(...counts);
    const [width, height, depth] = counts;
    const slices = depth + 2 * PADDING;
    const texels = (this.texture?.image.data as Uint16Array<ArrayBuffer> | undefined) ?? new Uint16Array(4 * width * height * slices * 7);
    const free = freeProbes(counts, moves);
    for (let z = 0; z < slices; z += 1) {
      const from = Math.min(Math.max(z - PADDING, 0), depth - 1);
      for (let at = 0; at < width * height; at += 1) {
        const probe = free[from * width * height + at] as number;
        for (let number = 0; number < 27; number += 1) {
          const [part, channel] = [number >> 2, number & 3];
          const value = radiance[4 * (9 * probe + Math.floor(number / 3)) + (number % 3)] ?? 0;
          texels[4 * ((part * slices + z) * width * height + at) + channel] = DataUtils.toHalfFloat(Math.min(Math.max(value, -65504), 65504));
        }
      }
    }
    if (!this.texture) {
      const made = new Data3DTexture(texels, width, height, slices * 7);
      Object.assign(made, { format: RGBAFormat, type: HalfFloatType, minFilter: LinearFilter, magFilter: LinearFilter });
      this.texture = made;
    }
    this.texture.needsUpdate = true;
  }

  override dispose(): void {
    this.texture?.dispose();
    this.texture = null;
    super.dispose();
  }
}

/** By probe, itself or, within something solid, the nearest one along an axis that is not. */
function freeProbes([width, height, depth]: readonly [number, number, number], moves: Float32Array): number[] {
  const steps = [1, width, width * height] as const;
  const sizes = [width, height, depth] as const;
  return Array.from({ length: width * height * depth }, (_, probe) => {
    if (moves[4 * probe + 3]) return probe;
    for (let far = 1; far < Math.max(...sizes); far += 1) {
      for (const [axis, step] of steps.entries()) {
        const at = Math.floor(probe / step) % (sizes[axis] as number);
        if (at + far < (sizes[axis] as number) && moves[4 * (probe + far * step) + 3]) return probe + far * step;
        if (at - far >= 0 && moves[4 * (probe - far * step) + 3]) return probe - far * step;
      }
    }
    return probe;
  });
}
