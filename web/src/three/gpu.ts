/** WebGPU's types as far as they are used here: not every TypeScript has them. */

/** A GPU device: the page's own type of `GPUDevice`, where there is one. */
export type Gpu = typeof globalThis extends { GPUDevice: { prototype: infer Own } } ? Own : AnyDevice;

interface AnyDevice extends EventTarget {
  readonly features: ReadonlySet<string>;
  readonly lost: Promise<{ readonly reason: string; readonly message: string }>;
  destroy(): void;
}

/** What a device is asked for, as three.js's `WebGPURenderer` would be. */
export interface DeviceOptions {
  /** Which of several GPUs; the fast one when absent. */
  powerPreference?: "high-performance" | "low-power";
  /** Limits beyond the default ones. */
  requiredLimits?: Record<string, number>;
}

/** What is set on a device here. */
export interface Listening {
  onuncapturederror: unknown;
}

/** What a device is asked for. */
export interface Wanted {
  requiredFeatures?: Iterable<string>;
  requiredLimits?: Record<string, number>;
}

/** An adapter. */
export interface Adapter {
  readonly features: ReadonlySet<string>;
  requestDevice(wanted?: Wanted): Promise<Gpu>;
}

/** The class of adapters. */
export const adapters = (): Adapter => (globalThis as unknown as { GPUAdapter: { prototype: Adapter } }).GPUAdapter.prototype;
