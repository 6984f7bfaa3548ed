/** `interaction="auto"`: the wheel and single fingers are the page's until the element has the focus, by a click, a tap or Tab. */

import type { Interaction } from "../element/attributes.js";

/** A finger that moves farther than this before it is lifted has not tapped, CSS pixels. */
const TAP = 10;

/** What of a canvas's events is the viewer's. */
export interface Activation {
  /** Whether a wheel's turn is. */
  wheel(event: WheelEvent): unknown;
  /** The fingers and buttons that the viewer is to hear of now that one more is down. */
  down(event: PointerEvent): PointerEvent[];
  /** Whether a pointer's later events are; `up`: it is lifted, which may have been a tap. */
  has(event: PointerEvent, up?: boolean): boolean;
}

/** Listens until the signal aborts. What fingers scroll is the style sheet's. */
export function activation(canvas: HTMLCanvasElement, interaction: () => Interaction, signal: AbortSignal): Activation {
  /** The finger that waits: it scrolls the page, or is the first of two, or a tap. */
  let first: PointerEvent | undefined;
  const root = canvas.getRootNode() as ShadowRoot;
  const sleep = () => (root.activeElement as HTMLElement | null)?.blur();

  // Two fingers are the viewer's: without this they would scroll, too.
  const touch = (event: TouchEvent) => event.targetTouches.length > 1 && event.cancelable && event.preventDefault();
  canvas.addEventListener("touchstart", touch, { signal, passive: false });
  canvas.addEventListener("touchmove", touch, { signal, passive: false });
  // Not every browser takes the focus away when something without focus is touched.
  addEventListener("pointerdown", (event) => event.composedPath().includes(root) || sleep(), { signal, capture: true });
  const key = (event: KeyboardEvent) => event.key === "Escape" && !event.defaultPrevented && event.composedPath()[0] === canvas && sleep();
  addEventListener("keydown", key, { signal });

  return {
    wheel: (event) => event.ctrlKey || event.metaKey || interaction() === "all" || (interaction() === "auto" && root.activeElement),
    down(event) {
      const waits = event.pointerType === "touch" && interaction() === "auto" && !root.activeElement;
      const before = first;
      first = waits && !before ? event : undefined;
      if (first) return [];
      if (!before) canvas.focus({ preventScroll: true });
      return before ? [before, event] : [event];
    },
    has(event, up) {
      if (event.pointerId !== first?.pointerId) return true;
      const near = Math.hypot(event.clientX - first.clientX, event.clientY - first.clientY) < TAP;
      if (event.type === "pointerup" && near) canvas.focus({ preventScroll: true });
      if (up) first = undefined;
      return false;
    },
  };
}
