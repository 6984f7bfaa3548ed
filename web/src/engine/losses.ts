/** Lost devices: whether another one is worth a try. */

/** Of so many devices lost within this time, milliseconds, the last one is given up. */
const MANY = 4;
const LATELY_MS = 60_000;

/** Those that one element has lost. */
export class Losses {
  #lately: number[] = [];

  /** One more, now; false where there were too many. */
  next(now = performance.now()): boolean {
    this.#lately = [...this.#lately.filter((at) => now - at < LATELY_MS), now];
    return this.#lately.length < MANY;
  }
}
