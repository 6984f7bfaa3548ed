/** Messages between the page and the workers of a bake. */

/** Starts the bake in a worker. */
export interface Start {
  /** This worker among all, from 0. */
  rank: number;
  /** Number of workers. */
  size: number;
  /** Channels to the other workers, by rank; none to itself. */
  ports: (MessagePort | null)[];
  /** Path of the scene's file. */
  path: string;
  /** The files by path: the scene's, and those that it refers to. */
  files: [path: string, bytes: Uint8Array][];
  /** `PageOptions` of baker/wasm, as JSON. */
  options: string;
  /** The baker. */
  module: WebAssembly.Module;
}

/** What a worker tells. */
export type Told =
  | { type: "progress"; stage: string; ratio: number; secondsLeft: number }
  | { type: "warning"; sentence: string }
  | { type: "preview"; file: Uint8Array }
  | { type: "done"; file: Uint8Array; report: string }
  | { type: "failed"; message: string };
