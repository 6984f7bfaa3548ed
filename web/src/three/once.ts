/** Sentences for the console, each said once. */

/** Says a sentence once for each object. */
export class Once {
  #said = new WeakMap<object, Set<string>>();

  warn(about: object, sentence: string): void {
    const said = this.#said.get(about) ?? new Set();
    this.#said.set(about, said);
    if (said.has(sentence)) return;
    said.add(sentence);
    console.warn(`rebounce: ${sentence}`);
  }
}
