//! What the page is told of a viewer.

use std::cell::{Cell, RefCell};
use std::rc::Rc;
use wasm_bindgen::JsValue;

/// Functions of the page, and state that outlives a frame.
#[derive(Default)]
pub(super) struct Callbacks {
    pub(super) change: RefCell<Option<js_sys::Function>>,
    pub(super) lost: RefCell<Option<js_sys::Function>>,
    pub(super) is_lost: Cell<bool>,
    /// The scene's initial automatic exposure, as read back; 0 before.
    pub(super) key: Rc<Cell<f32>>,
}

impl Callbacks {
    /// A frame is wanted.
    pub(super) fn changed(&self) {
        let callback = self.change.borrow().clone();
        if let Some(callback) = callback {
            let _ = callback.call0(&JsValue::NULL);
        }
    }

    /// The device is lost.
    pub(super) fn lose(&self, message: &str) {
        let callback = self.lost.borrow().clone();
        if let Some(callback) = callback {
            let _ = callback.call1(&JsValue::NULL, &message.into());
        }
    }
}
