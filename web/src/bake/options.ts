/** What a caller asks of a bake, checked. */

/** How far a bake is. */
export interface BakeProgress {
  /** The stage of the bake, in words, such as "gathering links". */
  stage: string;
  /** Estimated share of the bake's time that has passed, from 0 to 1; never falls. */
  ratio: number;
  /** Estimated seconds until the bake ends. */
  secondsLeft: number;
}

/** Options of a bake. */
export interface BakeOptions {
  /** How good and how costly; "draft" when absent. */
  preset?: "draft" | "standard" | "fine";
  /** Seed of the random numbers; 1 when absent, as for the command. */
  seed?: number;
  /** About how many functions the finest level has; the preset's when absent. */
  functions?: number;
  /** What bounced light is computed from: links of things that stand still, or points alone, so that nodes may move; "operator" when absent. */
  solver?: "operator" | "radiosity";
  /** Reconstruction groups: nodes and materials by name, each with the number of functions for an area relative to other surfaces. Nodes among them may move. */
  groups?: Readonly<Record<string, number>>;
  /** Number of workers; as many as there are processor cores, and at most 8, when absent. */
  workers?: number;
  /** The file's name, which the .rbn file keeps; that of a `File`, otherwise "scene.glb", when absent. */
  name?: string;
  /** The files that a .gltf refers to, by their paths relative to it. */
  files?: Readonly<Record<string, Uint8Array | ArrayBuffer | Blob>>;
  /** Is called a few times a second. */
  onProgress?: (progress: BakeProgress) => void;
  /** Is called with .rbn files to show until the bake is done, each finer than the one before. */
  onPreview?: (file: Uint8Array) => void;
  /** Is called with sentences about what of the scene is left out or changed. */
  onWarning?: (sentence: string) => void;
  /** Is called at the end with the figures of the bake, as lines of text. */
  onReport?: (report: string) => void;
  /** Ends the bake and its workers. */
  signal?: AbortSignal;
}

const PRESETS = ["draft", "standard", "fine"];
/** Most functions, as the format's; largest density of a group, in either direction; most workers: each has a scene in memory. */
const MOST = { functions: 1 << 24, density: 1024, workers: 64, seed: Number.MAX_SAFE_INTEGER };

/** Returns the options with defaults. Throws a `TypeError` for what is none. */
export function checked(options: BakeOptions): BakeOptions & { preset: string; seed: number } {
  const { preset = "draft", seed = 1 } = options;
  if (!PRESETS.includes(preset)) {
    throw new TypeError(`bake: there is no preset ${JSON.stringify(preset)}; there are "draft", "standard" and "fine"`);
  }
  if (options.solver !== undefined && !["operator", "radiosity"].includes(options.solver)) {
    throw new TypeError(`bake: there is no solver ${JSON.stringify(options.solver)}; there are "operator" and "radiosity"`);
  }
  for (const [name, density] of Object.entries(options.groups ?? {})) {
    if (!(density >= 1 / MOST.density && density <= MOST.density)) {
      throw new TypeError(`bake: the density of group ${name} is a number from 1/${MOST.density} to ${MOST.density}, not ${String(density)}`);
    }
  }
  for (const [name, value, least] of [["seed", seed, 0], ["functions", options.functions, 1], ["workers", options.workers, 1]] as const) {
    if (value !== undefined && !(Number.isInteger(value) && value >= least && value <= MOST[name])) {
      throw new TypeError(`bake: ${name} is a whole number from ${least} to ${MOST[name]}, not ${String(value)}`);
    }
  }
  return { ...options, preset, seed };
}
