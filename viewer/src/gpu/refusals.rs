//! Errors of a device, and error scopes.

/// An error of the device.
#[derive(Clone)]
pub struct Refusal {
    /// Out of memory.
    pub is_memory: bool,
    /// The device's message.
    pub message: String,
}

/// Returns the last refusal among `answers`. Out of memory comes last: a resource without memory causes later
/// errors, so memory is the cause.
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

    /// Reports errors outside of any watch.
    pub fn listen(device: &Device, note: impl Fn(Refusal) + Send + Sync + 'static) {
        device.on_uncaptured_error(Arc::new(move |error: Error| note(Refusal::of(&error))));
    }

    /// Records the device's errors, until [`end`].
    pub type Watch = Vec<wgpu::ErrorScopeGuard>;

    /// Begins a watch.
    pub fn begin(device: &Device) -> Watch {
        use ErrorFilter::{Internal, OutOfMemory, Validation};
        [OutOfMemory, Internal, Validation].map(|f| device.push_error_scope(f)).into()
    }

    /// Ends the watch; resolves to the recorded error.
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
    use crate::gpu::browser::{self, Device, Error, OutOfMemory, Uncaptured};
    use wasm_bindgen::prelude::*;

    impl Refusal {
        fn of(error: &Error) -> Self {
            Self { is_memory: error.has_type::<OutOfMemory>(), message: error.message() }
        }
    }

    /// Reports errors outside of any watch.
    pub fn listen(device: &wgpu::Device, note: impl Fn(Refusal) + 'static) {
        let told =
            Closure::<dyn Fn(Uncaptured)>::new(move |event: Uncaptured| note(Refusal::of(&event.error())));
        browser::device(device).set_onuncapturederror(told.into_js_value());
    }

    /// Records the device's errors, until [`end`].
    pub struct Watch(Device);

    /// Begins a watch.
    pub fn begin(device: &wgpu::Device) -> Watch {
        let device: &Device = browser::device(device);
        for filter in ["out-of-memory", "internal", "validation"] {
            device.push(filter);
        }
        Watch(device.clone())
    }

    /// Ends the watch; resolves to the recorded error.
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
