//! What a device refuses, and how that is heard.

/// What the device has refused.
#[derive(Clone)]
pub struct Refusal {
    /// For want of memory.
    pub is_memory: bool,
    /// The device's words.
    pub message: String,
}

/// The first of these answers that is a refusal, last ones first: whatever uses what there was no memory for is
/// refused, too, so memory, which is asked for last, is the cause.
async fn cause(answers: impl IntoIterator<Item: Future<Output = Option<Refusal>>>) -> Option<Refusal> {
    let mut cause = None;
    for answer in answers {
        cause = answer.await.or(cause);
    }
    cause
}

#[cfg(not(target_arch = "wasm32"))]
mod native {
    use super::{Refusal, cause};
    use std::sync::Arc;
    use wgpu::{Device, Error, ErrorFilter};

    impl Refusal {
        fn of(error: &Error) -> Self {
            Self { is_memory: matches!(error, Error::OutOfMemory { .. }), message: error.to_string() }
        }
    }

    /// Tells of what nobody watches.
    pub fn listen(device: &Device, note: impl Fn(Refusal) + Send + Sync + 'static) {
        device.on_uncaptured_error(Arc::new(move |error: Error| note(Refusal::of(&error))));
    }

    /// Hears what the device refuses, until [`end`].
    pub type Watch = Vec<wgpu::ErrorScopeGuard>;

    /// Begins to listen.
    pub fn begin(device: &Device) -> Watch {
        use ErrorFilter::{Internal, OutOfMemory, Validation};
        [OutOfMemory, Internal, Validation].map(|f| device.push_error_scope(f)).into()
    }

    /// What was refused since then.
    pub fn end(mut watch: Watch) -> impl Future<Output = Option<Refusal>> {
        let mut answers = Vec::new();
        while let Some(scope) = watch.pop() {
            answers.push(scope.pop());
        }
        cause(answers.into_iter().map(|answer| async { Some(Refusal::of(&answer.await?)) }))
    }
}
#[cfg(not(target_arch = "wasm32"))]
pub use native::{begin, end, listen};

#[cfg(target_arch = "wasm32")]
mod web {
    use super::{Refusal, cause};
    use crate::browser::{self, Device, Error, OutOfMemory, Uncaptured};
    use wasm_bindgen::prelude::*;

    impl Refusal {
        fn of(error: &Error) -> Self {
            Self { is_memory: error.has_type::<OutOfMemory>(), message: error.message() }
        }
    }

    /// Tells of what nobody watches.
    pub fn listen(device: &wgpu::Device, note: impl Fn(Refusal) + 'static) {
        let told =
            Closure::<dyn Fn(Uncaptured)>::new(move |event: Uncaptured| note(Refusal::of(&event.error())));
        browser::device(device).set_onuncapturederror(told.into_js_value());
    }

    /// Hears what the device refuses, until [`end`].
    pub struct Watch(Device);

    /// Begins to listen.
    pub fn begin(device: &wgpu::Device) -> Watch {
        let device: &Device = browser::device(device);
        for filter in ["out-of-memory", "internal", "validation"] {
            device.push(filter);
        }
        Watch(device.clone())
    }

    /// What was refused since then.
    pub fn end(Watch(device): Watch) -> impl Future<Output = Option<Refusal>> {
        let answers = [(); 3].map(|()| device.pop());
        cause(answers.map(|answer| async {
            let error = answer.await.ok().filter(JsValue::is_truthy)?;
            Some(Refusal::of(error.unchecked_ref()))
        }))
    }
}
#[cfg(target_arch = "wasm32")]
pub use web::{begin, end, listen};
