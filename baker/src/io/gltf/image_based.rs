//! EXT_lights_image_based: a cube map around the scene, as an equirectangular environment.
//!
//! The first level of its pictures counts, which is not blurred. A PNG with alpha is RGBD: linear radiance is the colour to
//! the power of 2.2, over alpha, as Babylon.js reads it. Other pictures are sRGB. A radiance of 1 counts as 1 nit.

use super::notes::Told;
use super::picture::{check_sizes, picture};
use super::source::Source;
use crate::scene::SceneError;
use crate::scene::texture::{Texels, linear};
use glam::{DQuat, Quat, Vec2, Vec3};
use rayon::prelude::*;
use rebounce_shared::elementary::ElementaryVector;
use rebounce_shared::environment::{Environment, direction_at};
use rebounce_shared::light::Light;
use serde::Deserialize;
use std::sync::Arc;

/// Name of the extension.
const NAME: &str = "EXT_lights_image_based";
/// Exponent of RGBD.
const GAMMA: f32 = 2.2;
/// Least alpha of RGBD: that of 8 bits.
const LEAST_ALPHA: f32 = 1.0 / 255.0;
/// Greatest width of a face, so that the environment is at most 4096 wide.
const MOST: u32 = 1024;
/// Samples along each side of a pixel.
const SAMPLES: u32 = 2;

#[derive(Debug, Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct ImageBasedLight {
    name: String,
    rotation: [f64; 4],
    intensity: f64,
    specular_images: Vec<Vec<usize>>,
}

impl Default for ImageBasedLight {
    fn default() -> Self {
        let rotation = [0.0, 0.0, 0.0, 1.0];
        Self { name: String::new(), rotation, intensity: 1.0, specular_images: Vec::new() }
    }
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct ImageBasedLights {
    lights: Vec<ImageBasedLight>,
}

#[derive(Debug, Deserialize)]
struct LightOfScene {
    light: usize,
}

/// The environment of a scene of the file.
pub(super) struct SceneEnvironment {
    pub light: Light,
    /// May be empty.
    pub name: String,
    pub environment: Arc<Environment>,
}

/// Returns the environment of a scene; `None` without. One that cannot be used is left out, with a message.
pub(super) fn of_scene(
    source: &Source,
    scene: usize,
    told: &mut Told,
) -> Result<Option<SceneEnvironment>, SceneError> {
    let what = format_args!("scene {scene}");
    let own: Option<LightOfScene> = source.read_extension(&source.root.scenes[scene], &[NAME], what)?;
    let Some(LightOfScene { light: index }) = own else { return Ok(None) };
    let lights: Option<ImageBasedLights> = source.read_extension(&source.root, &[NAME], "the file")?;
    let lights = lights.unwrap_or_default().lights;
    let light = lights.get(index);
    let light = light.ok_or_else(|| source.malformed(format!("there is no image-based light {index}")))?;
    match converted(source, light) {
        Ok(found) => Ok(Some(found)),
        Err(problem) => {
            told.left_out.push(format!("image-based light {index} ({:?}): {problem}", light.name));
            Ok(None)
        }
    }
}

fn converted(source: &Source, light: &ImageBasedLight) -> Result<SceneEnvironment, String> {
    let rotation = DQuat::from_array(light.rotation);
    if !(rotation.is_finite() && rotation.length_squared() > 0.0) {
        return Err("its rotation is no quaternion".to_owned());
    }
    if !(0.0..1e18).contains(&light.intensity) {
        return Err("its intensity is negative, not finite, or far too large".to_owned());
    }
    let faces = light.specular_images.first().and_then(|faces| <[usize; 6]>::try_from(faces.as_slice()).ok());
    let faces = faces.ok_or("it has no pictures of six sides of a cube")?;
    let images = faces.map(|face| (face, true, true));
    check_sizes(source, &images).map_err(|error| error.to_string())?;
    let read = |face: usize| -> Result<Face, String> {
        let texture = picture(source, face, true).map_err(|error| error.to_string())?;
        let texels = texture.texels.ok_or("a picture could not be decoded")?;
        Ok(Face::new(&texels))
    };
    let faces = faces.into_iter().map(read).collect::<Result<Vec<_>, _>>()?;
    let size = faces[0].size;
    if faces.iter().any(|face| face.size != size) || size == 0 {
        return Err("its pictures are not square, or not of one size".to_owned());
    }
    let light_of =
        Light::Environment { file: None, rotation_deg: 0.0, intensity: light.intensity, color: [1.0; 3] };
    let environment = Arc::new(equirectangular(&faces, rotation.normalize().as_quat().inverse()));
    Ok(SceneEnvironment { light: light_of, name: light.name.clone(), environment })
}

/// A side of the cube, linear RGB.
struct Face {
    /// Pixels along a side; 0 for a picture that is not square.
    size: u32,
    pixels: Vec<Vec3>,
}

impl Face {
    fn new(texels: &Texels) -> Self {
        let is_rgbd = texels.rgba.iter().any(|texel| texel[3] != 255);
        let decode = |texel: &[u8; 4]| {
            let [r, g, b, a] = texel.map(|byte| f32::from(byte) / 255.0);
            match is_rgbd {
                true => Vec3::new(r, g, b).power(GAMMA) / a.max(LEAST_ALPHA),
                false => linear(*texel),
            }
        };
        let size = if texels.width == texels.height { texels.width } else { 0 };
        Self { size, pixels: texels.rgba.iter().map(decode).collect() }
    }

