/** A viewer on a canvas, and what happens to it, until it is let go. */

import type { Interaction } from "./attributes.js";
import { Failure, failureOf } from "./failure.js";
import { gestures } from "./gestures.js";
import { listen, type WithViewer } from "./input.js";
import { createViewer, type Viewer } from "./module.js";
import type { Triple } from "./shot.js";

/** What is told of a viewer. */
export interface SessionHost {
  /** A frame is wanted. */
  changed(): void;
  /** The viewer is of no further use. */
  failed(failure: Failure): void;
  /** The page's address has changed behind `#`. */
  linked(): void;
  /** Hands input on. */
  withViewer: WithViewer;
  /** What pointers and keys do. */
  interaction: () => Interaction;
  /** A hand on the picture begins, or ends, to change camera or lights. */
  gesture(began: boolean): void;
}

/** Makes a viewer and listens until the signal aborts. Rejects with a `Failure`. */
export async function openViewer(canvas: HTMLCanvasElement, host: SessionHost, signal: AbortSignal): Promise<Viewer> {
  const viewer: Viewer = await createViewer(canvas);
  viewer.onchange = () => host.changed();
  viewer.ondevicelost = (message: string) => signal.aborted || host.failed(new Failure("device-lost", message));
  gestures(canvas, host.gesture, signal);
  listen(canvas, host.withViewer, host.interaction, signal);
  // A fault inside the wasm that no call of ours is waiting for.
  const stray = (event: Event, error: unknown) => {
    if ((error as { code?: unknown } | null)?.code !== "internal" && !(error instanceof WebAssembly.RuntimeError)) return;
    event.preventDefault();
    host.failed(failureOf(error));
  };
  addEventListener("error", (event) => stray(event, event.error), { signal });
  addEventListener("unhandledrejection", (event) => stray(event, event.reason), { signal });
  addEventListener("hashchange", () => host.linked(), { signal });
  return viewer;
}

/** Tells what is seen at a place of the element, CSS pixels from its top left; absent where the viewer casts no rays. */
export function surfaces(viewer?: Viewer & { surfaceAt?(x: number, y: number): Triple | undefined }) {
  return viewer?.surfaceAt?.bind(viewer);
}

/** Frees a viewer. */
export function closeViewer(viewer: Viewer): void {
  try {
    viewer.onchange = undefined;
    viewer.ondevicelost = undefined;
    viewer.dispose();
  } catch {
    // After a fault in the wasm there is nothing left to free.
  }
}
