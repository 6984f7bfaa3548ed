/** Tells of a camera or lights that are no longer what they were, and of handles. */

import { tell } from "../element/events.js";
import type { Viewer } from "./module.js";
import { cameraIn, lightsIn } from "../wire/wire.js";

/** What was told last. */
export class Changes {
  #camera = "";
  #lights = "";
  #hovered = -1;
  #selected = -1;

  /** The next look tells nothing: there is nothing to compare with. */
  forget(): void {
    this.#camera = this.#lights = "";
  }

  /** Looks, and sends what has changed. */
  look(viewer: Viewer, target: EventTarget): void {
    const [camera, lights] = [String(viewer.camera()), String(viewer.lights())];
    const moved = this.#camera !== "" && this.#camera !== camera;
    const lit = this.#lights !== "" && this.#lights !== lights;
    this.#camera = camera;
    this.#lights = lights;
    if (moved) tell(target, "camera-change", { camera: cameraIn(viewer) });
    if (lit) tell(target, "light-change", { lights: lightsIn(viewer) });
    const { hoveredLight, selectedLight } = viewer;
    if (this.#hovered !== hoveredLight) tell(target, "light-hover", { light: (this.#hovered = hoveredLight) });
    if (this.#selected !== selectedLight) tell(target, "light-select", { light: (this.#selected = selectedLight) });
  }
}
