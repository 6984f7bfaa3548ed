/** The small panel: exposure, which light, overlays, times and counts. */

/** What the panel shows and sets. */
export interface PanelHost {
  exposure: number;
  mode: string;
  overlay: string;
  stats(): Stats | undefined;
}

/** Figures of the viewer: times per pass where the device can tell them, counts, bytes, the adapter. */
export interface Stats {
  /** The graphics adapter's name. */
  adapter?: string;
  /** Milliseconds of each pass of the last frame, by name; absent where the device cannot time. */
  passes?: Record<string, number>;
  /** Milliseconds of the last frame, all passes. */
  frame_ms?: number;
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
    if (!this.element.open || (!now && performance.now() - this.#shownAt < 250)) return;
    this.#shownAt = performance.now();
    const stats = this.#host.stats();
    if (!stats) return;
    const { adapter, passes, frame_ms, ...counts } = stats;
    const times = Object.entries(passes ?? {}).map(([name, ms]) => [name, `${ms.toFixed(2)} ms`] as const);
    const sum = frame_ms ?? Object.values(passes ?? {}).reduce((a, b) => a + b, 0);
    fill(this.#times, "Time per pass", times.length ? [...times, ["together", `${sum.toFixed(2)} ms`]] : []);
    fill(this.#counts, "In this scene", rows(counts));
    this.#adapter.textContent = adapter ?? "";
  }
}

/** Figures as rows; nested objects and lists are spelt out. */
function rows(figures: Record<string, unknown>): [string, string][] {
  return Object.entries(figures).flatMap(([key, value]): [string, string][] => {
    const name = key.replaceAll("_", " ");
    if (typeof value === "number") return [[name, key.includes("bytes") ? bytes(value) : value.toLocaleString()]];
    if (Array.isArray(value)) return [[name, value.map((part) => Number(part).toLocaleString()).join(" / ")]];
    if (value && typeof value === "object") return rows(value as Record<string, unknown>);
    return [];
  });
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
