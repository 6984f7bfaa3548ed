// Files of `rebounce export` in three.js' WebGLRenderer, as a page of somebody else would show them. `shown` on the
// window is what page/exported.mjs calls.

import * as THREE from "three";
import { EXRLoader } from "three/addons/loaders/EXRLoader.js";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

const renderer = new THREE.WebGLRenderer({ antialias: false });

/** Loads a file; the camera is its own. */
async function load(address, [width, height]) {
  const { scene, cameras } = await new GLTFLoader().loadAsync(address);
  const [camera] = cameras;
  camera.aspect = width / height;
  camera.updateProjectionMatrix();
  return { scene, camera };
}

/** Pixels of a picture from the top, RGBA: each the mean of finer x finer ones. */
function draw({ scene, camera }, [width, height], finer, colorSpace) {
  const fine = new THREE.WebGLRenderTarget(width * finer, height * finer, { type: THREE.FloatType, colorSpace });
  renderer.setRenderTarget(fine);
  renderer.render(scene, camera);
  const pixels = new Float32Array(4 * fine.width * fine.height);
  renderer.readRenderTargetPixels(fine, 0, 0, fine.width, fine.height, pixels);
  fine.dispose();
  const mean = new Array(4 * width * height).fill(0);
  for (let i = 0; i < pixels.length; i += 1) {
    const [channel, pixel] = [i % 4, Math.floor(i / 4)];
    const x = Math.floor((pixel % fine.width) / finer);
    const y = height - 1 - Math.floor(Math.floor(pixel / fine.width) / finer);
    mean[4 * (y * width + x) + channel] += pixels[i] / (finer * finer);
  }
  return mean;
}

globalThis.shown = {
  /** Radiance of a file whose light is in a picture beside it. */
  async lightmap(address, light, size, finer) {
    const file = await load(address, size);
    const lightMap = await new EXRLoader().setDataType(THREE.FloatType).loadAsync(light);
    lightMap.channel = 1;
    // The loader's first row is the picture's last.
    lightMap.repeat.y = -1;
    lightMap.offset.y = 1;
    file.scene.traverse((object) => {
      if (!object.isMesh) return;
      const { color, map, emissive, emissiveMap, emissiveIntensity, alphaTest, transparent, opacity } = object.material;
      const shine = { emissive, emissiveMap, emissiveIntensity };
      object.material = new THREE.MeshLambertMaterial({ color, map, lightMap, ...shine, alphaTest, transparent, opacity });
    });
    return draw(file, size, finer, THREE.NoColorSpace);
  },
  /** The share of each pixel that a file covers as one of its animations has it at a time, seconds. */
  async silhouette(address, name, time, size, finer) {
    const { scene, cameras, animations } = await new GLTFLoader().loadAsync(address);
    const [camera] = cameras;
    const mixer = new THREE.AnimationMixer(scene);
    mixer.clipAction(animations.find((animation) => animation.name === name)).play();
    mixer.setTime(time);
    scene.traverse((object) => {
      if (!object.isMesh) return;
      object.material = new THREE.MeshBasicMaterial({ side: THREE.DoubleSide });
      // Bounds of a skinned mesh are those at rest.
      object.frustumCulled = false;
    });
    return draw({ scene, camera }, size, finer, THREE.NoColorSpace).filter((_, i) => i % 4 === 0);
  },
  /** Display values, linear, of a file that needs nothing. */
  async unlit(address, size, finer) {
    return draw(await load(address, size), size, finer, THREE.NoColorSpace);
  },
};
