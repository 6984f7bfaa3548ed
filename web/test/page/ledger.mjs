// In the page: counts what is asked of WebGPU, and what of it is alive.

/**
 * Runs before the page's scripts. Then `gpu.devices` are the devices given, `gpu.alive` and `gpu.bytes` count the buffers
 * and textures that nobody has destroyed, `gpu.pipelines` what was compiled. `gpu.onbuffer` is called with the device
 * for every buffer. The end of a device ends nothing here: who made a thing must have destroyed it.
 */
export function ledger() {
  const gpu = (globalThis.gpu = { devices: [], alive: 0, bytes: 0, pipelines: 0, onbuffer: undefined, ondevice: undefined });
  const sizes = new WeakMap();
  const hold = (thing, bytes) => {
    sizes.set(thing, bytes);
    gpu.alive += 1;
    gpu.bytes += bytes;
    return thing;
  };
  // Of the formats in use; any other makes the counts NaN, which no test takes for a number.
  const texel = { depth32float: 4, rg32uint: 8, rgba16float: 8, rgba32uint: 16, rgba32float: 16, rgba8unorm: 4, bgra8unorm: 4 };
  const textureBytes = ({ width, height, depthOrArrayLayers, mipLevelCount, format }) => {
    let texels = 0;
    for (let level = 0; level < mipLevelCount; level += 1) {
      texels += Math.max(width >> level, 1) * Math.max(height >> level, 1) * depthOrArrayLayers;
    }
    return texels * texel[format.replace("-srgb", "")];
  };
  const wrap = (type, name, around) => {
    const original = type.prototype[name];
    type.prototype[name] = function (...args) {
      return around(() => original.apply(this, args), this, args);
    };
  };
  wrap(GPUAdapter, "requestDevice", async (call) => {
    const device = await call();
    gpu.devices.push(device);
    gpu.ondevice?.(device);
    return device;
  });
  wrap(GPUDevice, "createBuffer", (call, device) => {
    const buffer = call();
    gpu.onbuffer?.(device);
    return hold(buffer, buffer.size);
  });
  wrap(GPUDevice, "createTexture", (call) => {
    const texture = call();
    return hold(texture, textureBytes(texture));
  });
  for (const kind of ["createRenderPipeline", "createComputePipeline"]) {
    wrap(GPUDevice, kind, (call) => {
      gpu.pipelines += 1;
      return call();
    });
  }
  for (const type of [GPUBuffer, GPUTexture]) {
    wrap(type, "destroy", (call, thing) => {
      if (sizes.has(thing)) {
        gpu.alive -= 1;
        gpu.bytes -= sizes.get(thing);
        sizes.delete(thing);
      }
      return call();
    });
  }
}
