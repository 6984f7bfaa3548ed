/** The panel: lights, camera, picture, animation, figures, files of one element. Loaded when `controls` asks for it. */

import { make } from "../element/element.js";
import type { History } from "../engine/history.js";
import { views } from "./camera.js";
import { Figures } from "./figures.js";
import { LightList } from "./lights.js";
import { button, icon } from "./parts.js";
import { picture } from "./picture.js";
import { playRow } from "./play.js";
import { saving } from "./save.js";
import { panelStyle } from "./style.js";
import type { RebounceViewer } from "../rebounce-viewer.js";
import type { Triple } from "../wire/shot.js";

/** A part of the panel, and how it follows the viewer. */
export interface Section {
  readonly element: HTMLElement;
  update(now: boolean): void;
}

/** What the element lends its panel. */
export interface Loan {
  readonly host: RebounceViewer;
  readonly root: ShadowRoot;
  readonly history: History;
  /** The place that is seen at a place of the element, CSS pixels from its top left; none where no surface is. */
  surfaceAt(x: number, y: number): Triple | undefined;
  /** Direction of a new sun's light. */
  sunlight(): Float64Array;
}

/** What sections work with. */
export interface Desk extends Loan {
  /** Says what has happened. It is no longer seen after some seconds, unless it stays. */
  say(text: string, stays?: boolean): void;
}

/** The panel's elements and how they follow the viewer. */
export class Panel {
  readonly element: HTMLElement;
  #details: HTMLDetailsElement;
  #sections: Section[];

  constructor(loan: Loan) {
    const { host, root, history } = loan;
    root.adoptedStyleSheets.push(panelStyle());
    const status = make("p", { class: "status", role: "status" });
    const say = (text: string, stays?: boolean) => status.replaceChildren(...(text ? [make("span", stays ? { class: "stays" } : {}, text)] : []));
    const desk = { ...loan, say };
    this.#sections = [
      steps(desk),
      fold("Lights", new LightList(desk), true),
      playRow(host),
      fold("Camera", views(desk)),
      fold("Picture", picture(desk)),
      fold("Statistics", new Figures(host)),
      fold("Save", saving(desk)),
    ];
    const form = make("form", {}, ...this.#sections.map(({ element }) => element));
    form.addEventListener("submit", (event) => event.preventDefault());
    history.watch(form);
    const title = make("summary", {}, icon("settings"), "Lights and settings", icon("close"));
    this.#details = make("details", { class: "panel", part: "panel" }, title, make("div", { class: "body" }, form, status));
    this.#details.addEventListener("toggle", () => this.update(true));
    this.#details.addEventListener("keydown", ({ key }) => {
      if (key !== "Escape") return;
      this.#details.open = false;
      title.focus();
    });
    this.element = make("div", { class: "dock" }, this.#details, ...fullScreen(host));
  }

  /** Follows the viewer; figures at once with `now`. */
  update(now = false): void {
    if (this.#details.open) for (const section of this.#sections) section.update(now);
  }
}

/** A section under a heading that opens and closes it; closed, it follows nothing. */
function fold(title: string, section: Section, open = false): Section {
  const element = make("details", { class: "section" }, make("summary", {}, title), section.element);
  element.open = open;
  element.addEventListener("toggle", () => element.open && section.update(true));
  return { element, update: (now) => element.open && section.update(now) };
}

/** Undo and redo. What can do nothing stays in the focus's way, and says so. */
function steps({ history, say }: Desk): Section {
  const words = (names: string[]) => names.filter((name) => name !== "animations").join(", ").replaceAll("-", " ");
  const step = (way: "undo" | "redo", done: string) => {
    const names = history[`${way}es`];
    say(history[way]() ? `${done}: ${words(names)}.` : `Nothing to ${way}.`);
  };
  const undo = button(icon("undo"), () => step("undo", "Undone"), { "aria-label": "Undo", title: "Undo: Ctrl+Z" });
  const redo = button(icon("redo"), () => step("redo", "Redone"), { "aria-label": "Redo", title: "Redo: Ctrl+Shift+Z" });
  const update = () => {
    undo.ariaDisabled = String(history.undoes.length === 0);
    redo.ariaDisabled = String(history.redoes.length === 0);
  };
  return { element: make("div", { class: "steps" }, undo, redo), update };
}

/** A button that fills the screen with the element, where the browser can. */
function fullScreen(host: RebounceViewer): HTMLElement[] {
  if (!document.fullscreenEnabled) return [];
  const toggle = button(icon("full"), () => {
    const asked = host.matches(":fullscreen") ? document.exitFullscreen() : host.requestFullscreen();
    // Refused, it stays as it is.
    asked.catch(() => undefined);
  });
  toggle.className = "screen";
  const label = () => (toggle.ariaLabel = toggle.title = host.matches(":fullscreen") ? "Leave full screen" : "Full screen");
  host.addEventListener("fullscreenchange", label);
  label();
  return [toggle];
}
