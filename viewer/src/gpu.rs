//! The GPU device: asked for with no more than WebGPU's default limits.

use crate::error::ViewerError;
use crate::oneshot::{self, Receiver};
use crate::refusals::{self, Refusal};
use std::future::Future;
use std::ops::Deref;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Bytes that WebGPU guarantees in one storage binding.
pub const MAX_BINDING: u64 = 128 << 20;
/// What a device is asked for.
pub const LIMITS: wgpu::Limits = wgpu::Limits::defaults();

/// A handle of a device. Several may share one; the device is destroyed with the last of them.
#[derive(Clone)]
pub struct Gpu {
    opened: Arc<Opened>,
    errors: Errors,
}

/// A device, its queue, and what it offers beyond the least that WebGPU guarantees.
pub struct Opened {
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
    /// Of work that nobody watches.
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

/// The first error since somebody asked; it is the cause, and what follows are its consequences.
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

    /// Most bytes of a buffer, and of a buffer that shaders read as storage.
    pub fn buffer_limits(&self) -> [u64; 2] {
        #[cfg(target_arch = "wasm32")]
        let limits = {
            let limits = crate::browser::device(&self.device).limits();
            [limits.buffer() as u64, limits.binding() as u64]
        };
        #[cfg(not(target_arch = "wasm32"))]
        let limits = {
            let limits = self.device.limits();
            [limits.max_buffer_size, limits.max_storage_buffer_binding_size]
        };
        limits
    }

    /// A handle of the same device for another user of it, with errors of its own: see [`Gpu::watch`].
    pub fn share(&self) -> Self {
        Self { opened: self.opened.clone(), errors: Errors::default() }
    }

    /// Does some work; what the device refuses of it is an error of this handle (and its clones), not of those that
    /// share the device.
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

    /// Waits until all that was watched so far is known.
    pub async fn settle(&self) {
        // The device answers in order; the second question is asked when those who wait for answers have them.
        for _ in 0..2 {
            refusals::end(refusals::begin(&self.device)).await;
        }
    }

    /// Whether [`Gpu::check`] has something to tell.
    pub fn has_error(&self) -> bool {
        self.errors.first().is_some()
    }

    /// `Ok` unless an error has been reported since the last call. Where something that all share was refused before,
    /// a pipeline for instance, that is the cause, and told instead.
    ///
    /// # Errors
    /// [`ViewerError::OutOfMemory`], or [`ViewerError::Internal`] with the device's words.
    pub fn check(&self) -> Result<(), ViewerError> {
        let Some(own) = self.errors.first().take() else { return Ok(()) };
        let Refusal { is_memory, message } = self.opened.errors.first().clone().unwrap_or(own);
        Err(if is_memory { ViewerError::OutOfMemory } else { ViewerError::Internal(message) })
    }
}

/// Runs to its end by itself.
#[cfg(target_arch = "wasm32")]
fn meanwhile(work: impl Future<Output = ()> + 'static) {
    wasm_bindgen_futures::spawn_local(work);
}

/// Runs to its end by itself; natively what is asked of a device is known at once.
#[cfg(not(target_arch = "wasm32"))]
fn meanwhile(work: impl Future<Output = ()>) {
    pollster::block_on(work);
}

/// `GPUDevice.adapterInfo` of this name.
#[cfg(target_arch = "wasm32")]
fn adapter_info(device: &wgpu::Device, name: &str) -> Option<wasm_bindgen::JsValue> {
    let info = js_sys::Reflect::get(crate::browser::device(device), &"adapterInfo".into()).ok()?;
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
fn is_software(device: &wgpu::Device) -> bool {
    adapter_info(device, "isFallbackAdapter").is_some_and(|flag| flag.is_truthy())
}

#[cfg(target_arch = "wasm32")]
fn has_timestamps(device: &wgpu::Device) -> bool {
    crate::browser::device(device).features().has(&"timestamp-query".into())
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
