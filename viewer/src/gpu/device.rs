//! The GPU device, requested with WebGPU's default limits.

use super::oneshot::{self, Receiver};
use super::refusals::{self, Refusal};
use crate::error::ViewerError;
use std::future::Future;
use std::ops::Deref;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Bytes of one storage binding that WebGPU guarantees.
pub const MAX_BINDING: u64 = 128 << 20;
/// Texture array layers that WebGPU guarantees.
pub const MAX_LAYERS: u32 = 256;
/// Limits of the requested device.
pub const LIMITS: wgpu::Limits = wgpu::Limits::defaults();

/// A handle of a device. Several handles may share a device; the last handle dropped destroys the device.
#[derive(Clone)]
pub struct Gpu {
    opened: Arc<Opened>,
    errors: Errors,
}

/// A device, its queue, and its properties beyond WebGPU's minimum.
pub struct Opened {
    /// The device.
    pub device: wgpu::Device,
    /// The device's queue.
    pub queue: wgpu::Queue,
    /// Name of the adapter, for the statistics.
    pub adapter: String,
    /// Whether the adapter is a software renderer on the CPU: optimizations for GPUs may not help there.
    pub software: bool,
    /// Whether passes can be timed.
    pub timestamps: bool,
    /// Errors outside [`Gpu::watch`].
    errors: Errors,
}

impl Drop for Opened {
    fn drop(&mut self) {
        self.device.destroy();
    }
}

impl Deref for Gpu {
    type Target = Opened;

    fn deref(&self) -> &Opened {
        &self.opened
    }
}

/// The first error since the last [`Gpu::check`]: the cause. Later errors are consequences and are dropped.
#[derive(Clone, Default)]
struct Errors(Arc<Mutex<Option<Refusal>>>);

impl Errors {
    fn note(&self, refusal: Refusal) {
        self.first().get_or_insert(refusal);
    }

    fn first(&self) -> MutexGuard<'_, Option<Refusal>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Result of [`Gpu::request`].
pub struct Requested {
    /// The device.
    pub gpu: Gpu,
    /// Receives a reason when the device is lost.
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
                required_limits: LIMITS,
                ..Default::default()
            })
            .await
            .map_err(|e| ViewerError::NoDevice(e.to_string()))?;
        let (sender, lost) = oneshot::channel();
        device.set_device_lost_callback(move |_reason, message| sender.send(message));
        let errors = Errors::default();
        let sink = errors.clone();
        refusals::listen(&device, move |refusal| sink.note(refusal));
        let (name, software) = (adapter_name(&device), is_software(&device));
        let opened = Opened {
            timestamps: has_timestamps(&device),
            device,
            queue,
            adapter: name,
            software,
            errors: errors.clone(),
        };
        Ok(Requested { gpu: Self { opened: Arc::new(opened), errors }, lost })
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

    /// Maximum bytes of a buffer, and of a storage buffer binding.
    pub fn buffer_limits(&self) -> [u64; 2] {
        #[cfg(target_arch = "wasm32")]
        let limits = {
            let limits = super::browser::device(&self.device).limits();
            [limits.buffer() as u64, limits.binding() as u64]
        };
        #[cfg(not(target_arch = "wasm32"))]
        let limits = {
            let limits = self.device.limits();
            [limits.max_buffer_size, limits.max_storage_buffer_binding_size]
        };
        limits
    }

    /// A handle of the same device with its own errors: see [`Gpu::watch`].
    pub fn share(&self) -> Self {
        Self { opened: self.opened.clone(), errors: Errors::default() }
    }

    /// Runs `work`; refusals by the device become errors of this handle (and its clones), not of other handles of
    /// the device.
    pub fn watch<T>(&self, work: impl FnOnce() -> T) -> T {
        let watch = refusals::begin(&self.device);
        let done = work();
        let (refused, errors) = (refusals::end(watch), self.errors.clone());
        meanwhile(async move {
            if let Some(refusal) = refused.await {
                errors.note(refusal);
            }
        });
        done
    }

    /// Waits for the results of all earlier [`Gpu::watch`] calls.
    pub async fn settle(&self) {
        // The device answers in order; the second query follows after the waiting tasks have received their
        // answers.
        for _ in 0..2 {
            refusals::end(refusals::begin(&self.device)).await;
        }
    }

    /// Whether [`Gpu::check`] would return an error.
    pub fn has_error(&self) -> bool {
        self.errors.first().is_some()
    }

    /// `Ok` unless an error has been reported since the last call. An earlier refusal of a shared resource, for
    /// instance a pipeline, is the cause and is returned instead.
    ///
    /// # Errors
    /// [`ViewerError::OutOfMemory`], or [`ViewerError::Internal`] with the device's message.
    pub fn check(&self) -> Result<(), ViewerError> {
        let Some(own) = self.errors.first().take() else { return Ok(()) };
        let Refusal { is_memory, message } = self.opened.errors.first().clone().unwrap_or(own);
        Err(if is_memory { ViewerError::OutOfMemory } else { ViewerError::Internal(message) })
    }
}

/// Runs a future in the background.
#[cfg(target_arch = "wasm32")]
fn meanwhile(work: impl Future<Output = ()> + 'static) {
    wasm_bindgen_futures::spawn_local(work);
}

/// Runs a future to completion; a native device answers immediately.
#[cfg(not(target_arch = "wasm32"))]
fn meanwhile(work: impl Future<Output = ()>) {
    pollster::block_on(work);
}

/// Property `name` of `GPUDevice.adapterInfo`.
#[cfg(target_arch = "wasm32")]
fn adapter_info(device: &wgpu::Device, name: &str) -> Option<wasm_bindgen::JsValue> {
    let info = js_sys::Reflect::get(super::browser::device(device), &"adapterInfo".into()).ok()?;
    js_sys::Reflect::get(&info, &name.into()).ok()
}

/// Vendor and architecture of the adapter, as the browser reports.
#[cfg(target_arch = "wasm32")]
fn adapter_name(device: &wgpu::Device) -> String {
    let text = |name: &str| adapter_info(device, name).and_then(|v| v.as_string()).unwrap_or_default();
    (text("vendor") + " " + &text("architecture")).trim().to_owned()
}

/// Whether the browser reports a software adapter.
#[cfg(target_arch = "wasm32")]
fn is_software(device: &wgpu::Device) -> bool {
    adapter_info(device, "isFallbackAdapter").is_some_and(|flag| flag.is_truthy())
}

#[cfg(target_arch = "wasm32")]
fn has_timestamps(device: &wgpu::Device) -> bool {
    super::browser::device(device).features().has(&"timestamp-query".into())
}

#[cfg(not(target_arch = "wasm32"))]
fn adapter_name(device: &wgpu::Device) -> String {
    device.adapter_info().name
}

#[cfg(not(target_arch = "wasm32"))]
fn is_software(device: &wgpu::Device) -> bool {
    device.adapter_info().device_type == wgpu::DeviceType::Cpu
}

#[cfg(not(target_arch = "wasm32"))]
fn has_timestamps(device: &wgpu::Device) -> bool {
    device.features().contains(wgpu::Features::TIMESTAMP_QUERY)
}
