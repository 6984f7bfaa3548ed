/** The panel's section for the camera: the first view, and those of the file. */

import { make } from "./element.js";
import type { Desk, Section } from "./panel.js";
import { button } from "./panel-parts.js";

/** Views to go to. */
export function views({ host }: Desk): Section {
  const element = make("div", { class: "buttons" });
  let shown = "";
  const update = () => {
    const cameras = host.cameras.length > 1 ? host.cameras : [];
    if (shown === (shown = cameras.map(({ name }) => name).join("\n")) && element.firstChild) return;
    const first = button("First view (R)", () => host.resetView());
    const others = cameras.map(({ name, camera }) => button(name, () => (host.camera = camera)));
    element.replaceChildren(first, ...others);
  };
  return { element, update };
}
