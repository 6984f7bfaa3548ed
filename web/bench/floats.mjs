// Pictures of floats from three.js.

import * as THREE from "three/webgpu";
import { float, vec4 } from "three/tsl";

/** A pipeline that shows a radiance as it is. */
export function pipelineOf(renderer, radiance) {
  const pipeline = new THREE.RenderPipeline(renderer);
  pipeline.outputColorTransform = false;
  pipeline.outputNode = vec4(radiance, float(1));
  return pipeline;
}

/** Draws into a target of floats, and reads it. */
export async function picture(renderer, width, height, draw) {
  const target = new THREE.RenderTarget(width, height, { type: THREE.FloatType });
  renderer.setRenderTarget(target);
  draw();
  renderer.setRenderTarget(null);
  return Array.from(await renderer.readRenderTargetPixelsAsync(target, 0, 0, width, height));
}
