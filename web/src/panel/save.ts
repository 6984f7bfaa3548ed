/** The panel's section for what is kept: the picture as a file, camera and lights as SHOT.json, a link. */

import { make } from "../element/element.js";
import { failureOf, sentence } from "../wire/failure.js";
import type { Desk, Section } from "./panel.js";
import { button } from "./parts.js";
import type { Shot } from "../wire/shot.js";

/** Sizes of pictures: times that of the element's, or pixels. */
const SIZES = ["1", "2", "1920x1080", "3840x2160"];

/** Gives the user a file. */
function download(blob: Blob, name: string): void {
  const href = URL.createObjectURL(blob);
  make("a", { href, download: name }).click();
  // The browser has the file by then.
  setTimeout(() => URL.revokeObjectURL(href), 10_000);
}

/** Files and links to take along. */
export function saving({ host, root, say, history }: Desk): Section {
  const size = make("select", {}, ...SIZES.map((value) => make("option", { value })));
  const clear = make("input", { type: "checkbox" });
  const file = make("input", { type: "file", accept: ".json,application/json" });
  const link = make("input", { type: "text", readonly: "", "aria-label": "Link" });
  link.hidden = true;

  const pixels = (value: string): [number, number] => {
    const [a, b] = value.split("x").map(Number) as [number, number?];
    if (b) return [a, b];
    const { width, height } = root.querySelector("canvas") as HTMLCanvasElement;
    return [a * width, a * height];
  };
  const shoot = async () => {
    const [width, height] = pixels(size.value);
    say("Saving the picture…", true);
    try {
      download(await host.toBlob("image/png", undefined, { width, height, transparent: clear.checked }), "picture.png");
      say("The picture is saved in picture.png.");
    } catch (error) {
      say(`There is no picture of this size. ${sentence(failureOf(error).message)}`);
    }
  };
  const save = () => {
    download(new Blob([`${JSON.stringify(host.shot, undefined, 2)}\n`], { type: "application/json" }), "shot.json");
    say("Lights and camera are saved in shot.json.");
  };
  const load = async (chosen: File) => {
    try {
      const shot = JSON.parse(await chosen.text()) as Shot;
      history.by(() => (host.shot = shot));
      say(`Lights and camera of ${chosen.name} are set.`);
    } catch (error) {
      say(`${chosen.name} cannot be used. ${sentence(failureOf(error).message)} Choose a file that “Save lights” has made.`);
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
  const copying = button("Copy link", () => void copy(), { title: "An address of this page with lights and camera" });
  file.addEventListener("change", () => {
    const chosen = file.files?.[0];
    if (chosen) void load(chosen);
    file.value = "";
  });
  const element = make(
    "div",
    { class: "stack" },
    make("label", { class: "row" }, "Size", size),
    make("label", { class: "check" }, clear, "Transparent background"),
    button("Save picture", () => void shoot(), { title: "A PNG file" }),
    make(
      "div",
      { class: "buttons" },
      button("Save lights", save, { title: "Lights and camera as a JSON file" }),
      make("label", { class: "button" }, "Load lights", file),
      copying,
      link,
    ),
  );
  const update = () => {
    // Elsewhere nothing in the page would follow the link.
    copying.hidden = !host.stateInLink;
    for (const option of size.options) {
      const words = { 1: "As shown, ", 2: "Twice, " }[option.value] ?? "";
      option.textContent = words + pixels(option.value).join(" × ");
    }
  };
  return { element, update };
}
