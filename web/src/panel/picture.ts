/** The panel's section for the picture: exposure, tone mapping, which light, what lies over it. */

import { make } from "../element/element.js";
import type { Desk, Section } from "./panel.js";
import { signed, slider } from "./parts.js";
import type { RebounceViewer } from "../rebounce-viewer.js";

/** Choices by the name of their property. */
const CHOICES = {
  mode: ["Light", { all: "Both", direct: "Direct", indirect: "Indirect" }],
  toneMapping: ["Tone mapping", { agx: "AgX", neutral: "Neutral" }],
  solver: ["Bounced light by", { auto: "Auto", operator: "Links", radiosity: "Rays", antiradiance: "Antiradiance" }],
  overlay: ["Show light points", { none: "None", points: "Points", levels: "Levels" }],
} as const;

/** Settings of the picture. */
export function picture({ host }: Desk): Section {
  const limits = { min: -6, max: 6, step: 0.1 };
  const exposure = slider("Exposure", limits, (value) => (host.exposure = value), () => (host.exposure = 0));
  const auto = make("input", { type: "checkbox" });
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
    return { name, element: make("fieldset", {}, make("legend", {}, title), make("div", { class: "choices" }, ...labels)) };
  });
  const automatic = make("label", { class: "check" }, auto, "Automatic exposure");
  const update = () => {
    exposure.show(host.exposure, `${signed(host.exposure)} EV`);
    auto.checked = host.autoExposure;
    for (const [input, name] of inputs) input.checked = input.value === host[name];
    for (const { name, element } of choices) element.hidden = name === "solver" && !moves(host);
  };
  return { element: make("div", { class: "stack" }, exposure.element, automatic, ...choices.map(({ element }) => element)), update };
}

/** Whether anything of the file moves or deforms: else one solver is all there is. */
function moves({ nodes, animations }: RebounceViewer): boolean {
  return Object.keys(nodes).length > 0 || animations.some(({ tracks }) => tracks.some(({ property }) => property === "pose"));
}
