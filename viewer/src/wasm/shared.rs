//! The page's device: all viewers of a page draw with one, as long as any of them lives.

use super::Callbacks;
use crate::browser;
use crate::error::ViewerError;
use crate::gpu::{Gpu, Requested};
use crate::oneshot::{self, Receiver, Sender};
use crate::pipelines::Pipelines;
use std::cell::{Cell, RefCell};
use std::rc::{Rc, Weak};
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::spawn_local;

thread_local! {
    static PRESENT: RefCell<Present> = const { RefCell::new(Present::None) };
}

/// How it stands with the device.
enum Present {
    None,
    /// Somebody has asked for one; these wait for the answer.
    Opening(Vec<Sender<()>>),
    Open(Weak<Shared>),
}

/// What the next who wants a device must do.
enum Next {
    Take(Rc<Shared>),
    Wait(Receiver<()>),
    Open,
}

/// A device and what belongs to it alone.
pub struct Shared {
    /// The device.
    pub gpu: Gpu,
    /// Its pipelines.
    pub pipelines: Rc<Pipelines>,
    /// Whether blue comes first in the format that canvases are shown in without a copy.
    pub is_bgra: bool,
    is_lost: Cell<bool>,
    /// Who is told when the device is lost.
    viewers: RefCell<Vec<Weak<Callbacks>>>,
}

impl Shared {
    /// The page's device; a new one where there is none, or none any more.
    ///
    /// # Errors
    /// [`ViewerError::NoWebGpu`], [`ViewerError::NoAdapter`], [`ViewerError::NoDevice`], [`ViewerError::Internal`].
    pub async fn get() -> Result<Rc<Self>, ViewerError> {
        loop {
            match PRESENT.with_borrow_mut(next) {
                Next::Take(shared) => return Ok(shared),
                // Then there is one; or none, and whoever comes first asks again.
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
        let is_bgra = page.unchecked_into::<browser::Gpu>().format() == "bgra8unorm";
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
            // Where nobody holds it any more, the last viewer has let it go.
            if let Some(shared) = held.upgrade() {
                shared.lose(message);
            }
        });
        Ok(shared)
    }

    /// The format of pictures on canvases. The shader encodes sRGB itself.
    pub fn format(&self) -> wgpu::TextureFormat {
        if self.is_bgra { wgpu::TextureFormat::Bgra8Unorm } else { wgpu::TextureFormat::Rgba8Unorm }
    }

    /// Tells these when the device is lost.
    pub fn watch(&self, viewer: &Rc<Callbacks>) {
        let mut viewers = self.viewers.borrow_mut();
        viewers.retain(|viewer| viewer.strong_count() > 0);
        viewers.push(Rc::downgrade(viewer));
    }

    fn lose(&self, message: String) {
        self.is_lost.set(true);
        let text = ViewerError::DeviceLost(message).to_string();
        // Whoever hears of it may let go of its viewer at once.
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
