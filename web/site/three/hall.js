// A hall that was baked, and a knot that was not, in three.js with bounced light.

import * as THREE from "three/webgpu";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { Rebounce } from "rebounce-viewer/three";

const find = (id) => document.getElementById(id);
const [canvas, turn, bounced, status] = ["hall", "turn", "bounced", "status"].map(find);

try {
  const device = await Rebounce.device();
  const renderer = new THREE.WebGPURenderer({ canvas, device, antialias: true });
  renderer.shadowMap.enabled = true;
  renderer.toneMapping = THREE.AgXToneMapping;

  const scene = new THREE.Scene();
  scene.background = new THREE.Color("#8db8ea");
  const { scene: hall, cameras } = await new GLTFLoader().loadAsync("samples/rotunda.glb");
  const [camera] = cameras;
  const knot = new THREE.Mesh(
    new THREE.TorusKnotGeometry(0.42, 0.14, 160, 24),
    new THREE.MeshStandardMaterial({ color: "#f4f0ea", roughness: 0.7 }),
  );
  scene.add(hall, knot);

  // Bounced light: its materials are three's own, and so are the lamps.
  const gi = await Rebounce.load("scenes/rotunda.rbn", { renderer });
  scene.add(gi.light);
  hall.traverse((object) => object.isLight && gi.lights.add(object));

  scene.traverse((object) => object.isMesh && (object.castShadow = object.receiveShadow = true));
  const sun = hall.getObjectByName("Sun");
  sun.castShadow = true;
  sun.shadow.mapSize.set(2048, 2048);
  sun.shadow.normalBias = 0.03;
  Object.assign(sun.shadow.camera, { left: -8, right: 8, top: 8, bottom: -8, near: 1, far: 30 });

  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  function frame(milliseconds) {
    const time = calm.matches ? 0 : milliseconds / 1000;
    knot.position.set(1.3 * Math.cos(0.3 * time), 1.5, 0.2 + 1.3 * Math.sin(0.3 * time));
    knot.rotation.y = time;
    const angle = (turn.valueAsNumber * Math.PI) / 180;
    sun.position.set(7 * Math.cos(angle), 14, 7 * Math.sin(angle));
    sun.lookAt(0, 0, 0);
    gi.light.visible = bounced.checked;
    gi.update();
    renderer.render(scene, camera);
  }

  new ResizeObserver(() => {
    renderer.setPixelRatio(devicePixelRatio);
    renderer.setSize(canvas.clientWidth, canvas.clientHeight, false);
    camera.aspect = canvas.clientWidth / canvas.clientHeight;
    camera.updateProjectionMatrix();
  }).observe(canvas);
  // Nothing is drawn that nobody sees.
  new IntersectionObserver(([{ isIntersecting }]) => {
    renderer.setAnimationLoop(isIntersecting ? frame : null);
  }).observe(canvas);

  status.textContent = "Probes are on their way: the knot is dark until they are there.";
  status.textContent = (await gi.ready) ? "The knot is lit by probes, the hall at its pixels." : "";
} catch (error) {
  status.textContent = error.message;
}
