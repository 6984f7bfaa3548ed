/** Bounced light at the pixels of a target of three.js: positions, and the texture of irradiance that follows from them. */

import type { Camera, ExternalTexture, RenderTarget, Scene, Texture, WebGPURenderer } from "three/webgpu";
import type { BouncedLight, View } from "../rebounce_three.js";
import type { Objects } from "./objects.js";
import { Positions } from "./positions.js";
import type { Space } from "./space.js";
import { external } from "./textures.js";

/** What pictures need, of all targets. */
export interface PixelSources {
  light: BouncedLight;
  space: Space;
  objects: Objects;
  positions: Positions;
  /** Number of the light's last change. */
  lit: number;
  /** Whether every pixel is looked up by itself. */
  everyPixel: boolean;
  /** Whether openness of pixels modulates the light. */
  detail: boolean;
}

/** The GPU's texture behind one of three's. */
const gpuTexture = (renderer: WebGPURenderer, texture: Texture) =>
  (renderer.backend as unknown as { get(of: Texture): { texture: object } }).get(texture).texture;

/** The light of one target. */
export class Pixels {
  readonly #target: RenderTarget;
  readonly #view: View;
  /** Bounced irradiance by pixel. */
  readonly irradiance: ExternalTexture;
  #drawn: number[] = [];
  #lit = -1;

  constructor(
    renderer: WebGPURenderer,
    { light, everyPixel }: PixelSources,
    readonly width: number,
    readonly height: number,
  ) {
    this.#target = Positions.target(width, height);
    renderer.initRenderTarget(this.#target);
    this.#view = light.view(gpuTexture(renderer, this.#target.texture), width, height, everyPixel);
    this.irradiance = external(this.#view.texture());
    this.irradiance.name = "rebounce irradiance";
  }

  /** Places and normals by pixel. */
  get places(): Texture {
    return this.#target.texture;
  }

  /** Bytes on the GPU. */
  get bytes(): number {
    return this.#view.bytes() + this.width * this.height * (16 + 4);
  }

  /** Brings it up to date with a camera and with the light: does only what has changed. */
  update(renderer: WebGPURenderer, scene: Scene, camera: Camera, from: PixelSources): void {
    const { objects, space, positions, lit, detail } = from;
    const { held, signature } = objects.held(scene);
    const now = [
      signature,
      Number(detail),
      ...camera.matrixWorld.elements,
      ...camera.projectionMatrix.elements,
      ...space.localFromWorld.elements,
    ];
    const moved = now.some((x, i) => x !== this.#drawn[i]);
    if (moved) {
      positions.draw(renderer, scene, camera, this.#target, held);
      this.#view.find(detail ? space.camera(camera) : new Float32Array());
      this.#drawn = now;
    }
    if (moved || this.#lit !== lit) {
      this.#view.gather();
      this.#lit = lit;
    }
  }

  /** Frees textures and buffers. */
  dispose(): void {
    this.#target.dispose();
    this.irradiance.dispose();
    this.#view.free();
  }
}
