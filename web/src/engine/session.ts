/** A viewer on a canvas, and what happens to it, until it is let go. */

import { Failure, failureOf } from "../wire/failure.js";
import { listen, type Input } from "../input/input.js";
import { createViewer, type Viewer } from "./module.js";
import type { Triple } from "../wire/shot.js";

/** What is told of a viewer. */
export interface SessionHost extends Input {
  /** A frame is wanted. */
  changed(): void;
  /** The viewer is of no further use. */
  failed(failure: Failure): void;
  /** The page's address has changed behind `#`. */
  linked(): void;
}

/** Makes a viewer, of all files or of those with links alone, and listens until the signal aborts. Rejects with a `Failure`. */
export async function openViewer(canvas: HTMLCanvasElement, host: SessionHost, signal: AbortSignal, radiosity: boolean): Promise<Viewer> {
  const viewer: Viewer = await createViewer(canvas, radiosity);
  viewer.onchange = () => host.changed();
  viewer.ondevicelost = (message: string) => signal.aborted || host.failed(new Failure("device-lost", message));
  listen(canvas, host, signal);
  // Where the stick's module does not come, fingers walk by other gestures.
  if (matchMedia("(any-pointer: coarse)").matches) import("../input/stick.js").then(({ putStick }) => putStick(canvas, host, signal), () => undefined);
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

/** The place that is seen at a place of a canvas, CSS pixels from its top left; none where no surface is. */
export function surfaceIn(viewer: Viewer, { width, clientWidth }: HTMLCanvasElement, x: number, y: number): Triple | undefined {
  const scale = width / Math.max(clientWidth, 1);
  const place = viewer.surfaceAt(x * scale, y * scale);
  return place && ([...place] as Triple);
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
