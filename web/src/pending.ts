/** What is set before there is a scene, and the attributes: handed to the viewer once it has one. */

import type { LightAnimation } from "./animation.js";
import type { AttributeElement } from "./attributes.js";
import type { Viewer } from "./module.js";
import type { Camera, Light, Shot } from "./shot.js";

/** What a script has set so far. */
export interface Pending {
  shot?: Shot;
  camera?: Camera;
  lights?: Light[];
  animations?: LightAnimation[];
  /** `play()` was called: how many times. */
  repetitions?: number;
}

/** Hands over camera and lights. Throws what the viewer refuses. */
export function handOver(viewer: Viewer, { shot, camera, lights }: Pending): void {
  if (shot) viewer.setShotJson(JSON.stringify(shot));
  if (camera) viewer.setCameraJson(JSON.stringify(camera));
  if (lights) viewer.setLightsJson(JSON.stringify(lights));
}

/** Hands the attributes on; what this build of the viewer has not is left alone. */
export function applyAttributes(viewer: Viewer, element: AttributeElement): void {
  const { exposure, autoExposure, toneMapping, mode, overlay } = element;
  const wanted: Partial<Viewer> = { exposure, autoExposure, toneMapping, mode, overlay };
  for (const name in wanted) if (!(name in viewer)) delete wanted[name as keyof Viewer];
  Object.assign(viewer, wanted);
}
