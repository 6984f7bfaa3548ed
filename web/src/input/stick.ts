/** The on-screen stick: walks where there are fingers and the camera is inside. */

// Types alone: with a value of its own, the bundler would make another part of the first load.
import type { make as Make } from "../element/element.js";
import type { Input } from "./input.js";

/** Makes the stick's element, which is there until the signal aborts. Dragged, it walks on as long as it is held; pressed, by keys too, a step ahead. */
export function makeStick(make: typeof Make, { withViewer, gesture }: Pick<Input, "withViewer" | "gesture">, signal: AbortSignal): HTMLButtonElement {
  const knob = make("span");
  const stick = make("button", { type: "button", class: "stick", part: "stick", "aria-label": "Walk: drag, or press for a step ahead" }, knob);
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
  return stick;
}
