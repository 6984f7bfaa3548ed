// The ball of test/three/rooms.mjs, which no bake knows, by three ways to its bounced light: our probes, VXGI,
// LightProbeGrid. `bench` on the window is what rooms.mjs calls: pictures as `stage.ball` gives them.

import * as THREE from "three/webgpu";
import { vec4 } from "three/tsl";
import { IS_BALL, SIZE } from "/test/three/picture.mjs";
import "/test/three/stage.mjs";
import { picture, pipelineOf } from "./floats.mjs";

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

/** Where the ball is: `IS_BALL` in the last channel. */
async function marked(renderer, scene, camera, ball, pixels) {
  const others = scene.children.filter((object) => object !== ball);
  scene.remove(...others);
  const { e } = await stage.read(renderer, scene, camera, SIZE, { e: vec4(0, 0, 0, IS_BALL) });
  for (let i = 3; i < e.length; i += 4) pixels[i] = e[i];
  return pixels;
}

/** With voxels, as fine as they may be, and bounces, as many as there may be. */
async function vxgi(files) {
  const { vxgiOf } = await import("./vxgi.mjs");
  const { renderer, scene, camera, ball } = await prepared(files);
  const pipeline = pipelineOf(renderer, vxgiOf(scene, camera, 256, 2).bounced);
  const draw = () => picture(renderer, ...SIZE, () => pipeline.render());
  for (let i = 0; i < WARM; i += 1) await draw();
  return marked(renderer, scene, camera, ball, await draw());
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
  const pixels = await picture(renderer, ...SIZE, () => renderer.render(scene, camera));
  return marked(renderer, scene, camera, ball, pixels);
}

window.bench = { ours: stage.ball, vxgi, probes };
