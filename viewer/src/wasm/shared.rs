//! The page's device, shared by all viewers of a page while a viewer lives.

use super::callbacks::Callbacks;
use crate::error::ViewerError;
use crate::gpu::browser;
use crate::gpu::oneshot::{self, Receiver, Sender};
use crate::gpu::{Gpu, Requested};
use crate::renderer::pipelines::Pipelines;
use std::cell::{Cell, RefCell};
use std::rc::{Rc, Weak};
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::spawn_local;

thread_local! {
    static PRESENT: RefCell<Present> = const { RefCell::new(Present::None) };
}

/// State of the device.
enum Present {
    None,
    /// A request is in flight; these callers wait for the answer.
    Opening(Vec<Sender<()>>),
    Open(Weak<SharedDevice>),
}

/// Next action of a caller of [`SharedDevice::get`].
enum Next {
    Take(Rc<SharedDevice>),
    Wait(Receiver<()>),
    Open,
}

/// A device and its pipelines.
pub struct SharedDevice {
    /// The device.
    pub gpu: Gpu,
    /// The device's pipelines.
    pub pipelines: Rc<Pipelines>,
    /// Whether the canvas format without a copy is BGRA.
    pub is_bgra: bool,
    is_lost: Cell<bool>,
    /// Viewers to notify when the device is lost.
    viewers: RefCell<Vec<Weak<Callbacks>>>,
}

impl SharedDevice {
    /// Returns the page's device, or opens a new device if none is alive.
    ///
    /// # Errors
    /// [`ViewerError::NoWebGpu`], [`ViewerError::NoAdapter`], [`ViewerError::NoDevice`], [`ViewerError::Internal`].
    pub async fn get() -> Result<Rc<Self>, ViewerError> {
        loop {
            match PRESENT.with_borrow_mut(next) {
                Next::Take(shared) => return Ok(shared),
                // Afterwards a device exists, or the first waiting caller requests again.
                Next::Wait(answer) => answer.await,
                Next::Open => {
                    let opened = Self::open().await;
                    let present =
                        opened.as_ref().map_or(Present::None, |it| Present::Open(Rc::downgrade(it)));
                    if let Present::Opening(waiting) = PRESENT.replace(present) {
                        waiting.iter().for_each(|one| one.send(()));
                    }
                    return opened;
                }
            }
        }
    }

    async fn open() -> Result<Rc<Self>, ViewerError> {
        let page = js_sys::Reflect::get(&js_sys::global(), &"navigator".into())
            .and_then(|navigator| js_sys::Reflect::get(&navigator, &"gpu".into()))
            .ok()
            .filter(JsValue::is_truthy)
            .ok_or(ViewerError::NoWebGpu)?;
        let is_bgra = page.unchecked_into::<browser::BrowserGpu>().format() == "bgra8unorm";
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            backends: wgpu::Backends::BROWSER_WEBGPU,
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        });
        let adapter = instance
            .request_adapter(&wgpu::RequestAdapterOptions {
                power_preference: wgpu::PowerPreference::HighPerformance,
                ..Default::default()
            })
            .await
            .map_err(|_| ViewerError::NoAdapter("requestAdapter() gave none".into()))?;
        let Requested { gpu, lost } = Gpu::request(&adapter).await?;
        let pipelines = Rc::new(Pipelines::new(&gpu)?);
        let (is_lost, viewers) = (Cell::new(false), RefCell::default());
        let shared = Rc::new(Self { gpu, pipelines, is_bgra, is_lost, viewers });
        let held = Rc::downgrade(&shared);
        spawn_local(async move {
            let message = lost.await;
            // Without a holder, the last viewer has dropped the device.
            if let Some(shared) = held.upgrade() {
                shared.lose(message);
            }
        });
        Ok(shared)
    }

    /// Texture format of canvases. The shader encodes sRGB itself.
    pub fn format(&self) -> wgpu::TextureFormat {
        if self.is_bgra { wgpu::TextureFormat::Bgra8Unorm } else { wgpu::TextureFormat::Rgba8Unorm }
    }

    /// Notifies this viewer when the device is lost.
    pub fn watch(&self, viewer: &Rc<Callbacks>) {
        let mut viewers = self.viewers.borrow_mut();
        viewers.retain(|viewer| viewer.strong_count() > 0);
        viewers.push(Rc::downgrade(viewer));
    }

    fn lose(&self, message: String) {
        self.is_lost.set(true);
        let text = ViewerError::DeviceLost(message).to_string();
        // A callback may drop its viewer at once.
        let viewers: Vec<_> = self.viewers.borrow().iter().filter_map(Weak::upgrade).collect();
        for viewer in &viewers {
            viewer.is_lost.set(true);
        }
        for viewer in viewers {
            viewer.lose(&text);
        }
    }
}

fn next(present: &mut Present) -> Next {
    match present {
        Present::Opening(waiting) => {
            let (sender, answer) = oneshot::channel();
            waiting.push(sender);
            return Next::Wait(answer);
        }
        Present::Open(held) => {
            if let Some(shared) = held.upgrade().filter(|shared| !shared.is_lost.get()) {
                return Next::Take(shared);
            }
        }
        Present::None => {}
    }
    *present = Present::Opening(Vec::new());
    Next::Open
}
