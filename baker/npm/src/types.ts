/** What a bake takes and gives. */

import type { CommandOptions } from "./options.js";

/** A .glb or .gltf file: its path or file: address, or its bytes; or `builtin:NAME`. */
export type SceneSource = string | URL | Uint8Array | ArrayBuffer;

/** How far a bake is. */
export interface BakeProgress {
  /** The stage of the bake, in words, such as "gathering links". */
  stage: string;
  /** Estimated share of the bake's time that has passed, from 0 to 1; never falls. */
  ratio: number;
  /** Estimated seconds until the bake ends. */
  secondsLeft: number;
}

/** The figures of a bake, as `--report` writes them; some of them: */
export interface BakeReport {
  scene: string;
  preset: string;
  functions: number;
  links: number;
  file_bytes: number;
  [figure: string]: unknown;
}

/** What bakes. */
export type Program = "native" | "wasm";

/** Options of a bake: those of the command, and what is told. */
export interface BakeOptions extends CommandOptions {
  /** The file's name, for a scene that is given as bytes; "scene.glb" when absent. */
  name?: string;
  /** What a .gltf that is given as bytes refers to: files by their paths relative to it. */
  files?: Readonly<Record<string, Uint8Array | ArrayBuffer>>;
  /** What bakes; when absent the native program where there is one, or what the environment's REBOUNCE_PROGRAM says. */
  program?: Program;
  /** Is called at the beginning with what bakes. */
  onProgram?: (program: Program) => void;
  /** Is called a few times a second. */
  onProgress?: (progress: BakeProgress) => void;
  /** Is called with sentences about what of the scene is left out or changed, or is worth knowing. */
  onWarning?: (sentence: string) => void;
  /** Is called at the end with the figures of the bake. */
  onReport?: (report: BakeReport) => void;
  /** Ends the bake. */
  signal?: AbortSignal;
}

/** What bakes do alike, whatever program does them. */
export interface Call extends Pick<BakeOptions, "onProgress" | "onWarning" | "onReport" | "signal"> {
  /** The words of the command line, with the scene. */
  words: string[];
}
