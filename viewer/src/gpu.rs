//! The GPU device: asked for with no more than WebGPU's default limits.

use crate::error::ViewerError;
use crate::oneshot::{self, Receiver};
use std::sync::{Arc, Mutex, PoisonError};

/// A device, its queue, and what it offers beyond the least that WebGPU guarantees.
#[derive(Clone)]
pub struct Gpu {
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// Name of the adapter, for the statistics.
    pub adapter: String,
    /// Whether the adapter is the processor itself: what helps a GPU may not help there.
    pub software: bool,
    /// Whether passes can be timed.
    pub timestamps: bool,
    errors: Arc<Mutex<Option<String>>>,
}

/// What [`Gpu::request`] gives.
pub struct Requested {
    /// The device.
    pub gpu: Gpu,
    /// Ready with a reason when the device is lost.
    pub lost: Receiver<String>,
}

impl Gpu {
    /// Asks `adapter` for a device with WebGPU's default limits and, where present, timestamp
    /// queries.
    ///
    /// # Errors
    /// [`ViewerError::NoDevice`].
    pub async fn request(adapter: &wgpu::Adapter) -> Result<Requested, ViewerError> {
        let offered = adapter.features();
        let wanted = wgpu::Features::TIMESTAMP_QUERY;
        let (device, queue) = adapter
            .request_device(&wgpu::DeviceDescriptor {
                label: Some("rebounce"),
                required_features: offered & wanted,
                required_limits: wgpu::Limits::default(),
                ..Default::default()
            })
            .await
            .map_err(|e| ViewerError::NoDevice(e.to_string()))?;
        let (sender, lost) = oneshot::channel();
        device.set_device_lost_callback(move |_reason, message| sender.send(message));
        let errors = Arc::new(Mutex::new(None));
        let sink = errors.clone();
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            // The first error is the cause; what follows are its consequences.
            sink.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert_with(|| error.to_string());
        }));
        let info = adapter.get_info();
        let software = info.device_type == wgpu::DeviceType::Cpu || is_fallback(&device);
        let features = device.features();
        let name = adapter_name(&device);
        let gpu = Gpu {
            device,
            queue,
            adapter: if info.name.is_empty() { name } else { info.name },
            software,
            timestamps: features.contains(wgpu::Features::TIMESTAMP_QUERY),
            errors,
        };
        Ok(Requested { gpu, lost })
    }

    /// A native device without a window, software adapters included.
    ///
    /// # Errors
    /// [`ViewerError::NoAdapter`], [`ViewerError::NoDevice`].
    #[cfg(not(target_arch = "wasm32"))]
    pub fn headless() -> Result<Self, ViewerError> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))
            .map_err(|e| ViewerError::NoAdapter(e.to_string()))?;
        Ok(pollster::block_on(Self::request(&adapter))?.gpu)
    }

    /// The first error that the device reported since the last call, if any.
    pub fn take_error(&self) -> Option<String> {
        self.errors.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    /// `Ok` unless the device has reported an error since the last call.
    ///
    /// # Errors
    /// [`ViewerError::Internal`] with the device's words.
    pub fn check(&self) -> Result<(), ViewerError> {
        self.take_error().map_or(Ok(()), |message| Err(ViewerError::Internal(message)))
    }
}

/// `GPUDevice.adapterInfo` of this name.
#[cfg(target_arch = "wasm32")]
fn adapter_info(device: &wgpu::Device, name: &str) -> Option<wasm_bindgen::JsValue> {
    let info = js_sys::Reflect::get(device.as_webgpu()?, &"adapterInfo".into()).ok()?;
    js_sys::Reflect::get(&info, &name.into()).ok()
}

/// What the browser tells of the adapter: vendor and architecture.
#[cfg(target_arch = "wasm32")]
fn adapter_name(device: &wgpu::Device) -> String {
    let text = |name: &str| adapter_info(device, name).and_then(|v| v.as_string());
    let parts: Vec<String> = ["vendor", "architecture"].into_iter().filter_map(text).collect();
    parts.join(" ").trim().to_owned()
}

/// Whether the browser says that the adapter is one of software.
#[cfg(target_arch = "wasm32")]
fn is_fallback(device: &wgpu::Device) -> bool {
    adapter_info(device, "isFallbackAdapter").is_some_and(|flag| flag.is_truthy())
}

#[cfg(not(target_arch = "wasm32"))]
fn is_fallback(_: &wgpu::Device) -> bool {
    false
}

#[cfg(not(target_arch = "wasm32"))]
fn adapter_name(_: &wgpu::Device) -> String {
    String::new()
}
