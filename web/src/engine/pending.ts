/** What is set before there is a scene or kept of a lost one, and the attributes: handed to the viewer once it has one. */

import type { LightAnimation } from "../animation/animation.js";
import type { AttributeElement } from "../element/attributes.js";
import type { ShotMotion } from "../nodes/moving.js";
import type { Viewer } from "./module.js";
import type { Camera, Channel, Light, Shot } from "../wire/shot.js";
import { setMix } from "../wire/mix.js";
import { cameraNumbers, setLights, setShot } from "../wire/wire.js";

/** What a script has set so far, or what was there before the device was lost. */
export interface Pending {
  shot?: Shot;
  camera?: Camera;
  lights?: Light[];
  mix?: Channel[];
  animations?: LightAnimation[];
  /** `play()` was called: how many times. */
  repetitions?: number;
  /** The exposure that the scene began with. */
  measured?: number;
  /** Where nodes were, and the pose. */
  moved?: ShotMotion | undefined;
}

/** Hands over camera, lights and exposure. Throws what the viewer refuses. */
export function handOver(viewer: Viewer, { shot, camera, lights, mix, measured, moved }: Pending): void {
  if (shot) setShot(viewer, shot);
  if (camera) viewer.setCamera(cameraNumbers(camera));
  if (lights) setLights(viewer, lights);
  if (mix) setMix(viewer, mix);
  if (moved) viewer.moving?.move(moved);
  if (measured) viewer.measured = measured;
}

/** Hands the attributes on. */
export function applyAttributes(viewer: Viewer, element: AttributeElement): void {
  const { detail, exposure, autoExposure, toneMapping, mode, overlay, display, solver, handles, interaction, cameraControls, backgroundBlur } = element;
  const backdrop = element.backdrop === "auto";
  const gizmos = handles && interaction !== "none";
  Object.assign(viewer, { detail, exposure, autoExposure, toneMapping, mode, overlay, display, solver, backdrop, gizmos, cameraControls, backgroundBlur });
}
