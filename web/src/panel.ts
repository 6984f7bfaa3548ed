/** The panel: lights, picture, animation, state and figures of one element. Loaded when `controls` asks for it. */

import { make } from "./element.js";
import { Figures } from "./panel-figures.js";
import { LightList } from "./panel-lights.js";
import { playRow } from "./panel-play.js";
import { stateRow } from "./panel-state.js";
import { panelStyle } from "./panel-style.js";
import type { RebounceViewer } from "./rebounce-viewer.js";

/** A part of the panel, and how it follows the viewer. */
export interface Section {
  readonly element: HTMLElement;
  update(now: boolean): void;
}

/** Choices by the name of their property. */
const CHOICES = {
  mode: ["Light", { all: "Both", direct: "Direct", indirect: "Indirect" }],
  toneMapping: ["Tone mapping", { neutral: "Neutral", agx: "AgX" }],
  overlay: ["Show basis", { none: "None", points: "Points", levels: "Levels" }],
} as const;

/** The panel's elements and how they follow the viewer. */
export class Panel {
  readonly element: HTMLDetailsElement;
  #sections: Section[];

  constructor(host: RebounceViewer, root: ShadowRoot) {
    root.adoptedStyleSheets.push(panelStyle());
    // What has happened, for those who do not see it; errors for all.
    const status = make("p", { class: "status", role: "status" });
    const say = (text: string) => (status.textContent = text);
    this.#sections = [
      fold("Lights", new LightList(host, say), true),
      playRow(host),
      fold("Picture", picture(host), true),
      stateRow(host, say),
      fold("Figures", new Figures(host)),
    ];
    const form = make("form", {}, ...this.#sections.map(({ element }) => element), status);
    form.addEventListener("submit", (event) => event.preventDefault());
    this.element = make("details", { class: "panel", part: "panel" }, make("summary", {}, "Settings"), form);
    this.element.addEventListener("toggle", () => this.update(true));
  }

  /** Follows the viewer; figures at once with `now`. */
  update(now = false): void {
    if (this.element.open) for (const section of this.#sections) section.update(now);
  }
}

/** A section under a heading that opens and closes it; closed, it follows nothing. */
function fold(title: string, section: Section, open = false): Section {
  const element = make("details", { class: "section" }, make("summary", {}, title), section.element);
  element.open = open;
  element.addEventListener("toggle", () => element.open && section.update(true));
  return { element, update: (now) => element.open && section.update(now) };
}

/** Exposure, tone mapping, which light, what lies over the picture. */
function picture(host: RebounceViewer): Section {
  const exposure = make("input", { type: "range", id: "exposure", min: "-6", max: "6", step: "0.1" });
  const text = make("span");
  const auto = make("input", { type: "checkbox" });
  exposure.addEventListener("input", () => (host.exposure = exposure.valueAsNumber));
  auto.addEventListener("change", () => (host.autoExposure = auto.checked));
  const inputs: [HTMLInputElement, keyof typeof CHOICES][] = [];
  const choices = (Object.keys(CHOICES) as (keyof typeof CHOICES)[]).map((name) => {
    const [title, options] = CHOICES[name];
    const labels = Object.entries(options).map(([value, words]) => {
      const input = make("input", { type: "radio", name, value });
      input.addEventListener("change", () => Object.assign(host, { [name]: value }));
      inputs.push([input, name]);
      return make("label", {}, input, words);
    });
    return make("fieldset", {}, make("legend", {}, title), make("div", { class: "choices" }, ...labels));
  });
  const row = make("div", { class: "row" }, make("label", { for: "exposure" }, "Exposure"), text);
  const automatic = make("label", { class: "check" }, auto, "Automatic exposure");
  const update = () => {
    exposure.value = String(host.exposure);
    text.textContent = `${host.exposure > 0 ? "+" : ""}${host.exposure.toFixed(1)} EV`;
    exposure.setAttribute("aria-valuetext", text.textContent);
    auto.checked = host.autoExposure;
    for (const [input, name] of inputs) input.checked = input.value === host[name];
  };
  return { element: make("div", { class: "stack" }, make("div", {}, row, exposure), automatic, ...choices), update };
}