    /// Bilinear, within the side.
    fn at(&self, place: Vec2) -> Vec3 {
        let last = self.size as f32 - 1.0;
        let place = (place * self.size as f32 - 0.5).clamp(Vec2::ZERO, Vec2::splat(last));
        let (low, part) = (place.floor(), place.fract());
        let pixel = |x: f32, y: f32| {
            let [x, y] = [x, y].map(|i| i.min(last) as usize);
            self.pixels[y * self.size as usize + x]
        };
        let row = |y: f32| pixel(low.x, y).lerp(pixel(low.x + 1.0, y), part.x);
        row(low.y).lerp(row(low.y + 1.0), part.y)
    }
}

/// The side of the cube in a direction, and the place on its picture, 0 to 1 from the left and from the top. The sides are
/// those of OpenGL, mirrored: as seen from within.
fn side(direction: Vec3) -> (usize, Vec2) {
    let Vec3 { x, y, z } = direction;
    let [ax, ay, az] = [x, y, z].map(f32::abs);
    let (face, across, down, along) = if ax >= ay && ax >= az {
        if x > 0.0 { (0, z, -y, ax) } else { (1, -z, -y, ax) }
    } else if ay >= az {
        if y > 0.0 { (2, -x, z, ay) } else { (3, -x, -z, ay) }
    } else if z > 0.0 {
        (4, -x, -y, az)
    } else {
        (5, x, -y, az)
    };
    (face, 0.5 * (Vec2::new(across, down) / along + 1.0))
}

/// The cube as an equirectangular picture; `cube_from_world` turns directions.
fn equirectangular(faces: &[Face], cube_from_world: Quat) -> Environment {
    let height = 2 * faces[0].size.min(MOST);
    let width = 2 * height;
    let pixel = |i: u32| {
        let (x, y) = (i % width, i / width);
        let mut sum = Vec3::ZERO;
        for k in 0..SAMPLES * SAMPLES {
            let within = |k: u32| (f64::from(k) + 0.5) / f64::from(SAMPLES);
            let u = (f64::from(x) + within(k % SAMPLES)) / f64::from(width);
            let v = (f64::from(y) + within(k / SAMPLES)) / f64::from(height);
            let (face, place) = side(cube_from_world * direction_at(u, v));
            sum += faces[face].at(place);
        }
        sum / (SAMPLES * SAMPLES) as f32
    };
    Environment { width, height, pixels: (0..width * height).into_par_iter().map(pixel).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_axis_has_its_side_and_pictures_are_as_seen_from_within() {
        let axes = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
        for (face, axis) in axes.into_iter().enumerate() {
            assert_eq!(side(axis), (face, Vec2::splat(0.5)));
        }
        // Seen along -z with y up, +x is on the right.
        let (face, place) = side(Vec3::new(0.5, 0.25, -1.0));
        assert!(face == 5 && place.x > 0.5 && place.y < 0.5, "{face} {place}");
        let (face, place) = side(Vec3::new(1.0, 0.25, 0.5));
        assert!(face == 0 && place.x > 0.5 && place.y < 0.5, "{face} {place}");
    }

    #[test]
    fn a_cube_of_six_colours_has_them_along_its_axes_turned() {
        let faces: Vec<Face> =
            (0..6).map(|i| Face { size: 4, pixels: vec![Vec3::splat(i as f32); 16] }).collect();
        let quarter = Quat::from_rotation_y(std::f32::consts::FRAC_PI_2);
        let turned = equirectangular(&faces, quarter.inverse());
        // A quarter about y takes the side +x to -z.
        assert_eq!(turned.radiance(Vec3::NEG_Z), Vec3::splat(0.0));
        assert_eq!(turned.radiance(Vec3::X), Vec3::splat(4.0));
        let mean = turned.energy() / (4.0 * std::f64::consts::PI);
        assert!((mean.x - 2.5).abs() < 0.02, "{mean}");
    }

    #[test]
    fn rgbd_goes_beyond_1_and_other_pictures_are_srgb() {
        let rgbd = Face::new(&Texels::new(1, 1, vec![[255, 128, 0, 51]]));
        assert!((rgbd.pixels[0] - Vec3::new(5.0, 5.0 * (128f32 / 255.0).powf(2.2), 0.0)).length() < 1e-4);
        let plain = Face::new(&Texels::new(1, 1, vec![[255, 128, 0, 255]]));
        assert!((plain.pixels[0] - Vec3::new(1.0, 0.2158, 0.0)).length() < 1e-3);
    }
}
