/** Tells of a camera or lights that are no longer what they were. */

import { tell } from "./events.js";
import type { Viewer } from "./module.js";
import type { Camera, Light } from "./shot.js";

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
    const [camera, lights] = [viewer.cameraJson(), viewer.lightsJson()];
    const moved = this.#camera !== "" && this.#camera !== camera;
    const lit = this.#lights !== "" && this.#lights !== lights;
    this.#camera = camera;
    this.#lights = lights;
    if (moved) tell(target, "camera-change", { camera: JSON.parse(camera) as Camera });
    if (lit) tell(target, "light-change", { lights: JSON.parse(lights) as Light[] });
  }
}
