/** What a frame costs, as tables. */

import { make } from "../element/element.js";
import type { Section } from "./panel.js";
import type { RebounceViewer } from "../rebounce-viewer.js";

type Line = readonly [name: string, value: string];

/** Times, counts and bytes; at most four times a second. */
export class Figures implements Section {
  #host: RebounceViewer;
  #times = make("table");
  #counted = make("table");
  #scene = make("table");
  #bytes = make("table");
  #adapter = make("p", { class: "adapter" });
  readonly element = make("div", { class: "stack" }, this.#times, this.#counted, this.#scene, this.#bytes, this.#adapter);
  #shownAt = 0;
  #later = 0;

  constructor(host: RebounceViewer) {
    this.#host = host;
  }

  /** Follows the viewer. */
  update(now: boolean): void {
    clearTimeout(this.#later);
    // The GPU tells its times after the frame, and the last frame of a motion is to be seen, too.
    if (!now) this.#later = setTimeout(() => this.element.checkVisibility() && this.update(true), 300);
    if (!now && performance.now() - this.#shownAt < 250) return;
    this.#shownAt = performance.now();
    const stats = this.#host.stats();
    if (!stats) return;
    const passes = Object.entries(stats.milliseconds);
    const together = passes.reduce((sum, [, ms]) => sum + ms, 0);
    const times = [...passes, ["together", together] as const].map(([name, ms]): Line => [words(name), `${ms.toFixed(2)} ms`]);
    fill(this.#times, "GPU time per pass", passes.length > 0 ? times : []);
    fill(this.#scene, "In this scene", [
      ["triangles", count(stats.triangles)],
      ["functions", count(sum(stats.functions))],
      ...stats.functions.map((functions, level): Line => [`\u2003level ${level}`, count(functions)]),
      ["links applied", count(stats.links)],
      ["lights", count(stats.lights)],
      ["frames drawn", count(stats.frames)],
      ["light computed", count(stats.relights)],
    ]);
    const bytes = Object.entries(stats.bytes);
    const all: Line = ["together", size(sum(bytes.map(([, n]) => n)))];
    fill(this.#bytes, "On the GPU", [...bytes.map(([name, n]): Line => [words(name), size(n)]), all]);
    this.#adapter.textContent = stats.adapter;
    // Counting reads the GPU back: only when the picture stands still.
    if (now) void this.#count();
  }

  async #count(): Promise<void> {
    // A scene that is gone meanwhile has no counts.
    const counts = await this.#host.counts().catch(() => undefined);
    fill(this.#counted, "In this picture", Object.entries(counts ?? {}).map(([name, value]): Line => [words(name), count(value)]));
  }
}

const sum = (numbers: number[]) => numbers.reduce((a, b) => a + b, 0);
const count = (value: number) => value.toLocaleString(undefined, { maximumFractionDigits: 2 });
const size = (bytes: number) => (bytes < 1e6 ? `${(bytes / 1e3).toFixed(0)} kB` : `${(bytes / 1e6).toFixed(1)} MB`);

/** camelCase as words. */
const words = (name: string) => name.replace(/[A-Z]/g, (letter) => ` ${letter.toLowerCase()}`);

function fill(table: HTMLTableElement, title: string, rows: readonly Line[]): void {
  table.hidden = rows.length === 0;
  table.replaceChildren(
    make("caption", {}, title),
    ...rows.map(([name, value]) => make("tr", {}, make("th", { scope: "row" }, name), make("td", {}, value))),
  );
}
