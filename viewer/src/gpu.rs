//! The GPU device: asked for with no more than WebGPU's default limits.

use crate::error::ViewerError;
use crate::oneshot::{self, Receiver};
use std::future::Future;
use std::ops::Deref;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

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

/// What the device has refused.
#[derive(Clone)]
struct Refusal {
    /// For want of memory.
    is_memory: bool,
    /// The device's words.
    message: String,
}

impl Errors {
    fn note(&self, error: &wgpu::Error) {
        let is_memory = matches!(error, wgpu::Error::OutOfMemory { .. });
        self.first().get_or_insert_with(|| Refusal { is_memory, message: error.to_string() });
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
                required_limits: wgpu::Limits::default(),
                ..Default::default()
            })
            .await
            .map_err(|e| ViewerError::NoDevice(e.to_string()))?;
        let (sender, lost) = oneshot::channel();
        device.set_device_lost_callback(move |_reason, message| sender.send(message));
        let errors = Errors::default();
        let sink = errors.clone();
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| sink.note(&error)));
        let info = adapter.get_info();
        let software = info.device_type == wgpu::DeviceType::Cpu || is_fallback(&device);
        let features = device.features();
        let name = adapter_name(&device);
        let opened = Opened {
            device,
            queue,
            adapter: if info.name.is_empty() { name } else { info.name },
            software,
            timestamps: features.contains(wgpu::Features::TIMESTAMP_QUERY),
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

    /// A handle of the same device for another user of it, with errors of its own: see [`Gpu::watch`].
    pub fn share(&self) -> Self {
        Self { opened: self.opened.clone(), errors: Errors::default() }
    }

    /// Does some work; what the device refuses of it is an error of this handle (and its clones), not of those that
    /// share the device.
    pub fn watch<T>(&self, work: impl FnOnce() -> T) -> T {
        use wgpu::ErrorFilter::{Internal, OutOfMemory, Validation};
        let mut watches =
            Vec::from([OutOfMemory, Internal, Validation].map(|f| self.device.push_error_scope(f)));
        let done = work();
        let mut answers = Vec::new();
        while let Some(watch) = watches.pop() {
            answers.push(watch.pop());
        }
        let errors = self.errors.clone();
        meanwhile(async move {
            // Whatever uses what there was no memory for is refused, too: memory is the cause, and known last.
            let mut cause = None;
            for answer in answers {
                cause = answer.await.or(cause);
            }
            if let Some(error) = cause {
                errors.note(&error);
            }
        });
        done
    }

    /// Waits until all that was watched so far is known.
    pub async fn settle(&self) {
        // The device answers in order; the second question is asked when those who wait for answers have them.
        for _ in 0..2 {
            self.device.push_error_scope(wgpu::ErrorFilter::Validation).pop().await;
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
