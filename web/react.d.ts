/**
 * `<rebounce-viewer>` in JSX, for React 19: `import type {} from "rebounce-viewer/react"`, once in an app.
 *
 * Properties are set as such; the element's events are props named `on` and the event's name, as in
 * `onload` and `oncamera-change`.
 */

import type { HTMLAttributes, RefAttributes } from "react";
import type { RebounceEventMap, RebounceViewer } from "./dist/rebounce-viewer.js";

type Same<A, B> = (<T>() => T extends A ? 1 : 2) extends <T>() => T extends B ? 1 : 2 ? true : false;

/** The names of what can be set: no methods, nothing that is only read. */
type Settable<T> = {
  [K in keyof T]-?: T[K] extends (...args: never) => unknown
    ? never
    : Same<{ [P in K]: T[P] }, { -readonly [P in K]: T[P] }> extends true
      ? K
      : never;
}[keyof T];

type Own = { [K in Exclude<Settable<RebounceViewer>, keyof HTMLElement>]?: RebounceViewer[K] };
type Handlers = { [K in keyof RebounceEventMap as `on${K}`]?: (event: RebounceEventMap[K]) => void };

/** React's own props of this meaning never fire on a custom element. */
type Never = "onLoad" | "onError" | "onProgress";

/** Props of `<rebounce-viewer>`. */
export type RebounceViewerProps = Omit<HTMLAttributes<RebounceViewer>, Never | keyof Own | keyof Handlers> &
  RefAttributes<RebounceViewer> &
  Own &
  Handlers;

declare module "react" {
  namespace JSX {
    interface IntrinsicElements {
      "rebounce-viewer": RebounceViewerProps;
    }
  }
}
