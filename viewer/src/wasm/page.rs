//! Conversions for the page: errors with a code, promises, objects.

use crate::error::ViewerError;
use rebounce_shared::rbn::meta;
use std::future::Future;
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::future_to_promise;

/// A viewer error as a JavaScript error.
pub fn js_error(error: &ViewerError) -> JsValue {
    coded(error.code(), &error.to_string())
}

/// A JavaScript `Error` with a code.
pub fn coded(code: &str, message: &str) -> JsValue {
    let error = js_sys::Error::new(message);
    let _ = js_sys::Reflect::set(&error, &"code".into(), &code.into());
    error.into()
}

/// A promise of the result of `work`.
pub fn promise<T: Into<JsValue>>(
    work: impl Future<Output = Result<T, ViewerError>> + 'static,
) -> js_sys::Promise {
    future_to_promise(async move { work.await.map(Into::into).map_err(|e| js_error(&e)) })
}

/// An object of the page.
pub fn object<const N: usize>(members: [(&str, JsValue); N]) -> JsValue {
    let object = js_sys::Object::new();
    for (name, value) in members {
        let _ = js_sys::Reflect::set(&object, &name.into(), &value);
    }
    object.into()
}

/// A track of an animation: of a `light` by its number, or a `node` by its name.
pub fn track(
    target: (&str, JsValue),
    property: &str,
    interpolation: meta::Interpolation,
    [times, values]: [&[f32]; 2],
) -> JsValue {
    object([
        target,
        ("property", property.into()),
        ("interpolation", interpolation.name().into()),
        ("times", js_sys::Float32Array::from(times).into()),
        ("values", js_sys::Float32Array::from(values).into()),
    ])
}

/// The tracks of an animation of lights.
pub fn tracks(animation: &meta::Animation) -> js_sys::Array {
    let of_light = |t: &meta::Track| {
        track(("light", t.light.into()), t.property.name(), t.interpolation, [&t.times, &t.values])
    };
    animation.tracks.iter().map(of_light).collect()
}

/// `{ name, duration, tracks }`.
pub fn animation(name: &str, duration: f32, tracks: js_sys::Array) -> JsValue {
    object([("name", name.into()), ("duration", duration.into()), ("tracks", tracks.into())])
}
