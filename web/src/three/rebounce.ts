/** The bounced light of a .rbn file in a scene of three.js. */

import { Vector2, Vector3, type Node, type NodeFrame, type Object3D, type Texture, type WebGPURenderer } from "three/webgpu";
import type { DataTexture, WebGLRenderer } from "three";
import { BouncedLight, type Device } from "../rebounce_three.js";
import { Failure, failureOf } from "../wire/failure.js";
import type { Light as OwnLight } from "../wire/light-kinds.js";
import { fileNames, lightNumbers, lightsOf } from "../wire/wire.js";
import { bakeScene, type BakeOptions } from "./bake.js";
import { deviceOf, openDevice } from "./device.js";
import { pictureOf } from "./environment.js";
import type { DeviceOptions, Gpu } from "./gpu.js";
import { RebounceLight } from "./light.js";
import { FollowedLights } from "./lights.js";
import { Lookup } from "./lookup.js";
import { Objects } from "./objects.js";
import { Pixels, type PixelSources } from "./pixels.js";
import { Positions } from "./positions.js";
import type { ProbeData, ProbeOptions } from "./probe-grid.js";
import { ProbeNodes } from "./probe-nodes.js";
import { Probes } from "./probes.js";
import { Space } from "./space.js";
import { WebGLGrid } from "./webgl-grid.js";

/** How a file is loaded. */
export interface LoadOptions {
  /** The renderer that shows the scene: `WebGPURenderer` on a device of `Rebounce.device()`, or one that draws through WebGL, which gets probes alone. Without one there are probes to read. */
  renderer?: WebGPURenderer | WebGLRenderer;
  /** The object that the baked scene hangs on, where that is not the world itself: scaled evenly, if at all. */
  root?: Object3D;
  /** Looks every pixel up by itself, instead of every second one and edges. */
  everyPixel?: boolean;
  /** Whether openness of pixels modulates the light; true when absent. */
  detail?: boolean;
  /** How probes for moving, transparent and foreign objects are made; false for none. */
  probes?: ProbeOptions | false;
  /** Gives up when it aborts. */
  signal?: AbortSignal;
}

/** Bytes on the GPU. */
export interface Memory {
  /** Of the file. */
  scene: number;
  /** Of pictures. */
  pixels: number;
  /** Of probes. */
  probes: number;
}

/** A file: its bytes, or where they are. */
export type Source = string | URL | ArrayBuffer | Uint8Array | Blob;

/** Pictures kept for targets at most. */
const TARGETS = 4;

/** Bounced light for a scene of three.js. */
export class Rebounce {
  /** The light to put into the scene. */
  readonly light: RebounceLight | WebGLGrid;
  /** The lights of the scene whose light bounces. */
  readonly lights = new FollowedLights();
  /**
   * What of the file shines and is no light of three: its sky, its shining surfaces, its area lights, in the form of
   * SHOT.json. They shine as the file says; change them, or take them out, as you like.
   */
  readonly fileLights: OwnLight[];
  /** Resolves when probes light what the file does not know; with false where there are none. */
  readonly ready: Promise<boolean>;
  readonly #from: PixelSources;
  readonly #lookup: Lookup;
  readonly #nodes = new ProbeNodes();
  /** A device of our own, where the renderer does not draw on it, so that no pixels can be looked up. */
  readonly #ownDevice: Device | undefined;
  #probes: Probes | undefined;
  #pixels = new Map<object, Pixels>();
  #numbers: Float64Array | undefined;
  #own: OwnLight[] = [];
  #isDisposed = false;

  /**
   * A GPU device for the renderer and for us, made with every feature that `WebGPURenderer` asks for:
   * `new WebGPURenderer({ device: await Rebounce.device() })`. Rejects with an error whose `code` says what is missing.
   */
  static device(options?: DeviceOptions): Promise<Gpu> {
    return openDevice(options);
  }

  /** Loads a .rbn file. Rejects with an error whose `code` says what is wrong, or with the signal's reason. */
  static async load(source: Source, options: LoadOptions = {}): Promise<Rebounce> {
    const { renderer, signal } = options;
    signal?.throwIfAborted();
    const device = await deviceFor(renderer);
    const bytes = await bytesOf(source, signal);
    const light = await opened(device.of, bytes, options.probes !== false);
    if (signal?.aborted) light.free();
    signal?.throwIfAborted();
    return new Rebounce(light, options, device.isShared ? undefined : device.of);
  }

