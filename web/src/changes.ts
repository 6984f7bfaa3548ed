/** Tells of a camera or lights that are no longer what they were. */

import { tell } from "./events.js";
import type { Viewer } from "./module.js";
import { cameraIn, lightsIn } from "./wire.js";

/** What was told last. */
export class Changes {
  #camera = "";
  #lights = "";

  /** The next look tells nothing: there is nothing to compare with. */
  forget(): void {
    this.#camera = this.#lights = "";
  }

  /** Looks, and sends `camera-change` and `light-change`. */
  look(viewer: Viewer, target: EventTarget): void {
    const [camera, lights] = [String(viewer.camera()), String(viewer.lights())];
    const moved = this.#camera !== "" && this.#camera !== camera;
    const lit = this.#lights !== "" && this.#lights !== lights;
    this.#camera = camera;
    this.#lights = lights;
    if (moved) tell(target, "camera-change", { camera: cameraIn(viewer) });
    if (lit) tell(target, "light-change", { lights: lightsIn(viewer) });
  }
}
