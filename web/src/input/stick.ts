/** The on-screen stick: walks where there are fingers and the camera is inside. */

import type { Input } from "./input.js";

const CSS = `
.stick {
  position: absolute; left: 1rem; bottom: 1rem; width: 6rem; height: 6rem; padding: 0; border-radius: 50%; touch-action: none;
}
.stick span { position: absolute; inset: 25%; border-radius: 50%; background: rgb(255 255 255 / 0.45); }
@media not (any-pointer: coarse) { .stick { display: none; } }
:host([interaction="none"]) .stick, :host(:not(:focus-within, [interaction="all"])) .stick, canvas:not(.inside) + .stick { display: none; }
`;

let sheet: CSSStyleSheet | undefined;

/** Puts the stick after a canvas, until the signal aborts. Dragged, it walks on as long as it is held; pressed, by keys too, a step ahead. */
export function putStick(canvas: HTMLCanvasElement, { withViewer, gesture }: Pick<Input, "withViewer" | "gesture">, signal: AbortSignal): void {
  if (signal.aborted) return;
  const { adoptedStyleSheets } = canvas.getRootNode() as ShadowRoot;
  if (!sheet) (sheet = new CSSStyleSheet()).replaceSync(CSS);
  if (!adoptedStyleSheets.includes(sheet)) adoptedStyleSheets.push(sheet);
  // Without `make` of ../element: with code of both, the bundler would make another part of the first load.
  const knob = document.createElement("span");
  const stick = document.createElement("button");
  stick.setAttribute("part", "stick");
  stick.setAttribute("aria-label", "Walk: drag, or press for a step ahead");
  [stick.type, stick.className] = ["button", "stick"];
  stick.append(knob);
  const hold = (x: number, y: number) => {
    knob.style.translate = `${60 * x}% ${60 * y}%`;
    withViewer((viewer) => viewer.stick(x, -y));
  };
  const move = ({ clientX, clientY }: PointerEvent) => {
    const { left, top, width, height } = stick.getBoundingClientRect();
    const [x, y] = [(clientX - left) / width - 0.5, (clientY - top) / height - 0.5];
    // At its edge it is held as far as it goes.
    const most = Math.max(Math.hypot(x, y), 0.5);
    hold(x / most, y / most);
  };
  stick.addEventListener("pointerdown", (event) => {
    stick.setPointerCapture(event.pointerId);
    gesture("stick", true);
    move(event);
  });
  stick.addEventListener("pointermove", (event) => stick.hasPointerCapture(event.pointerId) && move(event));
  stick.addEventListener("lostpointercapture", () => {
    hold(0, 0);
    gesture("stick", false);
  });
  stick.addEventListener("click", ({ detail }) => {
    // By a key, not by a finger.
    if (detail) return;
    gesture("stick", true);
    withViewer((viewer) => viewer.wheel(-100));
    gesture("stick", false);
  });
  signal.addEventListener("abort", () => stick.remove());
  canvas.after(stick);
}
