/** Pointer, wheel and keyboard events of a canvas, handed to the viewer in canvas pixels. */

import { activation } from "./activation.js";
import type { Interaction } from "./attributes.js";
import type { Viewer } from "./module.js";

/** Calls its argument with the viewer, if there is one to take input. */
export type WithViewer = (use: (viewer: Viewer) => void) => void;

/**
 * Listens until the signal aborts. What is left to the page is the activation's; that fingers scroll then, and that with
 * `none` no pointer gets here, is the style sheet's.
 */
export function listen(
  canvas: HTMLCanvasElement,
  withViewer: WithViewer,
  interaction: () => Interaction,
  signal: AbortSignal,
): void {
  const held = new Set<string>();
  const active = activation(canvas, interaction, signal);
  const at = (event: MouseEvent): [number, number] => {
    const box = canvas.getBoundingClientRect();
    const scale = [canvas.width / Math.max(box.width, 1), canvas.height / Math.max(box.height, 1)] as const;
    return [(event.clientX - box.left) * scale[0], (event.clientY - box.top) * scale[1]];
  };
  const release = () => {
    for (const code of held) withViewer((viewer) => viewer.key(code, false));
    held.clear();
  };
  const down = (event: PointerEvent) => {
    canvas.setPointerCapture(event.pointerId);
    const [x, y] = at(event);
    withViewer((viewer) =>
      viewer.pointerDown(event.pointerId, x, y, event.button, event.shiftKey, event.ctrlKey || event.metaKey),
    );
  };
  const up = (event: PointerEvent) => active.has(event, true) && withViewer((viewer) => viewer.pointerUp(event.pointerId));

  canvas.addEventListener("pointerdown", (event) => active.down(event).forEach(down), { signal });
  canvas.addEventListener(
    "pointermove",
    (event) => active.has(event) && withViewer((viewer) => viewer.pointerMove(event.pointerId, ...at(event))),
    { signal },
  );
  canvas.addEventListener("pointerup", up, { signal });
  canvas.addEventListener("pointercancel", up, { signal });
  canvas.addEventListener("contextmenu", (event) => event.preventDefault(), { signal });
  canvas.addEventListener(
    "wheel",
    (event) => {
      if (!active.wheel(event)) return;
      event.preventDefault();
      // Lines and pages become about as many pixels as browsers scroll for them.
      const unit = [1, 16, 400][event.deltaMode] ?? 1;
      withViewer((viewer) => viewer.wheel(...at(event), event.deltaY * unit));
    },
    { signal, passive: false },
  );
  canvas.addEventListener(
    "keydown",
    (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      withViewer((viewer) => {
        if (viewer.key(event.code, true)) {
          held.add(event.code);
          event.preventDefault();
        }
      });
    },
    { signal },
  );
  canvas.addEventListener(
    "keyup",
    (event) => {
      if (held.delete(event.code)) withViewer((viewer) => viewer.key(event.code, false));
    },
    { signal },
  );
  canvas.addEventListener("blur", release, { signal });
}
