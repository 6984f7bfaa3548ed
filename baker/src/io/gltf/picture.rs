//! Image selection of a texture, image bytes, and sampler.

use super::source::Source;
use crate::scene::texture::{check_together, texels_said};
use crate::scene::{SceneError, Texture};
use gltf::json::Image;
use gltf::json::texture::{MagFilter, WrappingMode};
use gltf::json::validation::Checked;
use rebounce_shared::rbn::meta::{self, Wrap};
use serde::Deserialize;

/// Extensions for image formats besides PNG and JPEG.
const OTHERS: [&str; 2] = ["EXT_texture_webp", "KHR_texture_basisu"];
/// The `source` of a texture without PNG or JPEG, in the crate's document.
const NONE: usize = u32::MAX as usize;

#[derive(Default, Deserialize)]
#[serde(default)]
struct Other {
    source: Option<usize>,
}

/// Image of a texture: PNG or JPEG if present, else WebP, else Basis Universal.
pub(super) fn image_index(source: &Source, texture: usize) -> Result<usize, SceneError> {
    let known = source.root.textures.get(texture);
    let known = known.ok_or_else(|| source.malformed(format!("there is no texture {texture}")))?;
    let mut image = Some(known.source.value()).filter(|image| *image != NONE);
    for name in OTHERS {
        if image.is_none() {
            let other: Option<Other> =
                source.read_extension(known, &[name], format_args!("texture {texture}"))?;
            image = other.and_then(|other| other.source);
        }
    }
    image.ok_or_else(|| SceneError::Texture {
        file: source.file.clone(),
        texture: texture.to_string(),
        problem: "it has no PNG, JPEG, WebP or KTX2 picture: export the scene with one of these".to_owned(),
    })
}

/// Returns an image and the file bytes of the image.
fn image<'a>(source: &'a Source, index: usize) -> Result<(&'a Image, Vec<u8>), SceneError> {
    let image = source.root.images.get(index);
    let image = image.ok_or_else(|| source.malformed(format!("there is no image {index}")))?;
    let bytes = match (&image.uri, image.buffer_view) {
        (Some(uri), _) => source.uri(uri)?,
        (None, Some(view)) => source.view(view.value())?.0.to_vec(),
        (None, None) => return Err(source.malformed(format!("image {index} has no data"))),
    };
    Ok((image, bytes))
}

/// Refuses images, decoded or with only the header read, that need far more memory than the file size justifies.
pub(super) fn check_sizes(source: &Source, images: &[(usize, bool, bool)]) -> Result<(), SceneError> {
    let (mut texels, mut size) = (0u64, 0u64);
    for &(index, decoded, _) in images {
        // An unreadable image is reported on use.
        let Ok((_, bytes)) = image(source, index) else { continue };
        texels = texels.saturating_add(texels_said(&bytes, decoded));
        size += bytes.len() as u64;
    }
    check_together(texels, size).map_err(|problem| source.malformed(problem))
}

/// Reads an image; without `decoded`, only the header.
pub(super) fn picture(source: &Source, index: usize, decoded: bool) -> Result<Texture, SceneError> {
    let (image, bytes) = image(source, index)?;
    let file_name = image.uri.as_deref().filter(|uri| !uri.starts_with("data:")).unwrap_or("");
    let name = [image.name.as_deref().unwrap_or_default(), file_name].into_iter().find(|n| !n.is_empty());
    let name = name.map_or_else(|| index.to_string(), str::to_owned);
    Texture::new(&source.file, meta::Texture { name, ..meta::Texture::default() }, bytes, decoded)
}

/// Combines a texture's image and sampler. `index` is already checked.
pub(super) fn sampled(source: &Source, index: usize, data: bool, picture: &Texture) -> Texture {
    let texture = &source.root.textures[index];
    let sampler = texture.sampler.and_then(|s| source.root.samplers.get(s.value()));
    let wrap = |mode: Option<Checked<WrappingMode>>| match mode {
        Some(Checked::Valid(WrappingMode::ClampToEdge)) => Wrap::ClampToEdge,
        Some(Checked::Valid(WrappingMode::MirroredRepeat)) => Wrap::MirroredRepeat,
        _ => Wrap::Repeat,
    };
    let mut out = picture.clone();
    if let Some(name) = texture.name.as_ref().filter(|name| !name.is_empty()) {
        out.meta.name = name.clone();
    }
    out.meta.wrap_u = wrap(sampler.map(|s| s.wrap_s));
    out.meta.wrap_v = wrap(sampler.map(|s| s.wrap_t));
    out.meta.data = data;
    out.meta.linear_filter = sampler.and_then(|s| s.mag_filter) != Some(Checked::Valid(MagFilter::Nearest));
    out
}
