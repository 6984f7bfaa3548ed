/** The panel's section for the camera: the first view, and those of the file. */

import { make } from "./element.js";
import type { Desk, Section } from "./panel.js";
import { button } from "./panel-parts.js";
import type { Camera } from "./shot.js";

/** What the element knows of its views. */
interface Views {
  readonly cameras: readonly (Camera & { name?: string })[];
  resetView(): void;
}

/** Views to go to. */
export function views({ host }: Desk): Section {
  const element = make("div", { class: "buttons" });
  let shown = "";
  const update = () => {
    const { cameras } = host as unknown as Views;
    const named = cameras.length > 1 ? cameras.map(({ name }, i) => name || `Camera ${i + 1}`) : [];
    if (shown === (shown = named.join("\n")) && element.firstChild) return;
    const first = button("First view (R)", () => (host as unknown as Views).resetView());
    const others = named.map((name, i) => button(name, () => (host.camera = (host as unknown as Views).cameras[i] as Camera)));
    element.replaceChildren(first, ...others);
  };
  return { element, update };
}
