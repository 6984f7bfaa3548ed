// The same scene in three.js' WebGPURenderer: Lambert materials, one spot light with a 2048² shadow map; with
// ?gi, voxel-based global illumination with one cached bounce (VXGI, 128³); with ?probes, a LightProbeGrid that is baked anew as
// the light moves; with ?rebounce, our bounced light in its materials. `bench` on the window is what run.mjs calls.

import * as THREE from "three/webgpu";
import { diffuseColor, float, mrt, output, renderOutput, vec4 } from "three/tsl";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { picture, pipelineOf } from "./floats.mjs";

const parameters = new URLSearchParams(location.search);
const { camera: view, lights } = await (await fetch("/shot.json")).json();
const gi = parameters.has("gi");
const probes = parameters.has("probes");
const { Rebounce } = parameters.has("rebounce") ? await import("/dist/three.js") : {};

const renderer = new THREE.WebGPURenderer({ antialias: false, ...(Rebounce && { device: await Rebounce.device() }) });
renderer.setPixelRatio(1);
renderer.setSize(innerWidth, innerHeight);
renderer.shadowMap.enabled = true;
renderer.shadowMap.type = THREE.PCFShadowMap;
renderer.toneMapping = THREE.AgXToneMapping;
document.body.append(renderer.domElement);
await renderer.init();

const scene = new THREE.Scene();
const { scene: model } = await new GLTFLoader().loadAsync("/scene.glb");
model.traverse((object) => {
  if (object.isLight) object.visible = false;
  if (!object.isMesh) return;
  const { color, map, side, alphaTest, transparent, opacity } = object.material;
  object.material = new THREE.MeshLambertMaterial({ color, map, side, alphaTest, transparent, opacity });
  object.castShadow = object.receiveShadow = true;
});
scene.add(model);

const [light] = lights;
const outer = light.outer_cone_deg;
// A hard edge where the shot names no inner cone.
const penumbra = 1 - (light.inner_cone_deg ?? outer) / outer;
const spot = new THREE.SpotLight(
  new THREE.Color(...light.color), light.intensity, 0, (outer * Math.PI) / 180, penumbra, 2);
spot.castShadow = true;
spot.shadow.mapSize.set(2048, 2048);
spot.shadow.camera.near = 0.1;
spot.shadow.normalBias = 0.05;
scene.add(spot, spot.target);

const camera = new THREE.PerspectiveCamera(view.yfov_deg, innerWidth / innerHeight, 0.1, 200);
camera.position.set(...view.position);
camera.up.set(...view.up);
camera.lookAt(...view.target);

function placeLight(shift) {
  spot.position.set(light.position[0] + shift, light.position[1], light.position[2]);
  const [x, y, z] = light.direction;
  spot.target.position.set(spot.position.x + x, spot.position.y + y, spot.position.z + z);
}

let draw = () => renderer.render(scene, camera);
/** Radiance of the bounced light alone, as `readIndirect` of the element gives it. */
let indirect;
if (gi) {
  const { vxgiOf } = await import("./vxgi.mjs");
  const { first, bounced } = vxgiOf(scene, camera, 128, 1);
  const pipeline = pipelineOf(renderer, renderOutput(vec4(first.getTextureNode().rgb.add(bounced), float(1))).rgb);
  draw = () => pipeline.render();
  const alone = pipelineOf(renderer, bounced);
  indirect = (width, height) => picture(renderer, width, height, () => alone.render());
}

if (Rebounce) {
  const light = await Rebounce.load("/scene.rbn", { renderer, probes: false });
  scene.add(light.light);
  light.lights.add(spot);
  draw = () => {
    light.update();
    renderer.render(scene, camera);
  };
  indirect = async (width, height) => {
    const target = new THREE.RenderTarget(width, height, { count: 2, type: THREE.FloatType });
    ["output", "bounced"].forEach((name, i) => (target.textures[i].name = name));
    renderer.setMRT(mrt({ output, bounced: vec4(diffuseColor.rgb.mul(light.irradiance).div(Math.PI), 1) }));
    renderer.setRenderTarget(target);
    draw();
    renderer.setRenderTarget(null);
    renderer.setMRT(null);
    return Array.from(await renderer.readRenderTargetPixelsAsync(target, 0, 0, width, height, 1));
  };
}

/** Probes along each axis of a LightProbeGrid, and its bounces. */
const PROBES = [6, 3, 4];
const BOUNCES = 1;
if (probes) {
  const { LightProbeGrid } = await import("three/addons/lighting/LightProbeGrid.js");
  const box = new THREE.Box3().setFromObject(model);
  const { x, y, z } = box.getSize(new THREE.Vector3());
  const grid = new LightProbeGrid(x, y, z, ...PROBES);
  box.getCenter(grid.position);
  scene.add(grid);
  draw = () => {
    grid.bake(renderer, scene, { bounces: BOUNCES });
    renderer.render(scene, camera);
  };
  indirect = (width, height) =>
    picture(renderer, width, height, () => {
      spot.visible = false;
      renderer.toneMapping = THREE.NoToneMapping;
      renderer.render(scene, camera);
      spot.visible = true;
      renderer.toneMapping = THREE.AgXToneMapping;
    });
}

const queue = renderer.backend.device.queue;
window.bench = {
  /** Milliseconds of a frame, from the light's move to the end of the GPU's work. */
  async frame(shift) {
    placeLight(shift);
    const start = performance.now();
    draw();
    await queue.onSubmittedWorkDone();
    return performance.now() - start;
  },
  /** Bounced light with the light where the shot has it. */
  async indirect(width, height) {
    placeLight(0);
    draw();
    return indirect(width, height);
  },
};
