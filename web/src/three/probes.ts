/** Probes of a file: bounced light in the air, for what the bake does not know. */

import { Vector3, type Texture } from "three/webgpu";
import type { BouncedLight, Probes as Made } from "../rebounce_three.js";
import { irradianceOf, type ProbeGrid } from "./probe-grid.js";
import { data, external } from "./textures.js";

/** How probes are made. */
export interface ProbeOptions {
  /** Distance between probes, in the file's unit; as far as suits the scene when absent. */
  spacing?: number;
}

/** What is read of probes: for other renderers. */
export interface ProbeData extends ProbeGrid {
  /** Radiance: nine coefficients by probe, RGB and a zero each, in the order of three.js' `SphericalHarmonics3`. */
  radiance: Float32Array;
}

/** Lets the page do other things. */
const pause = (): Promise<void> => new Promise((done) => setTimeout(done));

/** The three textures of probes, as three.js has them. */
export type ProbeTextures = readonly [radiance: Texture, planes: Texture, moved: Texture];

/** Probes, once they are made. */
export class Probes {
  readonly #made: Made;
  /** Where they are, and what surfaces they see. */
  readonly grid: ProbeGrid;
  /** For shaders. */
  readonly textures: ProbeTextures;
  /** Texels that are read back into, where the renderer has no WebGPU. */
  readonly #copies: boolean;
  #lit = -1;
  #reading = false;

  /** Makes probes in the background; none where a scene is too large for them. */
  static async make(light: BouncedLight, { spacing = 0 }: ProbeOptions, copies: boolean): Promise<Probes | undefined> {
    const made = await light.probes(spacing, pause);
    return made && new Probes(made, light.origin(), copies);
  }

  private constructor(made: Made, origin: Float64Array, copies: boolean) {
    this.#made = made;
    this.#copies = copies;
    const [x = 0, y = 0, z = 0, spacing = 1, ...counts] = made.grid();
    const [width = 1, height = 1, depth = 1] = counts;
    const [ox = 0, oy = 0, oz = 0] = origin;
    this.grid = { origin: [ox, oy, oz], first: new Vector3(x, y, z), spacing, counts: [width, height, depth], planes: made.planes(), moves: made.moves() };
    this.textures = (copies ? this.#dataTextures() : made.textures().map(external)) as unknown as ProbeTextures;
  }

  /** Brings the radiance up to date with the light, of this number; `copied` is told where it is read back. */
  update(lit: number, copied: (radiance: Float32Array) => void): void {
    if (this.#lit === lit || this.#reading) return;
    this.#lit = lit;
    this.#made.fill();
    if (this.#copies) void this.#copy(copied);
  }

  /** Reads everything: for other renderers. */
  async read(): Promise<ProbeData> {
    return { ...this.grid, radiance: await this.#made.read() };
  }

  /** Bytes on the GPU. */
  get bytes(): number {
    return this.#made.bytes();
  }

  /** Frees textures and buffers. */
  dispose(): void {
    for (const texture of this.textures) texture.dispose();
    this.#made.free();
  }

  /** Textures of a renderer without our device: as `fill` of the wasm module arranges them. */
  #dataTextures(): ProbeTextures {
    const { counts, planes, moves } = this.grid;
    const rows = Math.ceil((counts[0] * counts[1] * counts[2]) / PER_ROW);
    const side = PLANES;
    return [
      data(new Float32Array(4 * PER_ROW * 9 * rows), PER_ROW * 9, rows),
      data(arranged(planes, side, rows), PER_ROW * side, rows * side),
      data(arranged(moves, 1, rows), PER_ROW, rows),
    ];
  }

  async #copy(copied: (radiance: Float32Array) => void): Promise<void> {
    this.#reading = true;
    try {
      const radiance = await this.#made.read();
      const [texture] = this.textures;
      (texture.image as { data: Float32Array }).data.set(radiance.subarray(0, (texture.image as { data: Float32Array }).data.length));
      texture.needsUpdate = true;
      copied(radiance);
    } catch {
      // The device is lost, or the probes are disposed.
    } finally {
      this.#reading = false;
    }
  }
}

/** Probes in a row of the textures, and texels along a side of a map of planes: as probes/fill.rs and probes/rows.rs. */
export const PER_ROW = 64;
export const PLANES = 16;

/** Maps of `side` × `side` texels, probe by probe, as rows of a texture with `PER_ROW` maps side by side. */
function arranged(maps: Float32Array, side: number, rows: number): Float32Array<ArrayBuffer> {
  const width = PER_ROW * side;
  const out = new Float32Array(4 * width * rows * side);
  const texels = side * side;
  for (let i = 0; i < maps.length / 4; i += 1) {
    const probe = Math.floor(i / texels);
    const y = Math.floor((i % texels) / side);
    const at = (Math.floor(probe / PER_ROW) * side + y) * width + (probe % PER_ROW) * side + (i % side);
    out.set(maps.subarray(4 * i, 4 * i + 4), 4 * at);
  }
  return out;
}

/** Irradiance at a place with a unit normal, in the file's local space, from what was read. */
export function irradianceAt(data: ProbeData, place: Vector3, normal: Vector3): Vector3 {
  return irradianceOf(data, data.radiance, place, normal);
}
