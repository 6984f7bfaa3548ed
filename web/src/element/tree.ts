/** What is in the element's shadow tree: canvas, poster, progress, message. */

import { make } from "./element.js";
import { style } from "./style.js";

/** The tree, and what of it is shown. */
export class Tree {
  readonly root: ShadowRoot;
  canvas = document.createElement("canvas");
  #own = new CSSStyleSheet();
  #image = make("img", { class: "poster", alt: "" });
  #posters = slot("poster", this.#image);
  #poster = make("div", { class: "cover", part: "poster" }, this.#posters);
  #progress = make("div", { class: "progress" });
  #bar = make("div", { class: "bar", part: "progress", role: "progressbar", "aria-label": "Loading" }, make("div"));
  #error = slot("error");
  #message = make("div", { class: "message", part: "message", role: "alert" }, this.#error);

  constructor(element: HTMLElement) {
    this.root = element.attachShadow({ mode: "open", delegatesFocus: true });
    this.root.adoptedStyleSheets = [style(), this.#own];
    this.#image.hidden = this.#progress.hidden = this.#message.hidden = true;
    this.#progress.append(slot("progress", this.#bar));
    this.root.append(this.canvas, make("div", { class: "tap" }, "Tap to look around"), this.#poster, this.#progress, this.#message);
  }

  /** Puts a fresh canvas in place of one that a viewer drew on. */
  renewCanvas(): void {
    const canvas = make("canvas", { part: "canvas", role: "img" });
    this.canvas.replaceWith(canvas);
    this.canvas = canvas;
  }

  /** What the picture and its poster show, and whether the picture takes keys. */
  setLabel(alt: string, takesKeys: boolean): void {
    const name = alt || "3D scene";
    const hint = `${name}. Drag to look around; W, A, S, D and the arrow keys move, R goes back.`;
    this.#image.alt = alt;
    this.canvas.setAttribute("aria-label", takesKeys ? hint : name);
    if (takesKeys) this.canvas.setAttribute("tabindex", "0");
    else {
      // Keys that are held are let go.
      this.canvas.blur();
      this.canvas.removeAttribute("tabindex");
    }
  }

  /** Puts an element over the picture, under a message. */
  add(element: HTMLElement): void {
    this.#progress.before(element);
  }

  /** Shows or hides the picture. */
  showPicture(shown: boolean): void {
    this.canvas.classList.toggle("shown", shown);
  }

  /** Shows or hides what stands for the picture. */
  showPoster(shown: boolean): void {
    this.#poster.hidden = !shown;
  }

  /** The poster's address; empty for none. */
  setPoster(src: string): void {
    if (src) this.#image.src = src;
    this.#image.hidden = !src;
  }

  /** How much has come, 0 to 1; nothing hides it. */
  setProgress(ratio?: number): void {
    this.#progress.hidden = ratio === undefined;
    this.#bar.setAttribute("aria-valuenow", String(Math.round((ratio ?? 0) * 100)));
    this.#progress.style.setProperty("--rebounce-progress", String(ratio ?? 0));
  }

  /** Shows a sentence in place of the picture, with a way to try again; without one, below the poster. Nothing hides it. */
  setMessage(text?: string, again?: () => void): void {
    this.#message.hidden = text === undefined;
    this.#error.replaceChildren();
    if (text === undefined) return;
    this.#error.append(make("p", {}, text));
    const isPoster = !this.#image.hidden || this.#posters.assignedNodes().length > 0;
    this.#message.classList.toggle("strip", !again && isPoster);
    if (!again) return;
    const button = make("button", { type: "button" }, "Try again");
    button.addEventListener("click", again);
    this.#error.append(button);
  }

  /** The size that the attributes ask for, CSS pixels; 0 where they say nothing. The page's own rules go first. */
  setSize(width: number, height: number): void {
    const rules = [
      width && `width:${width}px`,
      height && `height:${height}px`,
      width && height && `aspect-ratio:${width}/${height}`,
      // A height alone: the width follows from the shape.
      !width && height && "width:fit-content",
    ];
    this.#own.replaceSync(`:host{${rules.filter(Boolean).join(";")}}`);
  }
}

function slot(name: string, ...instead: Node[]): HTMLSlotElement {
  return make("slot", { name }, ...instead);
}
