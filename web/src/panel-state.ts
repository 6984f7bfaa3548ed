/** The panel's row for the state: save and load SHOT.json, copy a link. */

import { make } from "./element.js";
import { failureOf, sentence } from "./failure.js";
import type { Section } from "./panel.js";
import type { RebounceViewer } from "./rebounce-viewer.js";
import type { Shot } from "./shot.js";

/** `say` tells how it went. */
export function stateRow(host: RebounceViewer, say: (text: string) => void): Section {
  const button = (text: string, work: () => void) => {
    const element = make("button", { type: "button" }, text);
    element.addEventListener("click", work);
    return element;
  };
  const file = make("input", { type: "file", accept: ".json,application/json" });
  const link = make("input", { type: "text", readonly: "", "aria-label": "Link" });
  link.hidden = true;

  const save = () => {
    const blob = new Blob([`${JSON.stringify(host.shot, undefined, 2)}\n`], { type: "application/json" });
    const href = URL.createObjectURL(blob);
    make("a", { href, download: "shot.json" }).click();
    // The browser has the file by then.
    setTimeout(() => URL.revokeObjectURL(href), 10_000);
    say("Camera and lights are saved in shot.json.");
  };
  const load = async (chosen: File) => {
    try {
      host.shot = JSON.parse(await chosen.text()) as Shot;
      say(`Camera and lights of ${chosen.name} are set.`);
    } catch (error) {
      say(`${chosen.name} cannot be used. ${sentence(failureOf(error).message)} Choose a file that Save has made.`);
    }
  };
  const copy = async () => {
    link.value = host.stateLink();
    try {
      await navigator.clipboard.writeText(link.value);
      say("The link is copied.");
    } catch {
      link.hidden = false;
      link.select();
      say("Copy the link from the field.");
    }
  };
  file.addEventListener("change", () => {
    const chosen = file.files?.[0];
    if (chosen) void load(chosen);
    file.value = "";
  });
  const buttons = [
    button("Save", save),
    make("label", { class: "button" }, "Load", file),
    button("Copy link", () => void copy()),
  ];
  return { element: make("div", { class: "state" }, ...buttons, link), update: () => undefined };
}
