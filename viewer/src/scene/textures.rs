//! Textures: decoded, uploaded as sRGB colours or as linear data, with mip levels.
//!
//! In the browser `createImageBitmap` decodes, with no premultiplication and no colour conversion; natively the
//! `image` crate.

use crate::error::ViewerError;
use crate::gpu::bindings::{Draw, Slot, attachment, bilinear, group, layout, opaque, view};
use crate::gpu::scope::Scope;
use crate::gpu::{Gpu, LIMITS};
use crate::shaders;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::rbn::meta::Texture;

/// Formats of colours and of linear data.
const FORMATS: [wgpu::TextureFormat; 2] =
    [wgpu::TextureFormat::Rgba8UnormSrgb, wgpu::TextureFormat::Rgba8Unorm];
/// Number of textures decoded at a time.
const BATCH: usize = 8;

/// Generates mip levels.
pub struct Mips {
    layout: wgpu::BindGroupLayout,
    /// Pipelines by format, as in [`FORMATS`].
    pipelines: [wgpu::RenderPipeline; 2],
    sampler: wgpu::Sampler,
}

impl Mips {
    /// Creates the pipelines.
    pub fn new(gpu: &Gpu) -> Self {
        let layout = layout(gpu, "mips", wgpu::ShaderStages::FRAGMENT, &[Slot::Texture, Slot::Sampler]);
        let pipelines = FORMATS.map(|format| {
            Draw {
                label: "mips",
                source: shaders::MIPS,
                vertex: "fullscreen",
                targets: &[opaque(format)],
                layouts: &[&layout],
                ..Default::default()
            }
            .pipeline(gpu)
        });
        let sampler = bilinear(gpu);
        Self { layout, pipelines, sampler }
    }

    /// Fills all mip levels except the first.
    fn fill(&self, gpu: &Gpu, texture: &wgpu::Texture) {
        let level = |base_mip_level| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                base_mip_level,
                mip_level_count: Some(1),
                ..Default::default()
            })
        };
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        for i in 1..texture.mip_level_count() {
            let larger = level(i - 1);
            let group = group(
                gpu,
                "mips",
                &self.layout,
                &[view(&larger), wgpu::BindingResource::Sampler(&self.sampler)],
            );
            let smaller = level(i);
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                color_attachments: &[attachment(&smaller, true)],
                ..Default::default()
            });
            pass.set_pipeline(&self.pipelines[(texture.format() == FORMATS[1]) as usize]);
            pass.set_bind_group(0, &group, &[]);
            pass.draw(0..3, 0..1);
        }
        gpu.queue.submit([encoder.finish()]);
    }
}

/// Loads all textures of the scene, by index. Textures of the same image in the file share a GPU texture.
///
/// # Errors
/// [`ViewerError::Texture`] for the first texture that cannot be decoded.
pub async fn load(
    scope: &Scope,
    mips: &Mips,
    scene: &BakedScene,
) -> Result<Vec<wgpu::TextureView>, ViewerError> {
    let limit = LIMITS.max_texture_dimension_2d;
    let (firsts, shared) = distinct(&scene.meta.textures);
    let mut views = Vec::with_capacity(firsts.len());
    for batch in firsts.chunks(BATCH) {
        let decoding: Vec<_> = batch.iter().map(|&i| decode::begin(scene, i)).collect();
        for (&i, decoding) in batch.iter().zip(decoding) {
            let data = scene.meta.textures[i].data;
            let texture = decode::finish(scope, decoding, data, limit).await.map_err(|problem| {
                let name = &scene.meta.textures[i].name;
                let name = if name.is_empty() { i.to_string() } else { name.clone() };
                ViewerError::Texture { name, problem }
            })?;
            scope.watch(|| mips.fill(scope, &texture));
            views.push(texture.create_view(&Default::default()));
        }
    }
    Ok(shared.into_iter().map(|k| views[k].clone()).collect())
}

/// Returns the first texture of every distinct image, and for each texture the index of its image in this list.
fn distinct(textures: &[Texture]) -> (Vec<usize>, Vec<usize>) {
    let mut firsts: Vec<usize> = Vec::new();
    let mut shared = Vec::with_capacity(textures.len());
    for (i, texture) in textures.iter().enumerate() {
        let picture = |t: &Texture| (t.offset, t.len, t.data);
        let same = firsts.iter().position(|&first| picture(&textures[first]) == picture(texture));
        shared.push(same.unwrap_or_else(|| {
            firsts.push(i);
            firsts.len() - 1
        }));
    }
    (firsts, shared)
}

/// A white texture of one pixel.
pub fn white(scope: &Scope) -> wgpu::TextureView {
    let texture = create(scope, 1, 1, false);
    write(scope, &texture, &[255; 4]);
    texture.create_view(&Default::default())
}

