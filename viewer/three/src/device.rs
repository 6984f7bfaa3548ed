//! A GPU device for both renderers. wgpu hands out its device but takes no other, so that ours comes first.

use rebounce_viewer::ViewerError;
use rebounce_viewer::gpu::{Gpu, Requested};
use rebounce_viewer::passes::display::given::GivenPass;
use rebounce_viewer::pipelines::Pipelines;
use rebounce_viewer::probes::fill::ProbePass;
use rebounce_viewer::probes::hits::HitPass;
use rebounce_viewer::wasm::page::promise;
use std::cell::OnceCell;
use std::rc::Rc;
use wasm_bindgen::prelude::*;

/// Pipelines of a device.
pub(crate) struct Shared {
    pub(crate) gpu: Gpu,
    pub(crate) pipelines: Rc<Pipelines>,
    pub(crate) given: GivenPass,
    probes: OnceCell<(HitPass, ProbePass)>,
}

impl Shared {
    /// The pipelines of probes, made when first wanted.
    pub(crate) fn probes(&self) -> &(HitPass, ProbePass) {
        self.probes
            .get_or_init(|| (HitPass::new(&self.gpu, &self.pipelines.material), ProbePass::new(&self.gpu)))
    }
}

/// A device, with what all files on it share.
#[wasm_bindgen]
pub struct Device {
    pub(crate) shared: Rc<Shared>,
}

#[wasm_bindgen]
impl Device {
    /// Requests a device. Rejects with `no-adapter`, `no-device` or `internal`. `low_power`: rather the GPU that saves power.
    #[wasm_bindgen(unchecked_return_type = "Promise<Device>")]
    pub fn open(low_power: bool) -> js_sys::Promise {
        promise(async move {
            let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
                backends: wgpu::Backends::BROWSER_WEBGPU,
                ..wgpu::InstanceDescriptor::new_without_display_handle()
            });
            let power_preference = match low_power {
                true => wgpu::PowerPreference::LowPower,
                false => wgpu::PowerPreference::HighPerformance,
            };
            let options = wgpu::RequestAdapterOptions { power_preference, ..Default::default() };
            let adapter = instance.request_adapter(&options).await;
            let adapter = adapter.map_err(|_| ViewerError::NoAdapter("requestAdapter() gave none".into()))?;
            // Whoever loses the device is told by the device itself.
            let Requested { gpu, .. } = Gpu::request(&adapter).await?;
            let (pipelines, given) = gpu.watch(|| (Pipelines::new(&gpu), GivenPass::new(&gpu)));
            Ok(Device {
                shared: Rc::new(Shared {
                    pipelines: Rc::new(pipelines?),
                    given,
                    gpu,
                    probes: OnceCell::new(),
                }),
            })
        })
    }

    /// The browser's `GPUDevice`.
    pub fn handle(&self) -> JsValue {
        crate::object(self.shared.gpu.device.as_webgpu())
    }
}
