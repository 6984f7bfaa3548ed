/** What the baker's WebAssembly calls: `Host` of baker/wasm/src/worker.rs. */

import { fault } from "./fault.js";
import type { Told } from "./messages.js";

/** Messages of a worker in one exchange: to the first worker, and to all. */
type Letters = [Uint8Array, Uint8Array];

const NOTHING = new Uint8Array();

/** Carries progress to the page, and messages between the workers. */
export class Host {
  readonly #rank: number;
  readonly #ports: readonly (MessagePort | null)[];
  readonly #tell: (message: Told, transfer?: ArrayBuffer[]) => void;
  readonly #failed: (message: string) => void;
  /** Letters that have come, and who waits for one, by worker. */
  readonly #arrived: Letters[][];
  readonly #awaited: (((letters: Letters) => void) | undefined)[];

  constructor(
    rank: number,
    ports: readonly (MessagePort | null)[],
    tell: (message: Told, transfer?: ArrayBuffer[]) => void,
    failed: (message: string) => void,
  ) {
    this.#rank = rank;
    this.#ports = ports;
    this.#tell = tell;
    this.#failed = failed;
    this.#arrived = ports.map(() => []);
    this.#awaited = ports.map(() => undefined);
    for (const [member, port] of ports.entries()) {
      if (port) port.onmessage = ({ data }: MessageEvent<Letters>) => this.#arrive(member, data);
    }
  }

  now(): number {
    return performance.now();
  }

  progress(stage: string, ratio: number, secondsLeft: number): void {
    if (this.#rank === 0) this.#tell({ type: "progress", stage, ratio, secondsLeft });
  }

  preview(file: Uint8Array): void {
    this.#tell({ type: "preview", file }, [file.buffer as ArrayBuffer]);
  }

  warn(sentence: string): void {
    if (this.#rank === 0) this.#tell({ type: "warning", sentence });
  }

  panicked(why: string): void {
    this.#failed(fault(why));
  }

  /** Sends to the other workers, and waits for what they send in this exchange. */
  async exchange(toFirst: Uint8Array, toAll: Uint8Array): Promise<[Uint8Array[], Uint8Array[]]> {
    for (const [member, port] of this.#ports.entries()) {
      const letters: Letters = [member === 0 ? toFirst : NOTHING, toAll];
      port?.postMessage(letters);
    }
    const own: Letters = [toFirst, toAll];
    const all = await Promise.all(this.#ports.map((_, member) => (member === this.#rank ? own : this.#next(member))));
    return [this.#rank === 0 ? all.map(([first]) => first) : [], all.map(([, letter]) => letter)];
  }

  #next(member: number): Letters | Promise<Letters> {
    return this.#arrived[member]?.shift() ?? new Promise((resolve) => (this.#awaited[member] = resolve));
  }

  #arrive(member: number, letters: Letters): void {
    const awaited = this.#awaited[member];
    this.#awaited[member] = undefined;
    if (awaited) awaited(letters);
    else this.#arrived[member]?.push(letters);
  }
}
