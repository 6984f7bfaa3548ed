/** The space of a file: that of the object which the baked scene hangs on, with the file's origin in its middle. */

import { Matrix4, Vector3, type Camera, type Object3D } from "three/webgpu";
import { renderGroup, uniform } from "three/tsl";

/** From three's world to the space of a file. */
export class Space {
  /** Places of the file, local to its origin, from those of three's world. */
  readonly localFromWorld = new Matrix4();
  /** The same for shaders; of the render group, as three.js does not look at other uniforms of things that rest. */
  readonly localNode = uniform(this.localFromWorld).setGroup(renderGroup);
  /** The same without the origin: world space of the file. */
  readonly fileFromWorld = new Matrix4();
  /** Length in the file of a length 1 in three's world. */
  scale = 1;

  constructor(
    readonly root: Object3D | undefined,
    readonly origin: Vector3,
  ) {
    this.update();
  }

  /** Follows the root. */
  update(): void {
    if (this.root) {
      this.root.updateWorldMatrix(true, false);
      this.fileFromWorld.copy(this.root.matrixWorld).invert();
    }
    this.scale = this.fileFromWorld.getMaxScaleOnAxis();
    this.localFromWorld.makeTranslation(-this.origin.x, -this.origin.y, -this.origin.z).multiply(this.fileFromWorld);
  }

  /** A camera as the wasm module takes it: eye, right, up and forward in local space. */
  camera(camera: Camera): Float32Array {
    const localFromView = new Matrix4().multiplyMatrices(this.localFromWorld, camera.matrixWorld);
    const place = (x: number, y: number) => new Vector3(x, y, 0.5).applyMatrix4(camera.projectionMatrixInverse);
    // Of an orthographic camera, as from far away: the eye matters for openness alone.
    const isFlat = camera.projectionMatrix.elements[15] === 1;
    const far = isFlat ? 1e3 * place(0, 1).distanceTo(place(0, -1)) : 0;
    const eye = new Vector3(0, 0, far);
    /** The way to a place of the picture, as long as it is at distance 1 along the view. */
    const way = (x: number, y: number) => {
      const offset = place(x, y).sub(eye);
      const end = offset.divideScalar(-offset.z).add(eye).applyMatrix4(localFromView);
      return end.sub(eye.clone().applyMatrix4(localFromView)).divideScalar(this.scale);
    };
    const forward = way(0, 0);
    const vectors = [eye.clone().applyMatrix4(localFromView), way(1, 0).sub(forward), way(0, 1).sub(forward), forward];
    return new Float32Array(vectors.flatMap((vector) => vector.toArray()));
  }
}
