/** The panel's section for the camera: the first view, and those of the file. */

import { make } from "../element/element.js";
import type { Desk, Section } from "./panel.js";
import { button } from "./parts.js";

/** Views to go to. */
export function views({ host }: Desk): Section {
  const buttons = make("div", { class: "buttons" });
  const hint = make("p", { class: "hint" }, "Drag to look; W A S D or arrows to move, the wheel to go ahead.");
  const element = make("div", { class: "stack" }, buttons, hint);
  let shown = "";
  const update = () => {
    const cameras = host.cameras.length > 1 ? host.cameras : [];
    if (shown === (shown = cameras.map(({ name }) => name).join("\n")) && buttons.firstChild) return;
    const first = button("First view (R)", () => host.resetView());
    const others = cameras.map(({ name, camera }) => button(name, () => (host.camera = camera)));
    buttons.replaceChildren(first, ...others);
  };
  return { element, update };
}
