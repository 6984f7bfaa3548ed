/** A GPU device for three.js and for us: wgpu hands out its own device, but takes no other. */

import { Device } from "../rebounce_three.js";
import { Failure, failureOf } from "../wire/failure.js";
import { adapters, type Adapter, type DeviceOptions, type Gpu, type Listening, type Wanted } from "./gpu.js";
import { loaded } from "./module.js";

/** The features that `WebGPURenderer` asks for where an adapter has them (`GPUFeatureName` in its constants). */
const FEATURES = [
  "core-features-and-limits",
  "depth-clip-control",
  "depth32float-stencil8",
  "texture-compression-bc",
  "texture-compression-bc-sliced-3d",
  "texture-compression-etc2",
  "texture-compression-astc",
  "texture-compression-astc-sliced-3d",
  "timestamp-query",
  "indirect-first-instance",
  "shader-f16",
  "rg11b10ufloat-renderable",
  "bgra8unorm-storage",
  "float32-filterable",
  "float32-blendable",
  "clip-distances",
  "dual-source-blending",
  "subgroups",
  "texture-formats-tier1",
  "texture-formats-tier2",
];

/** The devices that we opened, with what the wasm module holds of them. */
const devices = new WeakMap<object, Device>();

/** What the wasm module holds of a device; nothing of a foreign one. */
export const deviceOf = (device: object): Device | undefined => devices.get(device);

/** One request at a time: see `requesting`. */
let last: Promise<unknown> = Promise.resolve();

/** Opens a device. Rejects with `no-webgpu`, `no-adapter` or `no-device`. It lives until it is destroyed, or the page. */
export async function openDevice(options: DeviceOptions = {}): Promise<Gpu> {
  if (!("gpu" in navigator) || !navigator.gpu) {
    throw new Failure("no-webgpu", "This browser has no WebGPU, or the page is not secure: open it over https, or from localhost.");
  }
  await loaded();
  const opened = last.then(() => requesting(options, () => Device.open(options.powerPreference === "low-power")));
  last = opened.catch(() => undefined);
  try {
    const device = await opened;
    const handle = device.handle() as Gpu & Listening;
    // wgpu's handler of errors that nobody expects would be told of three's: our own are watched where they arise.
    handle.onuncapturederror = null;
    devices.set(handle, device);
    return handle;
  } catch (error) {
    throw failureOf(error);
  }
}

/** Runs `work`, which requests a device: wgpu's request names only features that wgpu has names for, and no limits of the page's. */
async function requesting<T>({ requiredLimits = {} }: DeviceOptions, work: () => Promise<T>): Promise<T> {
  const prototype = adapters();
  const { requestDevice } = prototype;
  prototype.requestDevice = function (this: Adapter, wanted: Wanted = {}) {
    const features = new Set([...(wanted.requiredFeatures ?? []), ...FEATURES.filter((name) => this.features.has(name))]);
    const limits: Record<string, number> = { ...wanted.requiredLimits };
    // Alignments are better when smaller.
    for (const [name, value] of Object.entries(requiredLimits)) {
      limits[name] = name.startsWith("min") ? Math.min(limits[name] ?? value, value) : Math.max(limits[name] ?? 0, value);
    }
    return requestDevice.call(this, { ...wanted, requiredFeatures: [...features], requiredLimits: limits });
  };
  try {
    return await work();
  } finally {
    prototype.requestDevice = requestDevice;
  }
}
