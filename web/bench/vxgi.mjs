// Bounced light of VXGI in three.js.

import { diffuseColor, mrt, normalView, output, pass, vec4 } from "three/tsl";
import { vxgi } from "three/addons/lighting/vxgi/VXGINode.js";

/**
 * The pass that VXGI works on, and the radiance of its bounced light: of so many voxels a side, and so many cached
 * bounces. The node gives irradiance: a Lambertian surface reflects its albedo over π of it.
 */
export function vxgiOf(scene, camera, voxels, bounces) {
  const first = pass(scene, camera);
  first.setMRT(mrt({ output, normal: vec4(normalView, 1), diffuse: vec4(diffuseColor.rgb, 1) }));
  const node = vxgi(first.getTextureNode("depth"), first.getTextureNode("normal"), scene, camera, voxels);
  node.bounces = bounces;
  node.useTemporalFiltering = false;
  // The effect runs where one of its textures is used; its occlusion is what starts it.
  const bounced = first.getTextureNode("diffuse").rgb.mul(node.getGINode().rgb).div(Math.PI).mul(node.mul(0).add(1).x);
  return { first, bounced };
}
