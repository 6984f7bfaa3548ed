//! Which image of a texture is taken, its bytes, and its sampler.

use super::source::Source;
use crate::scene::{SceneError, Texture};
use rebounce_shared::rbn::meta::{self, Wrap};

/// The image of a texture: PNG or JPEG where there is one, else WebP, else Basis Universal.
pub(super) fn image_index(source: &Source, texture: usize) -> Result<usize, SceneError> {
    let known = source.root.textures.get(texture);
    let known = known.ok_or_else(|| source.malformed(format!("there is no texture {texture}")))?;
    let others = [&known.extensions.webp, &known.extensions.basisu];
    let image = known.source.or_else(|| others.into_iter().flatten().find_map(|other| other.source));
    image.ok_or_else(|| SceneError::Texture {
        file: source.file.clone(),
        texture: texture.to_string(),
        problem: "it has no PNG, JPEG, WebP or KTX2 picture: export the scene with one of these".to_owned(),
    })
}

/// An image, decoded or only looked at.
pub(super) fn picture(source: &Source, index: usize, decoded: bool) -> Result<Texture, SceneError> {
    let image = source.root.images.get(index);
    let image = image.ok_or_else(|| source.malformed(format!("there is no image {index}")))?;
    let bytes = match (&image.uri, image.buffer_view) {
        (Some(uri), _) => source.uri(uri)?,
        (None, Some(view)) => source.view(view)?.0.to_vec(),
        (None, None) => return Err(source.malformed(format!("image {index} has no data"))),
    };
    let file_name = image.uri.as_deref().filter(|uri| !uri.starts_with("data:")).unwrap_or("");
    let name = [&image.name, file_name].into_iter().find(|n| !n.is_empty());
    let name = name.map_or_else(|| index.to_string(), str::to_owned);
    Texture::new(&source.file, meta::Texture { name, ..meta::Texture::default() }, bytes, decoded)
}

/// A texture: its picture with its sampler. The index has been checked.
pub(super) fn sampled(source: &Source, index: usize, data: bool, picture: &Texture) -> Texture {
    let texture = &source.root.textures[index];
    let sampler = texture.sampler.and_then(|s| source.root.samplers.get(s));
    let wrap = |code: Option<u32>| match code {
        Some(33071) => Wrap::ClampToEdge,
        Some(33648) => Wrap::MirroredRepeat,
        _ => Wrap::Repeat,
    };
    let mut out = picture.clone();
    if !texture.name.is_empty() {
        out.meta.name = texture.name.clone();
    }
    out.meta.wrap_u = wrap(sampler.and_then(|s| s.wrap_s));
    out.meta.wrap_v = wrap(sampler.and_then(|s| s.wrap_t));
    out.meta.data = data;
    out.meta.linear_filter = sampler.and_then(|s| s.mag_filter) != Some(9728);
    out
}
