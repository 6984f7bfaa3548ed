/** What the baker's WebAssembly calls: `CommandHost` and `LineHost` of baker/wasm. */

import { closeSync, existsSync, openSync, readdirSync, readFileSync, readSync, realpathSync, statSync } from "node:fs";
import path from "node:path";
import { Host } from "../../../../web/src/bake/host.js";
import { placeProblem } from "../write.js";
import type { CommandTold } from "./messages.js";

/** A worker's side of a bake, with the files that the command names. */
export class CommandHost extends Host {
  readonly #rank: number;
  readonly #files: ReadonlyMap<string, Uint8Array>;
  readonly #tellAll: (message: CommandTold) => void;

  constructor(
    rank: number,
    ports: readonly (MessagePort | null)[],
    files: readonly [path: string, bytes: Uint8Array][],
    tell: (message: CommandTold, transfer?: ArrayBuffer[]) => void,
    failed: (message: string) => void,
  ) {
    super(rank, ports, tell as ConstructorParameters<typeof Host>[2], failed);
    this.#rank = rank;
    this.#files = new Map(files.map(([name, bytes]) => [path.resolve(name), bytes]));
    this.#tellAll = tell;
  }

  processor(): number {
    const { user, system } = process.cpuUsage();
    return (user + system) * 1e-3;
  }

  line(text: string, isJson: boolean): void {
    if (this.#rank === 0) this.#tellAll({ type: "line", text, isJson });
  }

  note(sentence: string): void {
    if (this.#rank === 0) this.#tellAll({ type: "note", sentence });
  }

  read(file: string): Uint8Array {
    return this.#files.get(path.resolve(file)) ?? readFileSync(file);
  }

  exists(file: string): boolean {
    const whole = path.resolve(file);
    return existsSync(file) || [...this.#files.keys()].some((name) => name === whole || name.startsWith(whole + path.sep));
  }

  names(folder: string): string[] {
    const whole = path.resolve(folder);
    const within = [...this.#files.keys()].filter((name) => name.startsWith(whole + path.sep));
    const kept = within.map((name) => name.slice(whole.length + 1).split(path.sep)[0] ?? "");
    return [...kept, ...(statSync(whole, { throwIfNoEntry: false })?.isDirectory() ? readdirSync(whole) : [])];
  }

  firstBytes(file: string, count: number): Uint8Array | undefined {
    const kept = this.#files.get(path.resolve(file));
    if (kept) return kept.length < count ? undefined : kept.subarray(0, count);
    if (!statSync(file, { throwIfNoEntry: false })?.isFile()) return undefined;
    const bytes = new Uint8Array(count);
    const handle = openSync(file, "r");
    try {
      return readSync(handle, bytes) === count ? bytes : undefined;
    } finally {
      closeSync(handle);
    }
  }

  isSame(a: string, b: string): boolean {
    return a === b || (existsSync(a) && existsSync(b) && realpathSync(a) === realpathSync(b));
  }

  checkPlace(file: string): string | undefined {
    return placeProblem(file);
  }
}
