// The ball of test/three/rooms.mjs, which no bake knows, by three ways to its bounced light: our probes, VXGI,
// LightProbeGrid. `bench` on the window is what rooms.mjs calls: pictures as `stage.ball` gives them.

import * as THREE from "three/webgpu";
import { diffuseColor, float, mrt, normalView, output, pass, vec4 } from "three/tsl";
import "/test/three/stage.mjs";

const SIZE = [160, 90];
/** Pictures before the one that is read: voxels and their bounces are there then. */
const WARM = 3;
/** Scene units between the probes of a LightProbeGrid. */
const SPACING = 0.5;

/** A scene with shadows, and Lambertian materials. */
async function prepared(files) {
  const made = await stage.ballScene(files, true);
  made.renderer.shadowMap.enabled = true;
  for (const lamp of made.lamps) {
    lamp.castShadow = true;
    lamp.shadow.mapSize.set(1024, 1024);
    lamp.shadow.camera.near = 0.05;
    lamp.shadow.normalBias = 0.02;
  }
  made.scene.traverse((object) => {
    if (!object.isMesh) return;
    const { color, side } = object.material;
    object.material = new THREE.MeshLambertMaterial({ color, side, shadowSide: THREE.DoubleSide });
    object.castShadow = object.receiveShadow = true;
  });
  return made;
}

/** Draws into a target of floats, and reads it. */
async function picture(renderer, draw) {
  const target = new THREE.RenderTarget(...SIZE, { type: THREE.FloatType });
  renderer.setRenderTarget(target);
  draw();
  renderer.setRenderTarget(null);
  return Array.from(await renderer.readRenderTargetPixelsAsync(target, 0, 0, ...SIZE));
}

/** Where the ball is: 7 in the last channel. */
async function marked(renderer, scene, camera, ball, pixels) {
  const others = scene.children.filter((object) => object !== ball);
  scene.remove(...others);
  const { e } = await stage.read(renderer, scene, camera, SIZE, { e: vec4(0, 0, 0, 7) });
  for (let i = 3; i < e.length; i += 4) pixels[i] = e[i];
  return pixels;
}

/** With voxels, as fine as they may be, and bounces, as many as there may be. */
async function vxgi(files) {
  const { vxgi } = await import("three/addons/lighting/vxgi/VXGINode.js");
  const { renderer, scene, camera, ball } = await prepared(files);
  const first = pass(scene, camera);
  first.setMRT(mrt({ output, normal: vec4(normalView, 1), diffuse: vec4(diffuseColor.rgb, 1) }));
  const node = vxgi(first.getTextureNode("depth"), first.getTextureNode("normal"), scene, camera, 256);
  node.bounces = 2;
  node.useTemporalFiltering = false;
  const bounced = first.getTextureNode("diffuse").rgb.mul(node.getGINode().rgb).div(Math.PI).mul(node.mul(0).add(1).x);
  const pipeline = new THREE.RenderPipeline(renderer);
  pipeline.outputColorTransform = false;
  pipeline.outputNode = vec4(bounced, float(1));
  for (let i = 0; i < WARM; i += 1) await picture(renderer, () => pipeline.render());
  return marked(renderer, scene, camera, ball, await picture(renderer, () => pipeline.render()));
}

/** With probes over the scene's box, and bounces until more make no difference. */
async function probes(files) {
  const { LightProbeGrid } = await import("three/addons/lighting/LightProbeGrid.js");
  const { renderer, scene, camera, ball, model, lamps } = await prepared(files);
  const box = new THREE.Box3().setFromObject(model);
  const size = box.getSize(new THREE.Vector3()).toArray();
  const grid = new LightProbeGrid(...size, ...size.map((length) => Math.round(length / SPACING)));
  box.getCenter(grid.position);
  scene.add(grid);
  ball.visible = false;
  grid.bake(renderer, scene, { cubemapSize: 16, near: 0.01, bounces: 6 });
  ball.visible = true;
  // Bounced light alone.
  for (const lamp of lamps) lamp.visible = false;
  const pixels = await picture(renderer, () => renderer.render(scene, camera));
  return marked(renderer, scene, camera, ball, pixels);
}

window.bench = { ours: stage.ball, vxgi, probes };
