// A scene of three.js with bounced light, for tests: what they call is on `stage`.

import * as THREE from "three/webgpu";
import { WebGLRenderer } from "three";
import { diffuseColor, float, mrt, normalWorld, output, pass, positionWorld, vec4 } from "three/tsl";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { irradianceAt, Rebounce } from "/dist/three.js";
import { IS_BALL, SIZE } from "./picture.mjs";

const bytesOf = (base64) => Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
/** What the console was told. */
const warnings = [];
const warn = console.warn;
console.warn = (...words) => {
  warnings.push(words.join(" "));
  warn(...words);
};

/** A renderer on a device of ours; `webgl`: "node" or "classic" for those that draw through WebGL. */
async function rendererOf({ webgl, width = 160, height = 90, device } = {}) {
  const size = { antialias: false };
  const own = webgl ? undefined : (device ?? (await Rebounce.device({ requiredLimits: { maxColorAttachmentBytesPerSample: 64 } })));
  const renderer = webgl === "classic" ? new WebGLRenderer(size) : new THREE.WebGPURenderer(webgl ? { ...size, forceWebGL: true } : { ...size, device: own });
  renderer.setPixelRatio(1);
  renderer.setSize(width, height);
  document.body.append(renderer.domElement);
  return renderer;
}

/** The glTF scene as three loads it, with its lamp as three has it, and its first camera. */
async function modelOf(glb) {
  const { scene: model, cameras } = await new GLTFLoader().parseAsync(bytesOf(glb).buffer, "");
  const lamps = [];
  model.traverse((object) => {
    if (object.isLight) lamps.push(object);
  });
  model.updateMatrixWorld(true);
  const [camera] = cameras;
  camera.aspect = 160 / 90;
  camera.updateProjectionMatrix();
  return { model, lamps, camera };
}

/** Reads textures of a target that a scene is drawn into, by name: what `outputs` says of each pixel. */
async function read(renderer, scene, camera, [width, height], outputs) {
  const names = Object.keys(outputs);
  const target = new THREE.RenderTarget(width, height, { count: names.length + 1, type: THREE.FloatType });
  target.textures[0].name = "output";
  target.textures[0].type = THREE.HalfFloatType;
  names.forEach((name, i) => (target.textures[i + 1].name = name));
  renderer.setMRT(mrt({ output, ...outputs }));
  renderer.setRenderTarget(target);
  renderer.render(scene, camera);
  const pixels = {};
  for (const [i, name] of names.entries()) pixels[name] = await renderer.readRenderTargetPixelsAsync(target, 0, 0, width, height, i + 1);
  renderer.setRenderTarget(null);
  renderer.setMRT(null);
  target.dispose();
  return pixels;
}

/** Radiance of bounced light alone, albedo over π times irradiance, as `readIndirect` of the element: the mean of places in each pixel. */
async function indirect(renderer, scene, camera, gi, width, height, pictures = 16) {
  const sum = new Float32Array(4 * width * height);
  const eye = camera.clone();
  const outputs = { indirect: vec4(diffuseColor.rgb.mul(gi.irradiance).div(Math.PI), float(1)) };
  for (let k = 0; k < pictures; k += 1) {
    let mirrored = 0;
    for (let [i, digit] = [k, 0.5]; i; [i, digit] = [i >> 1, digit / 2]) mirrored += (i & 1) * digit;
    const middle = 0.5 / pictures - 0.5;
    eye.setViewOffset(2 * width, 2 * height, k / pictures + middle, mirrored + middle, 2 * width, 2 * height);
    const { indirect: pixels } = await read(renderer, scene, eye, [2 * width, 2 * height], outputs);
    for (let i = 0; i < pixels.length; i += 1) {
      const [x, y] = [(i >> 2) % (2 * width), Math.floor((i >> 2) / (2 * width))];
      sum[4 * ((y >> 1) * width + (x >> 1)) + (i & 3)] += pixels[i] / (4 * pictures);
    }
  }
  return sum;
}

/** The RGBA bytes of a renderer's canvas, right after it was drawn. */
function pixelsOf({ domElement: canvas }) {
  const context = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d");
  context.drawImage(canvas, 0, 0);
  return context.getImageData(0, 0, canvas.width, canvas.height).data;
}

/** A ball that no bake knows. */
function ballAt(at, radius = 0.4) {
  const ball = new THREE.Mesh(new THREE.SphereGeometry(radius, 64, 64), new THREE.MeshStandardMaterial({ color: 0xd8d8d8 }));
  ball.name = "ball";
  ball.position.set(...at);
  ball.updateMatrixWorld();
  return ball;
}

/** Mean bounced irradiance over a picture, under the lights as they are now. */
async function meanIrradiance(renderer, scene, camera, gi) {
  gi.update();
  const { e } = await read(renderer, scene, camera, SIZE, { e: vec4(gi.irradiance, 1) });
  return e.reduce((sum, x, i) => (i % 4 < 3 ? sum + x : sum), 0) / (0.75 * e.length);
}

/** A scene with the ball, and with what `model` holds if it is wanted, from the scene's camera or from `eye`. */
async function ballScene({ glb, at, eye }, withModel = false) {
  const renderer = await rendererOf();
  await renderer.init();
  const { model, lamps, camera } = await modelOf(glb);
  if (eye) {
    // Not the camera's parents, which turn it.
    camera.removeFromParent();
    camera.position.set(...eye);
    camera.lookAt(...at);
  }
  const scene = new THREE.Scene();
  const ball = ballAt(at);
  scene.add(ball);
  if (withModel) scene.add(model);
  return { renderer, model, lamps, camera, scene, ball, albedo: ball.material.color.r };
}

/** Radiance of a ball's bounced light by pixel, from our probes: rows from the bottom as three reads them; alpha `IS_BALL` where the ball is. */
async function ball(files) {
  const { renderer, lamps, camera, scene, albedo } = await ballScene(files);
  const gi = await Rebounce.load(bytesOf(files.rbn), { renderer });
  gi.lights.add(...lamps);
  scene.add(gi.light);
  const outputs = { e: vec4(gi.irradiance.mul(albedo / Math.PI), IS_BALL) };
  // What was drawn before there were probes gets their light, too.
  await read(renderer, scene, camera, SIZE, outputs);
  if (!(await gi.ready)) throw new Error("no probes");
  gi.update();
  const { e } = await read(renderer, scene, camera, SIZE, outputs);
  gi.dispose();
  renderer.dispose();
  return Array.from(e);
}

/** The relative root mean square of the difference, colours alone. */
function rms(found, expected) {
  let [error, power] = [0, 0];
  for (let i = 0; i < expected.length; i += 1) {
    if (i % 4 === 3) continue;
    error += (found[i] - expected[i]) ** 2;
    power += expected[i] ** 2;
  }
  return Math.sqrt(error / power);
}

globalThis.stage = { THREE, Rebounce, irradianceAt, rendererOf, modelOf, bytesOf, read, indirect, meanIrradiance, pixelsOf, ballAt, ballScene, ball, rms, warnings, tsl: { vec4, normalWorld, output, positionWorld, pass } };
