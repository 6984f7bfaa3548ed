/** Pointer, wheel and keyboard events of a canvas, handed to the viewer in canvas pixels. */

import { activation } from "./activation.js";
import type { Interaction } from "../element/attributes.js";
import type { Viewer } from "../engine/module.js";

/** Calls its argument with the viewer, if there is one to take input. */
export type WithViewer = (use: (viewer: Viewer) => void) => void;

/** How near to a handle's middle a finger takes it, CSS pixels. */
const FINGER = 24;

/** What takes text or arrow keys itself. */
const TYPING = 'input:not([type="checkbox"]), select, textarea, [contenteditable]';

/** Where input goes. */
export interface Input {
  withViewer: WithViewer;
  interaction: () => Interaction;
  /** Something that may change camera or lights, by a name of its own, is held or let go. */
  gesture(what: string, held: boolean): void;
  /** The first view is wanted back. */
  reset(): void;
}

/**
 * Listens until the signal aborts. What is left to the page is the activation's; that fingers scroll then, and that with
 * `none` no pointer gets here, is the style sheet's.
 */
export function listen(canvas: HTMLCanvasElement, { withViewer, interaction, gesture, reset }: Input, signal: AbortSignal): void {
  const held = new Set<string>();
  const pointers = new Set<number>();
  const on = <K extends keyof HTMLElementEventMap>(type: K, work: (event: HTMLElementEventMap[K]) => unknown) =>
    canvas.addEventListener(type, work, { signal, passive: false });
  const scale = () => canvas.width / Math.max(canvas.getBoundingClientRect().width, 1);
  const at = (event: MouseEvent): [number, number] => {
    const { left, top } = canvas.getBoundingClientRect();
    return [(event.clientX - left) * scale(), (event.clientY - top) * scale()];
  };
  const letGo = (id: number) => {
    pointers.delete(id);
    gesture(`pointer ${id}`, false);
  };
  const up = (event: PointerEvent) => {
    if (!active.has(event, true)) return;
    withViewer((viewer) => viewer.pointerUp(event.pointerId, event.type === "pointerup"));
    letGo(event.pointerId);
  };
  const keyUp = (code: string) => {
    withViewer((viewer) => viewer.key(code, false));
    if (held.delete(code)) gesture(code, false);
  };
  const letKeysGo = () => [...held, "ShiftLeft", "ShiftRight"].forEach(keyUp);

  const down = (event: PointerEvent) => {
    const { pointerId, pointerType, button, shiftKey, ctrlKey, metaKey } = event;
    canvas.setPointerCapture(pointerId);
    pointers.add(pointerId);
    gesture(`pointer ${pointerId}`, true);
    const reach = pointerType === "touch" ? FINGER * scale() : 0;
    withViewer((viewer) => viewer.pointerDown(pointerId, ...at(event), button, shiftKey, ctrlKey || metaKey, reach));
  };
  on("pointerdown", (event) => active.down(event).forEach(down));
  const move = (event: PointerEvent) => (viewer: Viewer) => {
    viewer.pointerMove(event.pointerId, ...at(event), event.shiftKey, event.altKey);
    canvas.style.cursor = viewer.hoveredLight < 0 ? "" : "pointer";
  };
  on("pointermove", (event) => active.has(event) && withViewer(move(event)));
  on("pointerleave", () => withViewer((viewer) => (viewer.hoveredLight = -1)));
  on("pointerup", up);
  on("pointercancel", up);
  on("contextmenu", (event) => event.preventDefault());
  on("wheel", (event) => {
    if (!active.wheel(event)) return;
    event.preventDefault();
    gesture("wheel", true);
    // Lines and pages become about as many pixels as browsers scroll for them.
    const unit = [1, 16, 400][event.deltaMode] ?? 1;
    withViewer((viewer) => viewer.wheel(event.deltaY * unit));
  });
  // Keys count wherever the focus is in the element, but where it takes text or arrows.
  const root = canvas.getRootNode();
  const isOurs = (event: KeyboardEvent) => {
    const all = interaction() === "all" && event.target === document.body;
    return all || (interaction() !== "none" && event.composedPath().includes(root) && !(event.composedPath()[0] as Element).matches(TYPING));
  };
  const onPage = <K extends keyof WindowEventMap>(type: K, work: (event: WindowEventMap[K]) => unknown) =>
    addEventListener(type, work, { signal });
  onPage("keydown", (event) => {
    const { code } = event;
    if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented || !isOurs(event)) return;
    if (code === "KeyR") return reset();
    withViewer((viewer) => {
      if (!viewer.key(code, true)) return;
      event.preventDefault();
      // What was dragged is back where it was.
      if (code === "Escape") return pointers.forEach(letGo);
      held.add(code);
      gesture(code, true);
    });
  });
  onPage("keyup", (event) => (held.has(event.code) || isOurs(event)) && keyUp(event.code));
  onPage("focusout", letKeysGo);
  onPage("blur", letKeysGo);
  // After the keys: an Escape that has ended a drag does not end more.
  const active = activation(canvas, interaction, signal);
}
