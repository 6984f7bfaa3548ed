//! Daylight: the sky and the sun of a clear day, at a place and an hour.
//!
//! * [`hosek_wilkie`] – radiance of the clear sky (Hosek and Wilkie 2012);
//! * [`solar`] – where the sun is, and what the air lets through of it (Preetham et al. 1999);
//! * [`twilight`] – how bright the sky is when the sun is below the horizon (Janiczek and DeYoung 1987).
//!
//! The unit is thousands of candela: a radiance of 1 W/(sr m²) stands for 1,000 cd/m², an irradiance of 1 W/m² for 1,000
//! lux. Radiance has no photometric conversion elsewhere (1 cd counts as 1 W/sr), so candela themselves would do; but
//! photographed environments, lamps of rooms and emissive materials are around 1, a clear sky is 2,000 to 10,000 cd/m²
//! and the sun at noon 100,000 lux. In thousands, sky and sun are of the order of 1 and 100, as in photographs, and
//! within what rgb9e5 holds. The page's sun (`daylight.ts`) has the same with a scale of 0.001.

pub mod hosek_wilkie;
pub mod solar;
pub mod twilight;

use super::picture::Environment;
use super::sun::Sun;
use crate::elementary::Elementary;
use glam::Vec3;
use hosek_wilkie::SkyModel;
pub use solar::sun_direction;

/// Candela per square metre that a radiance of 1 W/(sr m²) stands for; lux that an irradiance of 1 W/m² stands for.
pub const UNIT: f32 = 1000.0;
/// Pixels in a row of a sky.
const WIDTH: u32 = 256;
/// Rows of a sky; the horizon is between the middle two.
const HEIGHT: u32 = 128;
/// Range of the turbidity.
pub const TURBIDITY: [f32; 2] = [1.0, 10.0];

/// The sky of a clear day, 256 by 128 pixels, and its sun; environment space is world space.
///
/// `sun_direction` points towards the sun, of any length. `turbidity` is how hazy the air is: 2 is very clear (the page's
/// sun), 3 clear, 6 hazy, 10 very hazy; it is taken into 1 to 10. `ground_albedo`, taken into 0 to 1, lights the sky from
/// below and is the colour of the lower half: albedo · irradiance / π.
///
/// With the sun below the horizon the sky keeps the form that it has at sunset, and fades continuously with the
/// illuminance of twilight down to that of a moonless night, 0.00065 lux, at 18°. The sun's disk sets within its width of
/// 0.53°; below there is no sun.
pub fn sky(sun_direction: Vec3, turbidity: f32, ground_albedo: Vec3) -> (Environment, Option<Sun>) {
    let turbidity = turbidity.clamp(TURBIDITY[0], TURBIDITY[1]);
    let albedo = ground_albedo.clamp(Vec3::ZERO, Vec3::ONE);
    let toward = sun_direction.try_normalize().unwrap_or(Vec3::Y);
    let elevation_deg = toward.y.clamp(-1.0, 1.0).arc_sine().to_degrees();
    let model = SkyModel::new(elevation_deg, turbidity, albedo);
    let brightness = twilight::share(elevation_deg);
    let sun = solar::sun(toward, turbidity);

    let mut picture = Environment { width: WIDTH, height: HEIGHT, pixels: Vec::new() };
    for y in 0..HEIGHT / 2 {
        for x in 0..WIDTH {
            let view = picture.direction(x, y);
            picture.pixels.push(model.radiance(view, toward) * brightness);
        }
    }
    picture.pixels.resize(WIDTH as usize * HEIGHT as usize, Vec3::ZERO);
    let from_sun = sun.map_or(Vec3::ZERO, |sun| sun.irradiance * toward.y.max(0.0));
    let ground = albedo * (picture.irradiance(Vec3::Y) + from_sun) / std::f32::consts::PI;
    picture.pixels[(WIDTH * HEIGHT / 2) as usize..].fill(ground);
    (picture, sun)
}

#[cfg(test)]
mod tests;
