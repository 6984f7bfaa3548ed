//! Smoothed edges on the GPU against the CPU's, on the same picture.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;

use rebounce_shared::glam::Vec3;
use rebounce_shared::smooth::Pixels;
use rebounce_viewer::composite::{CompositePass, SMOOTH, Shading};
use rebounce_viewer::gpu::Gpu;
use rebounce_viewer::readback::Readback;
use rebounce_viewer::scope::Scope;
use wgpu::{TextureFormat, TextureUsages};

const SIZE: [u32; 2] = [64, 40];
/// Tolerance in steps of 255: one step of the dither, and rounding of the sampler's texel fractions.
const APART: f32 = 3.0;

/// Blocks, slanted edges and noise, in 64ths, which 16-bit floats hold.
fn picture() -> Vec<Vec3> {
    let pixel = |i: u32| {
        let (x, y) = ((i % SIZE[0]) as f32, (i / SIZE[0]) as f32);
        let kind = if x < 24.0 {
            (0.3 * x + 4.0 > y) as u32 as f32
        } else if x < 44.0 {
            ((y - 20.0).abs() < 0.8 * (x - 24.0)) as u32 as f32
        } else {
            (i.wrapping_mul(0x9e37_79b9) >> 20 & 3) as f32 / 4.0
        };
        (Vec3::new(0.1 + 0.7 * kind, 0.2 + 0.5 * kind, 0.9 - 0.6 * kind) * 64.0).round() / 64.0
    };
    (0..SIZE[0] * SIZE[1]).map(pixel).collect()
}

/// The bytes of a picture on a canvas.
fn presented(gpu: &Gpu, pixels: &[Vec3], flags: u32) -> Vec<u8> {
    let own = Scope::new(gpu);
    let texture = |format, usage| {
        own.texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: SIZE[0], height: SIZE[1], depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage,
            view_formats: &[],
        })
    };
    let from = texture(TextureFormat::Rgba16Float, TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST);
    let halves: Vec<u16> = pixels.iter().flat_map(|p| [p.x, p.y, p.z, 1.0].map(half)).collect();
    gpu.queue.write_texture(
        from.as_image_copy(),
        bytemuck::cast_slice(&halves),
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(8 * SIZE[0]), rows_per_image: None },
        from.size(),
    );
    let to = texture(TextureFormat::Rgba8Unorm, TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC);
    let lights =
        rebounce_viewer::shadow::ShadowPipelines::new(gpu, &rebounce_viewer::materials::material_layout(gpu));
    let pass = CompositePass::new(gpu, &lights.layout);
    let shading = rebounce_viewer::composite::shading(&own);
    let values = Shading { flags, enlarge: 1, ..Shading::default() };
    gpu.queue.write_buffer(&shading, 0, bytemuck::bytes_of(&values));
    let [from, view] = [&from, &to].map(|texture| texture.create_view(&Default::default()));
    let group = pass.present_group(gpu, &from, &shading);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    pass.present(gpu, &mut encoder, &group, &view, TextureFormat::Rgba8Unorm);
    gpu.queue.submit([encoder.finish()]);
    pollster::block_on(Readback::texture(gpu, &to, 4).wait()).unwrap()
}

/// A 16-bit float of a multiple of a 64th between 0 and 1.
fn half(value: f32) -> u16 {
    let bits = value.to_bits();
    if value == 0.0 { 0 } else { ((bits >> 13) - (112 << 10)) as u16 }
}

fn encoded(value: f32) -> f32 {
    255.0 * if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 }
}

/// Number of pixels that differ, and of pixels changed on the CPU.
fn compare(bytes: &[u8], shown: &[Vec3], pixels: &[Vec3]) -> [usize; 2] {
    let differs = |i: &usize| {
        let expected = shown[*i].to_array().map(encoded);
        (0..3).any(|c| (f32::from(bytes[4 * i + c]) - expected[c]).abs() > APART)
    };
    let count = shown.len();
    [(0..count).filter(differs).count(), (0..count).filter(|i| shown[*i].distance(pixels[*i]) > 0.02).count()]
}

#[test]
fn edges_are_smoothed_as_on_the_cpu_and_else_stay_as_they_are() {
    let Some(gpu) = common::gpu() else { return };
    let pixels = picture();
    let smoothed = Pixels { width: SIZE[0] as usize, pixels: &pixels }.all_smoothed();
    let [differ, changed] = compare(&presented(&gpu, &pixels, SMOOTH), &smoothed, &pixels);
    println!("{changed} pixels smoothed, {differ} of {} differ", pixels.len());
    // Rounding decides about a brightness at a threshold.
    assert!(changed > 300 && differ <= pixels.len() / 200, "{differ} differ, {changed} smoothed");
    assert_eq!(compare(&presented(&gpu, &pixels, 0), &pixels, &pixels), [0, 0]);
    gpu.check().unwrap();
}
