//! The browser's WebGPU objects, called directly where wgpu's wrapper costs kilobytes of the bundle.

use js_sys::{Promise, Uint8Array};
use wasm_bindgen::prelude::*;
use wgpu::webgpu::GpuTexture;

#[wasm_bindgen]
extern "C" {
    /// `GPU`.
    pub type BrowserGpu;
    /// The canvas format without a copy.
    #[wasm_bindgen(method, js_name = getPreferredCanvasFormat)]
    pub fn format(this: &BrowserGpu) -> String;

    /// `GPUDevice`.
    #[derive(Clone)]
    pub type Device;
    /// Optional features of the device.
    #[wasm_bindgen(method, getter)]
    pub fn features(this: &Device) -> js_sys::Set;
    /// Limits of the device.
    #[wasm_bindgen(method, getter)]
    pub fn limits(this: &Device) -> Limits;
    /// Opens an error scope.
    #[wasm_bindgen(method, js_name = pushErrorScope)]
    pub fn push(this: &Device, filter: &str);
    /// Closes the innermost error scope: its first error, or null.
    #[wasm_bindgen(method, js_name = popErrorScope)]
    pub fn pop(this: &Device) -> Promise;
    /// Handler of errors outside every error scope.
    #[wasm_bindgen(method, setter)]
    pub fn set_onuncapturederror(this: &Device, callback: JsValue);

    /// `GPUSupportedLimits`.
    pub type Limits;
    /// Maximum bytes of a buffer.
    #[wasm_bindgen(method, getter, js_name = maxBufferSize)]
    pub fn buffer(this: &Limits) -> f64;
    /// Maximum bytes of a storage buffer binding.
    #[wasm_bindgen(method, getter, js_name = maxStorageBufferBindingSize)]
    pub fn binding(this: &Limits) -> f64;

    /// `GPUUncapturedErrorEvent`.
    pub type Uncaptured;
    /// The error of the refused operation.
    #[wasm_bindgen(method, getter)]
    pub fn error(this: &Uncaptured) -> Error;

    /// `GPUError`.
    pub type Error;
    /// The device's message.
    #[wasm_bindgen(method, getter)]
    pub fn message(this: &Error) -> String;
    /// `GPUOutOfMemoryError`.
    #[wasm_bindgen(js_name = GPUOutOfMemoryError)]
    pub type OutOfMemory;

    /// `GPUQueue`.
    pub type Queue;
    /// Resolves when the submitted work is done.
    #[wasm_bindgen(method, js_name = onSubmittedWorkDone)]
    pub fn done(this: &Queue) -> Promise;

    /// `GPUBuffer`.
    pub type Buffer;
    /// Resolves when the buffer can be read (mode 1).
    #[wasm_bindgen(method, js_name = mapAsync)]
    pub fn map(this: &Buffer, mode: u32) -> Promise;
    /// The mapped bytes.
    #[wasm_bindgen(method, catch, js_name = getMappedRange)]
    pub fn range(this: &Buffer) -> Result<JsValue, JsValue>;
    /// Unmaps the buffer.
    #[wasm_bindgen(method)]
    pub fn unmap(this: &Buffer);

    /// `GPUCanvasContext`.
    pub type Context;
    /// Configures the canvas for a device.
    #[wasm_bindgen(method, catch)]
    pub fn configure(this: &Context, configuration: &JsValue) -> Result<(), JsValue>;
    /// Removes the configuration.
    #[wasm_bindgen(method)]
    pub fn unconfigure(this: &Context);
    /// The current texture of the canvas.
    #[wasm_bindgen(method, catch, js_name = getCurrentTexture)]
    pub fn texture(this: &Context) -> Result<GpuTexture, JsValue>;
}

fn object<T: JsCast>(handle: Option<&impl AsRef<JsValue>>) -> &T {
    handle.map_or(const { &JsValue::UNDEFINED }, AsRef::as_ref).unchecked_ref()
}

/// The browser's object behind a device.
pub fn device(device: &wgpu::Device) -> &Device {
    object(device.as_webgpu())
}

/// The browser's object behind a queue.
#[cfg(feature = "element")]
pub fn queue(queue: &wgpu::Queue) -> &Queue {
    object(queue.as_webgpu())
}

/// The browser's texture as one of a device that shares it: one level, 2D.
#[inline(always)]
pub fn wrapped(
    device: &wgpu::Device,
    texture: GpuTexture,
    format: wgpu::TextureFormat,
    usage: wgpu::TextureUsages,
    [width, height]: [u32; 2],
) -> wgpu::Texture {
    let descriptor = wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    };
    device.create_texture_from_webgpu_handle(texture, &descriptor, None)
}

/// The bytes of a mappable buffer.
///
/// # Errors
/// The browser's error, after the buffer or the device is destroyed.
pub async fn bytes(buffer: wgpu::Buffer) -> Result<Vec<u8>, JsValue> {
    let buffer: &Buffer = object(buffer.as_webgpu());
    buffer.map(1).await?;
    let bytes = Uint8Array::new(&buffer.range()?).to_vec();
    buffer.unmap();
    Ok(bytes)
}
