/** Messages between the program and the workers of a bake. */

import type { Told } from "../../../../web/src/bake/messages.js";

/** Starts the bake in a worker. */
export interface CommandStart {
  /** This worker among all, from 0. */
  rank: number;
  /** Number of workers. */
  size: number;
  /** Channels to the other workers, by rank; none to itself. */
  ports: (MessagePort | null)[];
  /** The words of the command line. */
  words: string[];
  /** Files that are in memory and not on the disk, by path. */
  files: [path: string, bytes: Uint8Array][];
  /** The baker. */
  module: WebAssembly.Module;
}

/** What a worker tells. */
export type CommandTold =
  | Exclude<Told, { type: "done" }>
  | { type: "line"; text: string; isJson: boolean }
  | { type: "note"; sentence: string }
  | { type: "done"; file: Uint8Array; summary: string; report: string; lastLine: string };
