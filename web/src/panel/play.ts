/** The panel's row for animations: play and pause, which one, where it stands. */

import { make } from "../element/element.js";
import type { Section } from "./panel.js";
import type { RebounceViewer } from "../rebounce-viewer.js";

/** Hidden where there is nothing to play. */
export function playRow(host: RebounceViewer): Section {
  const button = make("button", { type: "button" });
  const names = make("select", { "aria-label": "Animation" });
  const time = make("input", { type: "range", min: "0", step: "any", "aria-label": "Time" });
  const text = make("span");
  button.addEventListener("click", () => (host.paused ? host.play() : host.pause()));
  names.addEventListener("change", () => (host.animationName = names.value));
  time.addEventListener("input", () => (host.currentTime = time.valueAsNumber));
  const element = make("div", { class: "play" }, button, names, time, text);
  const update = () => {
    const { animations, duration, currentTime, paused } = host;
    element.hidden = animations.length === 0;
    button.textContent = paused ? "Play" : "Pause";
    const listed = [...names.options].map(({ value }) => value);
    if (listed.join("\n") !== animations.map(({ name }) => name).join("\n")) {
      names.replaceChildren(...animations.map(({ name }) => make("option", { value: name }, name || "unnamed")));
    }
    names.hidden = animations.length < 2;
    names.value = host.animationName || (animations[0]?.name ?? "");
    time.max = String(duration);
    time.value = String(currentTime);
    text.textContent = `${currentTime.toFixed(1)} s`;
    time.setAttribute("aria-valuetext", `${currentTime.toFixed(1)} of ${duration.toFixed(1)} seconds`);
  };
  for (const type of ["play", "pause", "finished"] as const) host.addEventListener(type, update);
  return { element, update };
}
