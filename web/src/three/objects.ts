/** Which objects of a scene a file knows: those whose surfaces lie where the file has surfaces, and have not moved since. */

import { DoubleSide, Matrix4, Vector3, type BufferGeometry, type InstancedMesh, type Material, type Mesh, type Object3D, type Scene } from "three/webgpu";
import type { BouncedLight } from "../rebounce_three.js";
import { Once } from "./once.js";
import type { Space } from "./space.js";

/** Triangles looked at to tell whether a file knows an object, and the share of them that must be found. */
const TRIES = 16;
const SHARE = 0.75;
/** How near a surface of the file must be, as a share of the scene's diagonal; half as far in front of it places are sought. */
const NEAR = 2e-4;
/** Change of a matrix's element at which an object has moved, as a share of the largest one. */
const MOVED = 1e-5;

interface Seen {
  isKnown: boolean;
  /** Where it was when it was known. */
  localFromObject: Matrix4;
  geometry: BufferGeometry;
}

/** The objects of scenes, as a file knows them. */
export class Objects {
  #seen = new WeakMap<Object3D, Seen>();
  #once = new Once();
  #moved = new Matrix4();

  constructor(
    readonly light: BouncedLight,
    readonly space: Space,
    /** Length of the scene's diagonal, local space. */
    readonly diagonal: number,
  ) {}

  /** Whether the file's light holds for an object as it is now; an object that moved away is said once. */
  #holds(object: Object3D): boolean {
    const mesh = object as Mesh;
    if (!mesh.isMesh || "isSkinnedMesh" in mesh || "isBatchedMesh" in mesh || mesh.morphTargetInfluences?.some((share) => share !== 0)) return false;
    const now = this.#moved.multiplyMatrices(this.space.localFromWorld, mesh.matrixWorld);
    let seen = this.#seen.get(mesh);
    if (seen?.geometry !== mesh.geometry) {
      seen = { isKnown: this.#isOnSurfaces(mesh), localFromObject: now.clone(), geometry: mesh.geometry };
      this.#seen.set(mesh, seen);
    }
    if (!seen.isKnown) return false;
    const before = seen.localFromObject.elements;
    const largest = before.reduce((most, x) => Math.max(most, Math.abs(x)), 0);
    const isThere = now.elements.every((x, i) => Math.abs(x - (before[i] as number)) <= MOVED * largest);
    if (!isThere) {
      this.#once.warn(mesh, `"${mesh.name || mesh.type}" has moved since the bake: probes light it now, and light still bounces off its old place`);
    }
    return isThere;
  }

  /** The visible objects of a scene for which the light holds, and a number that changes with them. */
  held(scene: Scene): { held: Set<Object3D>; signature: number } {
    const held = new Set<Object3D>();
    let sum = 0;
    scene.traverseVisible((object) => {
      if (!this.#holds(object)) return;
      held.add(object);
      const { geometry, material, layers } = object as Mesh;
      const materials = Array.isArray(material) ? material : [material];
      for (const part of [object.id, geometry.id, layers.mask, ...materials.flatMap(({ id, version }) => [id, version])]) {
        sum = (Math.imul(sum, 31) + part) | 0;
      }
    });
    return { held, signature: sum };
  }

  #isOnSurfaces(mesh: Mesh): boolean {
    const places = triangles(mesh, this.space.localFromWorld, NEAR * 0.5 * this.diagonal);
    return places.length > 0 && this.light.shareOn(new Float32Array(places), NEAR * this.diagonal) >= SHARE;
  }
}

/** The middles of some triangles of a mesh, in local space, moved by `lift` to the front. */
function triangles(mesh: Mesh, localFromWorld: Matrix4, lift: number): number[] {
  const { position } = mesh.geometry.attributes;
  const { index } = mesh.geometry;
  if (!position) return [];
  const corners = index?.count ?? position.count;
  const count = Math.floor(corners / 3);
  const instances = (mesh as InstancedMesh).isInstancedMesh ? (mesh as InstancedMesh).count : 1;
  const places: number[] = [];
  const [a, b, c, normal] = [new Vector3(), new Vector3(), new Vector3(), new Vector3()];
  const localFromMesh = new Matrix4();
  const tries = Math.min(TRIES, count * instances);
  for (let k = 0; k < tries; k += 1) {
    const triangle = Math.floor(((k + 0.5) * count) / tries);
    localFromMesh.multiplyMatrices(localFromWorld, mesh.matrixWorld);
    if ((mesh as InstancedMesh).isInstancedMesh) {
      const own = new Matrix4();
      (mesh as InstancedMesh).getMatrixAt(Math.floor(((k + 0.5) * instances) / tries), own);
      localFromMesh.multiply(own);
    }
    for (const [i, corner] of [a, b, c].entries()) {
      const at = 3 * triangle + i;
      corner.fromBufferAttribute(position, index ? index.getX(at) : at).applyMatrix4(localFromMesh);
    }
    normal.crossVectors(b.clone().sub(a), c.clone().sub(a));
    const length = normal.length();
    if (length === 0) continue;
    const side = localFromMesh.determinant() < 0 || isBack(mesh.material) ? -1 : 1;
    places.push(...a.add(b).add(c).divideScalar(3).addScaledVector(normal, (side * lift) / length).toArray());
  }
  return places;
}

/** Whether the back of the triangles is what is seen. */
function isBack(material: Material | Material[]): boolean {
  const first = Array.isArray(material) ? material[0] : material;
  return first !== undefined && first.side !== DoubleSide && first.side !== 0;
}