fn create(scope: &Scope, width: u32, height: u32, data: bool) -> wgpu::Texture {
    let descriptor = wgpu::TextureDescriptor {
        label: Some("texture"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: width.max(height).ilog2() + 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: FORMATS[data as usize],
        usage: wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_DST
            | wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    };
    scope.watch(|| scope.texture(&descriptor))
}

fn write(gpu: &Gpu, texture: &wgpu::Texture, rgba: &[u8]) {
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(4 * texture.width()),
        rows_per_image: None,
    };
    let size = wgpu::Extent3d { depth_or_array_layers: 1, ..texture.size() };
    gpu.queue.write_texture(texture.as_image_copy(), rgba, layout, size);
}

#[cfg(not(target_arch = "wasm32"))]
mod decode {
    use super::{BakedScene, Scope, create, write};

    pub fn begin(scene: &BakedScene, i: usize) -> Result<image::DynamicImage, String> {
        image::load_from_memory(scene.texture(i)).map_err(|e| e.to_string())
    }

    pub async fn finish(
        scope: &Scope,
        picture: Result<image::DynamicImage, String>,
        data: bool,
        limit: u32,
    ) -> Result<wgpu::Texture, String> {
        let picture = picture?;
        let picture = if picture.width().max(picture.height()) > limit {
            picture.resize(limit, limit, image::imageops::FilterType::Triangle)
        } else {
            picture
        };
        let picture = picture.to_rgba8();
        let texture = create(scope, picture.width(), picture.height(), data);
        write(scope, &texture, picture.as_raw());
        Ok(texture)
    }
}

#[cfg(target_arch = "wasm32")]
mod decode {
    use super::{BakedScene, Scope, create};
    use js_sys::{Function, Object, Promise, Reflect};
    use wasm_bindgen::{JsCast, JsValue};
    use wasm_bindgen_futures::JsFuture;
    use web_sys::ImageBitmap;

    fn words(error: JsValue) -> String {
        error.dyn_ref::<js_sys::Error>().map_or_else(|| "unknown".into(), |e| String::from(e.message()))
    }

    /// Decodes a blob, or scales an image down: the named `side` becomes this long.
    fn decode(source: &JsValue, side: Option<(&str, u32)>) -> Result<Promise, JsValue> {
        let options = Object::new();
        let set = |name: &str, value: &JsValue| Reflect::set(&options, &name.into(), value).map(|_| ());
        set("premultiplyAlpha", &"none".into())?;
        set("colorSpaceConversion", &"none".into())?;
        if let Some((side, length)) = side {
            set(side, &length.into())?;
        }
        let function = Reflect::get(&js_sys::global(), &"createImageBitmap".into())?;
        let function: Function = function.dyn_into()?;
        function.call2(&JsValue::UNDEFINED, source, &options)?.dyn_into::<Promise>()
    }

    async fn bitmap(promise: Promise) -> Result<ImageBitmap, JsValue> {
        JsFuture::from(promise).await?.dyn_into()
    }

    pub fn begin(scene: &BakedScene, i: usize) -> Result<Promise, String> {
        let start = || {
            let parts = js_sys::Array::of1(&js_sys::Uint8Array::from(scene.texture(i)));
            let bag = web_sys::BlobPropertyBag::new();
            bag.set_type(&scene.meta.textures[i].mime);
            decode(&web_sys::Blob::new_with_u8_array_sequence_and_options(&parts, &bag)?.into(), None)
        };
        start().map_err(words)
    }

    pub async fn finish(
        scope: &Scope,
        promise: Result<Promise, String>,
        data: bool,
        limit: u32,
    ) -> Result<wgpu::Texture, String> {
        let mut bitmap = bitmap(promise?).await.map_err(words)?;
        // The decoded size, not the size in the file's metadata.
        let (width, height) = (bitmap.width(), bitmap.height());
        if width.max(height) > limit {
            let side = if width >= height { "resizeWidth" } else { "resizeHeight" };
            let large = bitmap;
            bitmap =
                self::bitmap(decode(&large, Some((side, limit))).map_err(words)?).await.map_err(words)?;
            large.close();
        }
        let texture = create(scope, bitmap.width(), bitmap.height(), data);
        scope.queue.copy_external_image_to_texture(
            &wgpu::CopyExternalImageSourceInfo {
                source: wgpu::ExternalImageSource::ImageBitmap(bitmap.clone()),
                origin: wgpu::Origin2d::ZERO,
                flip_y: false,
            },
            wgpu::CopyExternalImageDestInfo {
                texture: &texture,
                mip_level: 0,
                origin: wgpu::Origin3d::ZERO,
                aspect: wgpu::TextureAspect::All,
                color_space: wgpu::PredefinedColorSpace::Srgb,
                premultiplied_alpha: false,
            },
            wgpu::Extent3d { width: bitmap.width(), height: bitmap.height(), depth_or_array_layers: 1 },
        );
        bitmap.close();
        Ok(texture)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn textures_of_one_picture_share_it() {
        let texture = |offset, len| Texture { offset, len, ..Texture::default() };
        let numbers = Texture { data: true, ..texture(9, 4) };
        let (firsts, shared) =
            distinct(&[texture(0, 9), texture(9, 4), texture(0, 9), texture(0, 5), texture(9, 4), numbers]);
        assert_eq!(firsts, [0, 1, 3, 5]);
        assert_eq!(shared, [0, 1, 0, 2, 1, 3]);
    }
}
