/** Probes of a file: bounced light in the air, for what the bake does not know. */

import { Vector3, type Texture } from "three/webgpu";
import type { BouncedLight, Probes as Made } from "../rebounce_three.js";
import type { ProbeData, ProbeGrid, ProbeOptions } from "./probe-grid.js";
import { data, external } from "./textures.js";

/** Lets the page do other things. */
const pause = (): Promise<void> => new Promise((done) => setTimeout(done));

/** The three textures of probes, as three.js has them. */
export type ProbeTextures = readonly [radiance: Texture, planes: Texture, moved: Texture];

/** Probes of a file. */
export class Probes {
  readonly #made: Made;
  readonly #origin: readonly [number, number, number];
  /** Where they are, and what surfaces they see: nothing until they are built. */
  grid: ProbeGrid;
  /** For shaders: these ones for good, as three.js does not look again at the textures of things that rest. */
  readonly textures: ProbeTextures;
  /** Uploads texels that are read back, where the renderer has no WebGPU. */
  readonly #upload: ((texture: Texture) => void) | undefined;
  #lit = -1;
  #reading = false;
  #isBuilt = false;

  constructor(light: BouncedLight, { spacing = 0 }: ProbeOptions, upload?: (texture: Texture) => void) {
    this.#made = light.probes(spacing) as Made;
    this.#upload = upload;
    const [x = 0, y = 0, z = 0] = light.origin();
    this.#origin = [x, y, z];
    this.grid = this.#gridNow();
    this.textures = (upload ? this.#dataTextures() : this.#made.textures().map(external)) as unknown as ProbeTextures;
  }

  /** Finds what light they get; false where a scene is too large. */
  async build(): Promise<boolean> {
    if (!(await this.#made.build(pause))) return false;
    this.grid = this.#gridNow();
    const { planes, moves } = this.grid;
    if (this.#upload) {
      const [, ofPlanes, ofMoves] = this.textures;
      for (const [texture, texels, side] of [[ofPlanes, planes, PLANES], [ofMoves, moves, 1]] as const) {
        const { data } = texture.image as { data: Float32Array };
        data.set(arranged(texels, side, data.length / (4 * PER_ROW * side * side)));
        this.#put(texture);
      }
    }
    this.#isBuilt = true;
    return true;
  }

  #gridNow(): ProbeGrid {
    const [x = 0, y = 0, z = 0, spacing = 1, width = 1, height = 1, depth = 1] = this.#made.grid();
    const [planes, moves] = [this.#made.planes(), this.#made.moves()];
    return { origin: this.#origin, first: new Vector3(x, y, z), spacing, counts: [width, height, depth], planes, moves };
  }

  #put(texture: Texture): void {
    texture.needsUpdate = true;
    this.#upload?.(texture);
  }

  /** Brings the radiance up to date with the light, of this number; `copied` is told where it is read back. */
  update(lit: number, copied: (radiance: Float32Array) => void): void {
    if (!this.#isBuilt || this.#lit === lit || this.#reading) return;
    this.#lit = lit;
    this.#made.fill();
    if (this.#upload) void this.#copy(copied);
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
    const { counts } = this.grid;
    const rows = Math.ceil((counts[0] * counts[1] * counts[2]) / PER_ROW);
    const empty = (width: number, height: number) => data(new Float32Array(4 * width * height), width, height);
    return [empty(PER_ROW * 9, rows), empty(PER_ROW * PLANES, rows * PLANES), empty(PER_ROW, rows)];
  }

  async #copy(copied: (radiance: Float32Array) => void): Promise<void> {
    this.#reading = true;
    try {
      const radiance = await this.#made.read();
      const [texture] = this.textures;
      (texture.image as { data: Float32Array }).data.set(radiance);
      this.#put(texture);
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
