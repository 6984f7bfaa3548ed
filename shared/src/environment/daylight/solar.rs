//! Where the sun is, and what the air lets through of its light.

use super::super::sun::Sun;
use super::UNIT;
use crate::elementary::{Elementary, ElementaryVector};
use glam::{DVec3, Vec3};

/// Angular radius of the sun at its mean distance, degrees.
pub const RADIUS_DEG: f32 = 0.2665;
/// Illuminance of the sun above the air, lux.
const ABOVE_AIR: f32 = 133_100.0;
/// Tilt of the earth's axis, degrees.
const TILT_DEG: f64 = 23.44;

/// Direction towards the sun in world space: y is up, −z north, x east.
///
/// Latitude in degrees, north positive; day of the year, 1 to 365 (80 is the equinox in March); solar hour, 0 to 24, at
/// 12 the sun is highest. The declination is Cooper's (1969): 23.44° · sin(2π (284 + day) / 365), good to half a degree.
pub fn sun_direction(latitude_deg: f64, day_of_year: f64, solar_hour: f64) -> Vec3 {
    let declination = TILT_DEG.to_radians() * (std::f64::consts::TAU * (284.0 + day_of_year) / 365.0).sine();
    let (sin_hour, cos_hour) = (15.0 * (solar_hour - 12.0)).to_radians().sine_cosine();
    let (sin_place, cos_place) = latitude_deg.to_radians().sine_cosine();
    let (sin, cos) = declination.sine_cosine();
    let east = -cos * sin_hour;
    let north = sin * cos_place - cos * sin_place * cos_hour;
    let up = sin * sin_place + cos * cos_place * cos_hour;
    DVec3::new(east, up, -north).normalize().as_vec3()
}

/// The sun in a unit direction of world space, [`UNIT`]s; `None` if all of its disk is below the horizon. The disk counts
/// with the share of its height that is above.
pub fn sun(toward: Vec3, turbidity: f32) -> Option<Sun> {
    let elevation_deg = toward.y.clamp(-1.0, 1.0).arc_sine().to_degrees();
    let above = (0.5 + elevation_deg / (2.0 * RADIUS_DEG)).clamp(0.0, 1.0);
    let irradiance = transmittance(elevation_deg.max(0.0), turbidity) * (ABOVE_AIR / UNIT * above);
    (above > 0.0).then_some(Sun { direction: toward, irradiance, radius_deg: RADIUS_DEG })
}

/// Share of the sun's red, green and blue light that the air lets through: molecules, haze and ozone, Preetham et al.
/// 1999, *A Practical Analytic Model for Daylight*, appendix A.1.
pub fn transmittance(elevation_deg: f32, turbidity: f32) -> Vec3 {
    let depths = CHANNELS.map(|[wavelength, ozone]| {
        let haze = (0.046_08 * turbidity - 0.045_86).max(0.0) * wavelength.power(-1.3);
        0.008_735 * wavelength.power(-4.08) + haze + OZONE_CM * ozone
    });
    (-Vec3::from_array(depths) * air_mass(elevation_deg)).exponential()
}

/// Wavelength of red, green and blue, micrometres, and what ozone absorbs there, 1/cm. Wide channels weaken as these
/// wavelengths do.
const CHANNELS: [[f32; 2]; 3] = [[0.610, 0.120], [0.540, 0.075], [0.464, 0.0077]];
/// Ozone above a place, cm.
const OZONE_CM: f32 = 0.35;

/// How much air light passes through from an elevation of 0° to 90°, in vertical thicknesses (Kasten and Young 1989).
pub fn air_mass(elevation_deg: f32) -> f32 {
    1.0 / (elevation_deg.to_radians().sine() + 0.505_72 * (elevation_deg + 6.079_95).power(-1.6364))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::luminance;

    #[test]
    fn the_sun_stands_where_the_page_has_it() {
        // Negative directions of daylight.ts: sun({ latitude, day, hour }).
        let cases = [
            (48.0, 80.0, 9.00, [0.70709, 0.46790, 0.53018]),
            (48.0, 172.0, 12.00, [0.0, 0.90952, 0.41565]),
            (-33.9, 355.0, 16.50, [-0.84764, 0.51328, 0.13434]),
            (70.0, 172.0, 0.00, [0.0, 0.06000, -0.99820]),
            (0.0, 266.0, 6.25, [0.99770, 0.06539, 0.01760]),
            (37.0, 20.0, 18.00, [-0.93769, -0.20912, 0.27751]),
        ];
        for (latitude, day, hour, expected) in cases {
            let apart = sun_direction(latitude, day, hour).angle_between(Vec3::from_array(expected));
            assert!(apart.to_degrees() < 0.1, "{latitude} {day} {hour}: {apart}");
        }
    }

    #[test]
    fn the_sun_rises_in_the_east_and_is_south_at_noon() {
        assert!(sun_direction(48.0, 80.5, 6.0).distance(Vec3::X) < 0.01);
        let noon = sun_direction(48.0, 172.0, 12.0);
        assert!(noon.z > 0.0 && noon.x.abs() < 1e-6);
        assert!((noon.y.asin().to_degrees() - (90.0 - 48.0 + 23.44)).abs() < 0.1);
    }

    #[test]
    fn clear_air_lets_through_what_it_does_on_the_page() {
        for elevation in [0.5, 5.0, 20.0, 45.0, 90.0] {
            let page = [0.195, 0.237, 0.328].map(|depth: f32| (-depth * air_mass(elevation)).exp());
            let (ours, page) = (transmittance(elevation, 2.0), Vec3::from_array(page));
            let depths = ours.map(f32::ln) / page.map(f32::ln);
            assert!((depths - 1.0).abs().max_element() < 0.01, "{elevation}: {depths}");
        }
        let noon = sun(Vec3::Y, 2.0).unwrap();
        assert!((95.0..110.0).contains(&luminance(noon.irradiance)));
    }

    #[test]
    fn the_sun_reddens_fades_and_sets() {
        let at = |elevation: f32, turbidity| {
            let (sin, cos) = elevation.to_radians().sin_cos();
            sun(Vec3::new(cos, sin, 0.0), turbidity)
        };
        let mut before = at(90.0, 3.0).unwrap();
        for step in 1..=900 {
            let sun = at(90.0 - 0.1 * step as f32, 3.0).unwrap();
            assert!(sun.irradiance.cmple(before.irradiance).all());
            assert!(
                sun.irradiance.z / sun.irradiance.x <= 1.0001 * before.irradiance.z / before.irradiance.x
            );
            before = sun;
        }
        assert!(luminance(at(-0.26, 3.0).unwrap().irradiance) < 0.05 * luminance(before.irradiance));
        assert!(at(-0.27, 3.0).is_none() && at(-30.0, 3.0).is_none());
        assert!(luminance(at(30.0, 8.0).unwrap().irradiance) < luminance(at(30.0, 2.0).unwrap().irradiance));
    }
}