  /** Bakes what a scene, or a part of it, shows now, and loads it: the same objects are known then. Rejects with an error whose message is a sentence. */
  static async bake(scene: Object3D, options: LoadOptions & BakeOptions): Promise<Rebounce> {
    const file = await bakeScene(scene, options);
    return Rebounce.load(file, options);
  }

  /** @internal */
  constructor(light: BouncedLight, { renderer, root, everyPixel = false, detail = true, probes = {} }: LoadOptions, ownDevice?: Device) {
    const [x0 = 0, y0 = 0, z0 = 0, x1 = 0, y1 = 0, z1 = 0] = light.bounds();
    const diagonal = Math.hypot(x1 - x0, y1 - y0, z1 - z0);
    const space = new Space(root, new Vector3(...light.origin()));
    const objects = new Objects(light, space, diagonal);
    this.#from = { light, space, objects, positions: new Positions(space), lit: 0, everyPixel, detail };
    this.#lookup = new Lookup(space, light.isBumpy(), diagonal, probes === false ? undefined : (place, normal, wanted) => this.#nodes.irradiance(place, normal, wanted));
    this.#ownDevice = ownDevice;
    this.light = isNodeRenderer(renderer) ? new RebounceLight(this) : new WebGLGrid();
    this.fileLights = ownLights(light);
    if (probes === false) {
      this.ready = Promise.resolve(false);
      return;
    }
    const upload = (texture: Texture) => isNodeRenderer(renderer) && renderer.initTexture(texture);
    this.#probes = new Probes(light, probes, ownDevice && upload);
    this.#nodes.set(this.#probes);
    this.ready = this.#build(this.#probes);
  }

  /** Irradiance of the surface that is shaded, as a node: for materials of your own. */
  get irradiance(): Node<"vec3"> {
    return this.#lookup.node;
  }

