/** Parts that the panel's sections are made of. */

import { make } from "../element/element.js";

/** Lines of 24 by 24 units. */
export const ICONS = {
  settings: "M3 7h10M19 7h2M3 17h4M13 17h8M16 4v6M10 14v6",
  close: "M6 6l12 12M18 6L6 18",
  full: "M4 9V4h5M15 4h5v5M20 15v5h-5M9 20H4v-5",
  undo: "M9 5L4 10l5 5M4 10h10a5 5 0 0 1 0 10h-3",
  redo: "M15 5l5 5-5 5M20 10H10a5 5 0 0 0 0 10h3",
};

/** A drawing for who sees it. */
export function icon(name: keyof typeof ICONS): SVGElement {
  const of = (tag: "svg" | "path") => document.createElementNS("http://www.w3.org/2000/svg", tag);
  const [svg, path] = [of("svg"), of("path")];
  for (const [key, value] of Object.entries({ viewBox: "0 0 24 24", "aria-hidden": "true", class: name })) svg.setAttribute(key, value);
  path.setAttribute("d", ICONS[name]);
  svg.append(path);
  return svg;
}

/** A button that does something. */
export function button(content: Node | string, work: () => void, attributes: Record<string, string> = {}): HTMLButtonElement {
  const element = make("button", { type: "button", ...attributes }, content);
  element.addEventListener("click", work);
  return element;
}

/** A slider below its name and its value in words. */
export interface Slider {
  readonly element: HTMLElement;
  /** Shows a value; the text in place of its digits, and another name. */
  show(value: number, text: string, name?: string): void;
}

/** `reset` is what a double click or the key 0 does. */
export function slider(
  name: string,
  limits: { min: number; max: number; step: number },
  set: (value: number) => void,
  reset?: () => void,
): Slider {
  const input = make("input", { type: "range", "aria-label": name });
  for (const [key, value] of Object.entries(limits)) input.setAttribute(key, String(value));
  const text = make("span", { "aria-hidden": "true" });
  input.addEventListener("input", () => set(input.valueAsNumber));
  if (reset) {
    input.title = "Double-click, or the key 0: as it was";
    input.addEventListener("dblclick", reset);
    input.addEventListener("keydown", ({ key }) => key === "0" && reset());
  }
  const element = make("div", {}, make("div", { class: "row" }, make("span", { "aria-hidden": "true" }, name), text), input);
  return {
    element,
    show(value, words, name) {
      if (name) input.ariaLabel = name;
      input.value = String(value);
      text.textContent = words;
      input.setAttribute("aria-valuetext", words);
    },
  };
}

/** A number with a sign. */
export const signed = (value: number): string => (value < 0 ? "\u2212" : "+") + Math.abs(value).toFixed(1);
