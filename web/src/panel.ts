/** The small panel: exposure, which light, overlays, times and counts. */

/** What the panel shows and sets. */
export interface PanelHost {
  exposure: number;
  mode: string;
  overlay: string;
  stats(): Stats | undefined;
}

/** Figures of the viewer. */
export interface Stats {
  /** The graphics adapter's name. */
  adapter: string;
  /** The scene's name. */
  scene: string;
  /** Milliseconds of each pass when it last ran; absent where the device cannot time. */
  milliseconds: Record<string, number | null>;
  /** Pictures drawn so far. */
  frames: number;
  /** Times that light was computed anew. */
  relights: number;
  /** Triangles of the scene. */
  triangles: number;
  /** Basis functions per level, coarsest first. */
  functions: number[];
  /** Transport links. */
  links: number;
  /** Lights. */
  lights: number;
  /** Bytes on the GPU, by what they are for. */
  bytes: Record<string, number>;
  [figure: string]: unknown;
}

const MODES = { all: "Both", direct: "Direct", indirect: "Indirect" };
const OVERLAYS = { none: "None", points: "Points", levels: "Levels" };

function make<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Record<string, string> = {},
  ...children: (Node | string)[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

/** The panel's elements and how they follow the viewer. */
export class Panel {
  readonly element: HTMLDetailsElement;
  #host: PanelHost;
  #exposure: HTMLInputElement;
  #exposureText: HTMLOutputElement;
  #choices = new Map<string, HTMLInputElement[]>();
  #times: HTMLTableElement;
  #counts: HTMLTableElement;
  #adapter: HTMLParagraphElement;
  #shownAt = 0;
  #later = 0;

  constructor(host: PanelHost) {
    this.#host = host;
    this.#exposure = make("input", { type: "range", id: "exposure", min: "-6", max: "6", step: "0.1" });
    this.#exposureText = make("output", { for: "exposure" });
    this.#exposure.addEventListener("input", () => (host.exposure = this.#exposure.valueAsNumber));
    this.#times = make("table");
    this.#counts = make("table");
    this.#adapter = make("p", { class: "adapter" });
    const form = make(
      "form",
      {},
      make(
        "div",
        {},
        make("div", { class: "row" }, make("label", { for: "exposure" }, "Exposure"), this.#exposureText),
        this.#exposure,
      ),
      this.#choice("Light", "mode", MODES, (value) => (host.mode = value)),
      this.#choice("Show basis", "overlay", OVERLAYS, (value) => (host.overlay = value)),
      this.#times,
      this.#counts,
      this.#adapter,
    );
    form.addEventListener("submit", (event) => event.preventDefault());
    this.element = make("details", { class: "panel", part: "panel" }, make("summary", {}, "Settings"), form);
    this.element.addEventListener("toggle", () => this.update(true));
  }

  #choice(title: string, name: string, options: Record<string, string>, set: (value: string) => void): Node {
    const inputs: HTMLInputElement[] = [];
    const labels = Object.entries(options).map(([value, text]) => {
      const input = make("input", { type: "radio", name, value });
      input.addEventListener("change", () => set(value));
      inputs.push(input);
      return make("label", {}, input, text);
    });
    this.#choices.set(name, inputs);
    return make("fieldset", {}, make("legend", {}, title), make("div", { class: "choices" }, ...labels));
  }

  /** Follows the viewer; the figures at most four times a second unless `now`. */
  update(now = false): void {
    const { exposure, mode, overlay } = this.#host;
    this.#exposure.value = String(exposure);
    this.#exposureText.textContent = `${exposure > 0 ? "+" : ""}${exposure.toFixed(1)} EV`;
    for (const [name, value] of [
      ["mode", mode],
      ["overlay", overlay],
    ] as const) {
      for (const input of this.#choices.get(name) ?? []) input.checked = input.value === value;
    }
    clearTimeout(this.#later);
    if (!this.element.open) return;
    // The GPU tells its times after the frame, and the last frame of a motion is to be seen, too.
    if (!now) this.#later = setTimeout(() => this.update(true), 300);
    if (!now && performance.now() - this.#shownAt < 250) return;
    this.#shownAt = performance.now();
    const stats = this.#host.stats();
    if (!stats) return;
    const passes = Object.entries(stats.milliseconds).filter((pass): pass is [string, number] => pass[1] !== null);
    const together = passes.reduce((sum, [, ms]) => sum + ms, 0);
    const times = [...passes, ["together", together] as const].map(([name, ms]) => [words(name), `${ms.toFixed(2)} ms`] as const);
    fill(this.#times, "Time per pass", passes.length > 0 ? times : []);
    const count = (value: number) => value.toLocaleString();
    fill(this.#counts, "In this scene", [
      ["triangles", count(stats.triangles)],
      ["functions", count(stats.functions.reduce((a, b) => a + b, 0))],
      ...stats.functions.map((functions, level) => [`\u2003level ${level}`, count(functions)] as const),
      ["links", count(stats.links)],
      ["lights", count(stats.lights)],
      ["frames drawn", count(stats.frames)],
      ["light computed", count(stats.relights)],
      ...Object.entries(stats.bytes).map(([name, size]) => [`GPU, ${words(name)}`, bytes(size)] as const),
    ]);
    this.#adapter.textContent = stats.adapter;
  }
}

/** camelCase as words. */
function words(name: string): string {
  return name.replace(/[A-Z]/g, (letter) => ` ${letter.toLowerCase()}`);
}

function bytes(count: number): string {
  return count < 1e6 ? `${(count / 1e3).toFixed(0)} kB` : `${(count / 1e6).toFixed(1)} MB`;
}

function fill(table: HTMLTableElement, title: string, lines: readonly (readonly [string, string])[]): void {
  table.hidden = lines.length === 0;
  table.replaceChildren(
    make("caption", {}, title),
    ...lines.map(([name, value]) => make("tr", {}, make("th", { scope: "row" }, name), make("td", {}, value))),
  );
}
