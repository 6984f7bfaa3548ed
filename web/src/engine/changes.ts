/** Tells of a camera or lights that are no longer what they were, and of handles. */

import { tell } from "../element/events.js";
import type { Viewer } from "./module.js";
import { mixIn, mixJson } from "../wire/mix.js";
import { cameraIn, lightsIn } from "../wire/wire.js";

/** What was told last. */
export class Changes {
  #camera = "";
  #lights = "";
  #mix = "";
  #hovered = -1;
  #selected = -1;

  /** The next look tells nothing: there is nothing to compare with. */
  forget(): void {
    this.#camera = this.#lights = this.#mix = "";
  }

  /** Looks, and sends what has changed. */
  look(viewer: Viewer, target: EventTarget): void {
    const [camera, lights, mix] = [String(viewer.camera()), String(viewer.lights()), mixJson(viewer)];
    const moved = this.#camera !== "" && this.#camera !== camera;
    const lit = this.#lights !== "" && this.#lights !== lights;
    const mixed = this.#mix !== "" && this.#mix !== mix;
    this.#camera = camera;
    this.#lights = lights;
    this.#mix = mix;
    if (moved) tell(target, "camera-change", { camera: cameraIn(viewer) });
    if (lit) tell(target, "light-change", { lights: lightsIn(viewer) });
    viewer.moving?.look(target);
    if (mixed) tell(target, "mix-change", { mix: mixIn(viewer) });
    const { hoveredLight, selectedLight } = viewer;
    if (this.#hovered !== hoveredLight) tell(target, "light-hover", { light: (this.#hovered = hoveredLight) });
    if (this.#selected !== selectedLight) tell(target, "light-select", { light: (this.#selected = selectedLight) });
  }
}