  /** The lights that bounce, as they were last followed, and those of the file, in the form of SHOT.json. */
  get shotLights(): OwnLight[] {
    return structuredClone(this.#own);
  }

  /** Follows the lights, and relights: once a frame, before it is drawn. */
  update(): void {
    if (this.#isDisposed) return;
    const { light, space } = this.#from;
    space.update();
    this.#own = [...this.lights.in(space), ...this.fileLights];
    const numbers = lightNumbers(this.#own);
    if (numbers.length !== this.#numbers?.length || numbers.some((x, i) => !Object.is(x, this.#numbers?.[i]))) {
      light.setLights(numbers);
      this.#numbers = numbers;
    }
    if (light.relight()) this.#from.lit += 1;
    this.#probes?.update(this.#from.lit, (radiance) => this.light instanceof WebGLGrid && this.light.copyProbes(this.#probes as Probes, radiance, space));
  }

  /**
   * The picture of the environment: an equirectangular texture of floats, as three's loaders of .hdr and .exr give it;
   * the file's own for none. Its light, of the type `environment`, is one of `fileLights`: there is one from now on.
   * Throws `bad-environment` for another texture.
   */
  setEnvironment(texture?: DataTexture | null): void {
    if (this.#isDisposed) return;
    const { width, scale, texels } = texture ? pictureOf(texture) : { width: 0, scale: 1, texels: new Uint32Array() };
    this.#from.light.setEnvironment(width, scale, texels);
    if (texture && !this.fileLights.some(({ type }) => type === "environment")) this.fileLights.push({ type: "environment", intensity: 1 });
  }

  /** What probes hold now, for other renderers; nothing before they are `ready`. */
  async readProbes(): Promise<ProbeData | undefined> {
    this.update();
    return this.#probes?.read();
  }

  /** @internal */
  prepare({ renderer: any, scene, camera }: NodeFrame): void {
    if (this.#isDisposed || this.#ownDevice || !any || !scene || !camera || "isArrayCamera" in camera) return this.#lookup.set();
    const renderer = any as WebGPURenderer;
    const target = renderer.getRenderTarget();
    const { width, height } = target ?? renderer.getDrawingBufferSize(new Vector2());
    const key: object = target ?? renderer;
    let pixels = this.#pixels.get(key);
    if (pixels?.width !== width || pixels.height !== height) {
      pixels?.dispose();
      pixels = new Pixels(renderer, this.#from, width, height);
    }
    // The one that was used last comes last.
    this.#pixels.delete(key);
    this.#pixels.set(key, pixels);
    for (const [old, of] of this.#pixels) {
      if (this.#pixels.size <= TARGETS) break;
      of.dispose();
      this.#pixels.delete(old);
    }
    pixels.update(renderer, scene, camera, this.#from);
    this.#lookup.set(pixels.places, pixels.irradiance);
  }

  /** Bytes on the GPU. */
  memory(): Memory {
    if (this.#isDisposed) return { scene: 0, pixels: 0, probes: 0 };
    const { bytes } = JSON.parse(this.#from.light.stats()) as { bytes: Record<string, number> };
    const sum = (numbers: number[]) => numbers.reduce((all, some) => all + some, 0);
    return { scene: sum(Object.values(bytes)), pixels: sum([...this.#pixels.values()].map((one) => one.bytes)), probes: this.#probes?.bytes ?? 0 };
  }

  /** Frees everything; the light gives nothing from then on. The device lives on. */
  dispose(): void {
    if (this.#isDisposed) return;
    this.#isDisposed = true;
    this.light.removeFromParent();
    this.light.dispose();
    this.#lookup.set();
    this.#nodes.set(undefined);
    this.#probes?.dispose();
    this.#probes = undefined;
    for (const pixels of this.#pixels.values()) pixels.dispose();
    this.#pixels.clear();
    this.#from.positions.dispose();
    this.#lookup.dispose();
    this.#nodes.dispose();
    this.#from.light.free();
    this.#ownDevice?.free();
  }

  async #build(probes: Probes): Promise<boolean> {
    try {
      const isBuilt = await probes.build();
      if (isBuilt && !this.#isDisposed) this.#from.lit += 1;
      return isBuilt && !this.#isDisposed;
    } catch (error) {
      // Disposed meanwhile, or the device is lost.
      if (!this.#isDisposed) console.warn(`rebounce: there are no probes: ${failureOf(error).message}`);
      return false;
    }
  }
}

/** The lights of a file that loaders of three make no light of. */
function ownLights(light: BouncedLight): OwnLight[] {
  const names = fileNames(light);
  const named = lightsOf(light.lights()).map((own, i) => ({ ...own, ...(names[i] && { name: names[i] }) }));
  return named.filter(({ type }) => !["point", "spot", "directional"].includes(type));
}

/** Whether a renderer has node materials: `WebGPURenderer`, on WebGPU or WebGL. */
const isNodeRenderer = (renderer: LoadOptions["renderer"]): renderer is WebGPURenderer => renderer !== undefined && "backend" in renderer;

/** Our device behind a renderer; one of its own where the renderer draws through WebGL. */
async function deviceFor(renderer: LoadOptions["renderer"]): Promise<{ of: Device; isShared: boolean }> {
  if (isNodeRenderer(renderer)) {
    await renderer.init();
    const { device } = renderer.backend as unknown as { device?: object };
    const shared = device && deviceOf(device);
    if (shared) return { of: shared, isShared: true };
    if (device) {
      throw new Failure("foreign-device", "The renderer has a GPU device of its own: make it with new WebGPURenderer({ device: await Rebounce.device() }).");
    }
  }
  return { of: deviceOf(await openDevice()) as Device, isShared: false };
}

async function opened(device: Device, bytes: Uint8Array, probes: boolean): Promise<BouncedLight> {
  const light = new BouncedLight(device);
  try {
    await light.load(bytes, probes);
    return light;
  } catch (error) {
    light.free();
    throw failureOf(error);
  }
}

/** The bytes of a file. */
async function bytesOf(source: Source, signal: AbortSignal | undefined): Promise<Uint8Array> {
  if (source instanceof Uint8Array) return source;
  if (source instanceof ArrayBuffer) return new Uint8Array(source);
  if (source instanceof Blob) return new Uint8Array(await source.arrayBuffer());
  let response: Response;
  try {
    response = await fetch(source, signal ? { signal } : {});
  } catch (cause) {
    signal?.throwIfAborted();
    throw new Failure("network", `The file ${source} could not be loaded; check the connection.`, { cause });
  }
  if (!response.ok) throw new Failure("http", `The file ${source} could not be loaded: the server answered ${response.status}.`);
  return new Uint8Array(await response.arrayBuffer());
}
