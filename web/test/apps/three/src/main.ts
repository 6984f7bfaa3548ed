import * as THREE from "three/webgpu";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { irradianceAt, Rebounce, type LoadOptions, type ProbeData } from "rebounce-viewer/three";

const device = await Rebounce.device();
const renderer = new THREE.WebGPURenderer({ device });
renderer.setSize(160, 90);
document.body.append(renderer.domElement);

const scene = new THREE.Scene();
const { scene: model, cameras } = await new GLTFLoader().loadAsync("room.glb");
const options: LoadOptions = { renderer, probes: { spacing: 1 } };
const gi: Rebounce = await Rebounce.load("room.rbn", options);
scene.add(model, gi.light);
const lamp = model.getObjectByProperty("isLight", true) as THREE.SpotLight;
gi.lights.add(lamp);
const camera = cameras[0] as THREE.PerspectiveCamera;
camera.aspect = 160 / 90;
camera.updateProjectionMatrix();
await gi.ready;
gi.update();
renderer.render(scene, camera);

const data: ProbeData | undefined = await gi.readProbes();
const up = new THREE.Vector3(0, 1, 0);
const light = data ? irradianceAt(data, new THREE.Vector3(0, 0, 0), up).y : 0;
document.title = light > 0 ? "lit" : "dark";

export async function mistakes(): Promise<void> {
  // @ts-expect-error: there is no such option
  await Rebounce.load("room.rbn", { render: renderer });
  // @ts-expect-error: objects are no lights
  gi.lights.add(model);
  // @ts-expect-error: nothing is set there
  gi.light = lamp;
}
