/** Draws places and normals of what a camera of three.js sees, for the lookup of bounced light. */

import {
  FloatType,
  NearestFilter,
  NodeMaterial,
  RendererUtils,
  RenderTarget,
  RGBAFormat,
  type Camera,
  type Material,
  type Object3D,
  type Scene,
  type WebGPURenderer,
} from "three/webgpu";
import { Fn, normalWorld, positionWorld, vec4 } from "three/tsl";
import { octahedralEncode } from "./octahedral.js";
import type { Space } from "./space.js";

/** What of a material decides where its surface is. */
const SHAPE = [
  "side",
  "map",
  "alphaMap",
  "alphaTest",
  "opacity",
  "displacementMap",
  "displacementScale",
  "displacementBias",
  "flatShading",
  "clippingPlanes",
  "clipIntersection",
  "positionNode",
  "geometryNode",
  "vertexNode",
  "colorNode",
  "opacityNode",
  "alphaTestNode",
  "maskNode",
  "depthNode",
  "wireframe",
] as const;

/** The types of three.js 0.187 lack the scene. */
type Utility = (renderer: WebGPURenderer, scene: Scene, state?: unknown) => unknown;

/** Draws into targets of positions. */
export class Positions {
  #materials = new Map<Material, { own: NodeMaterial; version: number }>();
  readonly #output: ReturnType<typeof vec4>;

  constructor(space: Space) {
    this.#output = placeAndNormal(space);
  }

  /** A target of a picture's size. */
  static target(width: number, height: number): RenderTarget {
    const target = new RenderTarget(width, height, {
      type: FloatType,
      format: RGBAFormat,
      minFilter: NearestFilter,
      magFilter: NearestFilter,
      generateMipmaps: false,
    });
    target.texture.name = "rebounce positions";
    return target;
  }

  /** Draws the opaque surfaces of these objects. */
  draw(renderer: WebGPURenderer, scene: Scene, camera: Camera, target: RenderTarget, objects: Set<Object3D>): void {
    const state = (RendererUtils.resetRendererAndSceneState as unknown as Utility)(renderer, scene);
    const { xr } = renderer;
    const isXr = xr.enabled;
    const { matrixWorldAutoUpdate } = scene;
    try {
      xr.enabled = false;
      scene.matrixWorldAutoUpdate = false;
      renderer.setClearColor(0x000000, 0);
      renderer.transparent = false;
      renderer.setRenderObjectFunction((object, of, by, geometry, material, group, lights, clipping, pass) => {
        if (!isSolid(material) || !objects.has(object)) return;
        renderer.renderObject(object, of, by, geometry, this.#shapeOf(material), group, lights, clipping, pass);
      });
      renderer.setRenderTarget(target);
      renderer.render(scene, camera);
    } finally {
      scene.matrixWorldAutoUpdate = matrixWorldAutoUpdate;
      xr.enabled = isXr;
      (RendererUtils.restoreRendererAndSceneState as unknown as Utility)(renderer, scene, state);
    }
  }

  /** Frees the materials. */
  dispose(): void {
    for (const { own } of this.#materials.values()) own.dispose();
    this.#materials.clear();
  }

  /** A material of the same shape that shows places. */
  #shapeOf(material: Material): NodeMaterial {
    let made = this.#materials.get(material);
    if (!made) {
      const own = new NodeMaterial();
      made = { own, version: -1 };
      this.#materials.set(material, made);
      const forget = () => {
        material.removeEventListener("dispose", forget);
        own.dispose();
        this.#materials.delete(material);
      };
      material.addEventListener("dispose", forget);
    }
    const { own } = made;
    if (made.version !== material.version) {
      made.version = material.version;
      const from = material as unknown as Record<string, unknown>;
      const to = own as unknown as Record<string, unknown>;
      for (const name of SHAPE) if (from[name] !== undefined) to[name] = from[name];
      own.outputNode = this.#output;
      own.lights = false;
      own.fog = false;
      own.needsUpdate = true;
    }
    return own;
  }
}

/** As place_given.wgsl reads it: the place in local space, and 1 + x + 4096 y of the normal's octahedral map. */
function placeAndNormal(space: Space): ReturnType<typeof vec4> {
  return Fn(() => {
    const place = space.localNode.mul(vec4(positionWorld, 1)).xyz;
    const normal = space.localNode.mul(vec4(normalWorld, 0)).xyz;
    const square = octahedralEncode(normal).mul(0.5).add(0.5).mul(4095).round();
    return vec4(place, square.y.mul(4096).add(square.x).add(1));
  })() as unknown as ReturnType<typeof vec4>;
}

/** Whether nothing shows through a material. */
function isSolid(material: Material): boolean {
  const { transparent, visible } = material;
  return visible && !transparent && !((material as { transmission?: number }).transmission ?? 0);
}
