//! The camera uniform of the shaders: `Frame` in frame.wgsl.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec4};
use rebounce_shared::camera::{Camera, CameraFrame};

/// A picture's camera, in scene-local space. 160 bytes.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Frame {
    /// Projection times view: reversed depth, near plane at 1, infinity at 0.
    pub clip_from_local: [[f32; 4]; 4],
    /// Eye.
    pub eye: [f32; 3],
    /// Distance of the near plane.
    pub near: f32,
    /// To the picture's right edge, at distance 1.
    pub right: [f32; 3],
    /// Width, pixels.
    pub width: f32,
    /// To the picture's top edge, at distance 1.
    pub up: [f32; 3],
    /// Height, pixels.
    pub height: f32,
    /// Into the picture, unit length.
    pub forward: [f32; 3],
    /// 1 to read textures without mip levels.
    pub unfiltered: u32,
    /// Reach of a pixel's openness, scene units; 0 without detail.
    pub open_reach: f32,
    /// Unused.
    pub pad: [u32; 3],
}

/// Upper limit of the tangent of half the vertical field of view in portrait pictures: 100 degrees.
const WIDEST: f32 = 1.19;

/// The frame of a camera, local space, for a picture of this size, pixels. In a portrait picture the camera's field
/// of view is horizontal: a view composed for a screen keeps its central square on a phone.
#[inline(never)]
pub fn frame(camera: &Camera, origin: [f64; 3], [width, height]: [u32; 2]) -> CameraFrame {
    let mut frame = camera.frame(origin);
    let tan = frame.tan_half_yfov;
    frame.tan_half_yfov = (tan * height as f32 / width as f32).min(WIDEST).max(tan);
    frame
}

impl Frame {
    /// The frame for a picture of this size.
    pub fn new(camera: &CameraFrame, near: f32, size: [u32; 2], sample: Sample) -> Self {
        let (width, height) = (size[0] as f32, size[1] as f32);
        let (right, up) =
            (camera.right * (camera.tan_half_yfov * width / height), camera.up * camera.tan_half_yfov);
        // The ray through the middle of the shifted picture.
        let forward =
            camera.forward + right * (2.0 * sample.shift[0] / width) - up * (2.0 * sample.shift[1] / height);
        // With d = position - eye: w = d·axis, x = d·right / |right|², y likewise, minus the shift times w.
        let x = right / right.length_squared() - camera.forward * (2.0 * sample.shift[0] / width);
        let y = up / up.length_squared() + camera.forward * (2.0 * sample.shift[1] / height);
        let plane = |v: glam::Vec3| v.extend(-v.dot(camera.eye));
        let rows = Mat4::from_cols(plane(x), plane(y), Vec4::new(0.0, 0.0, 0.0, near), plane(camera.forward));
        Self {
            clip_from_local: rows.transpose().to_cols_array_2d(),
            eye: camera.eye.to_array(),
            near,
            right: right.to_array(),
            width,
            up: up.to_array(),
            height,
            forward: forward.to_array(),
            unfiltered: sample.unfiltered as u32,
            open_reach: 0.0,
            pad: [0; 3],
        }
    }
}

/// A picture of an averaged series.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Shift of the picture, pixels, right and down.
    pub shift: [f32; 2],
    /// Whether textures are read without mip levels, as on the CPU: for averages of many pictures.
    pub unfiltered: bool,
}

impl Sample {
    /// Picture `index` of an infinite series: the first at the pixels' centres, the others evenly spread around
    /// (Halton, bases 2 and 3).
    pub fn of(index: u32) -> Self {
        let shift = match index {
            0 => [0.0; 2],
            _ => [radical_inverse(index, 2) - 0.5, radical_inverse(index, 3) - 0.5],
        };
        Self { shift, unfiltered: false }
    }

    /// Picture `index` of `count`, a power of two: no two samples in the same row or column of the pixel, so that
    /// edges of any direction are averaged well (Hammersley). Textures are not filtered: averaging filters them.
    pub fn of_count(index: u32, count: u32) -> Self {
        let middle = 0.5 / count as f32 - 0.5;
        let shift = [index as f32 / count as f32 + middle, radical_inverse(index, 2) + middle];
        Self { shift, unfiltered: true }
    }
}

/// The digits of `index` in this base, mirrored at the point: in 0..1.
fn radical_inverse(mut index: u32, base: u32) -> f32 {
    let (mut digit, mut sum) = (1.0 / base as f32, 0.0);
    while index > 0 {
        sum += (index % base) as f32 * digit;
        index /= base;
        digit /= base as f32;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use rebounce_shared::camera::Camera;

    #[test]
    fn high_pictures_are_as_wide_as_the_view_is_high() {
        let camera =
            Camera { position: [0.0; 3], target: [0.0, 0.0, -1.0], up: [0.0, 1.0, 0.0], yfov_deg: 50.0 };
        let tan = |size| frame(&camera, [0.0; 3], size).tan_half_yfov;
        for size in [[1280, 720], [300, 300]] {
            assert_eq!(tan(size), camera.frame([0.0; 3]).tan_half_yfov);
        }
        assert!((tan([400, 800]) * 0.5 - tan([400, 400])).abs() < 1e-6);
        // A smaller angle where the perspective would be extreme, and never narrower than requested.
        assert_eq!(tan([100, 1000]), WIDEST);
        let wide = Camera { yfov_deg: 120.0, ..camera.clone() };
        assert_eq!(frame(&wide, [0.0; 3], [390, 844]).tan_half_yfov, wide.frame([0.0; 3]).tan_half_yfov);
    }

    #[test]
    fn projection_and_reconstruction_are_inverse() {
        let camera = Camera {
            position: [1.0, 2.0, 3.0],
            target: [4.0, 1.0, -2.0],
            up: [0.0, 1.0, 0.1],
            yfov_deg: 50.0,
        };
        let size = [320, 180];
        let frame = camera.frame([0.5, 0.0, 0.0]);
        for shift in [[0.0, 0.0], [0.3, -0.4]] {
            let f = Frame::new(&frame, 0.01, size, Sample { shift, ..Sample::default() });
            for (x, y) in [(0.5, 0.5), (160.0, 90.0), (319.5, 3.5)] {
                let p = frame.eye + 7.0 * frame.direction(x + shift[0], y + shift[1], size[0], size[1]);
                let clip = Mat4::from_cols_array_2d(&f.clip_from_local) * p.extend(1.0);
                let ndc = clip / clip.w;
                let pixel = ((ndc.x + 1.0) * 160.0, (1.0 - ndc.y) * 90.0);
                assert!((pixel.0 - x).abs() < 1e-2 && (pixel.1 - y).abs() < 1e-2, "{pixel:?}, not {x} {y}");
                let (nx, ny) = (x * 2.0 / f.width - 1.0, 1.0 - y * 2.0 / f.height);
                let ray = Vec3::from(f.forward) + nx * Vec3::from(f.right) + ny * Vec3::from(f.up);
                let back = Vec3::from(f.eye) + ray * (f.near / ndc.z);
                assert!(back.distance(p) < 1e-4, "{back} {p}");
            }
        }
    }
}
