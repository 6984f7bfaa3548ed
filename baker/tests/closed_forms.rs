//! The path tracer against analytic results. Furnaces are in the path tracer's own tests.

use glam::Vec3;
use rebounce::geometry::{Gloss, Hit, Ray, Surfaces};
use rebounce::io::picture::Only;
use rebounce::light::illumination::Illumination;
use rebounce::random::Stream;
use rebounce::verify::path_trace::{Settings, radiance};
use rebounce_shared::light::Light;
use std::f32::consts::PI;

/// One-sided squares perpendicular to y, each facing up or down.
struct Squares(Vec<Square>);

#[derive(Clone)]
struct Square {
    /// Height of the plane.
    y: f32,
    /// Half the edge; the centre is at x = z = 0.
    half: f32,
    /// 1 faces up, −1 down.
    facing: f32,
    albedo: f32,
}

impl Surfaces for Squares {
    fn cast(&self, ray: &Ray, _seed: u32) -> Option<Hit> {
        let meet = |square: &Square| {
            let distance = (square.y - ray.origin.y) / ray.direction.y;
            let position = ray.origin + ray.direction * distance;
            let inside = position.x.abs() <= square.half && position.z.abs() <= square.half;
            (inside && distance > 0.0 && distance < ray.max_distance).then(|| {
                let front = Vec3::Y * square.facing;
                let faces = front.dot(ray.direction) < 0.0;
                Hit {
                    distance,
                    position,
                    geometric_normal: if faces { front } else { -front },
                    normal: front,
                    albedo: if faces { Vec3::splat(square.albedo) } else { Vec3::ZERO },
                    emission: Vec3::ZERO,
                    emitter: None,
                    is_unlit: false,
                    group: 0,
                    lightmap: None,
                    gloss: Gloss::MATT,
                }
            })
        };
        self.0.iter().filter_map(meet).min_by(|a, b| a.distance.total_cmp(&b.distance))
    }

    fn see(&self, ray: &Ray, seed: u32) -> Option<Hit> {
        let fronts = self.0.iter().filter(|square| square.facing * ray.direction.y < 0.0);
        Self(fronts.cloned().collect()).cast(ray, seed)
    }

    fn transmittance(&self, from: Vec3, to: Vec3) -> Vec3 {
        let way = to - from;
        let ray = Ray {
            origin: from,
            direction: way.normalize(),
            max_distance: way.length() * 0.9999,
            spread: 0.0,
        };
        if self.cast(&ray, 0).is_some() { Vec3::ZERO } else { Vec3::ONE }
    }

    fn bounds(&self) -> (Vec3, Vec3) {
        (Vec3::splat(-2.0), Vec3::splat(2.0))
    }

    fn epsilon(&self) -> f32 {
        1e-5
    }
}

/// Radiance straight up from the place (x, z) of the square at y = 0.
fn upwards(
    squares: &Squares,
    light: &Light,
    [x, z]: [f32; 2],
    settings: Settings,
    stream: &mut Stream,
) -> f32 {
    let ray =
        Ray { origin: Vec3::new(x, 0.5, z), direction: -Vec3::Y, max_distance: f32::INFINITY, spread: 0.0 };
    let illumination = Illumination::new(squares, &[light.source([0.0; 3])]);
    radiance(squares, &illumination, ray, settings, stream).x
}

#[test]
fn a_point_light_over_a_plane() {
    let plane = Squares(vec![Square { y: 0.0, half: 1e4, facing: 1.0, albedo: 0.6 }]);
    let height = 1.5f32;
    let light =
        Light::Point { position: [0.0, height as f64, 0.0], intensity: 7.0, color: [1.0; 3], radius: 0.0 };
    let mut stream = Stream::new(1, 1);
    for distance in [0.0f32, 0.4, 1.0, 3.0, 20.0] {
        let expected = 0.6 / PI * 7.0 * height / (height * height + distance * distance).powf(1.5);
        let found = upwards(&plane, &light, [distance, 0.0], Settings::default(), &mut stream);
        assert!((found / expected - 1.0).abs() < 1e-4, "{distance}: {found}, not {expected}");
        let bounced = Settings { only: Only::Indirect, ..Settings::default() };
        assert_eq!(
            upwards(&plane, &light, [distance, 0.0], bounced, &mut stream),
            0.0,
            "a plane sees no plane"
        );
    }
}

#[test]
fn two_parallel_squares_exchange_their_form_factor() {
    // Squares of edge 1 at distance 1. The sun shines from below past the lower one onto the upper one.
    const FORM_FACTOR: f32 = 0.199_825;
    let (lower, upper) = (0.7, 0.5);
    let squares = Squares(vec![
        Square { y: 0.0, half: 0.5, facing: 1.0, albedo: lower },
        Square { y: 1.0, half: 0.5, facing: -1.0, albedo: upper },
    ]);
    let sun =
        Light::Directional { direction: [1.2, 1.0, 0.0], intensity: 3.0, color: [1.0; 3], radius_deg: 0.0 };
    let on_upper = 3.0 / (1.0f32 + 1.2 * 1.2).sqrt();
    let mean = |bounces| {
        let n = 400_000;
        let settings = Settings { only: Only::Indirect, bounces, ..Settings::default() };
        let mut sum = 0.0f64;
        for i in 0..n {
            let mut stream = Stream::new(2, i);
            let place = (stream.square() - 0.5).to_array();
            sum += f64::from(upwards(&squares, &sun, place, settings, &mut stream));
        }
        (sum / n as f64) as f32
    };
    let once = lower / PI * FORM_FACTOR * upper * on_upper;
    let found = mean(Some(1));
    assert!((found / once - 1.0).abs() < 0.005, "{found}, not {once}");
    // Light with two further bounces, up and down: about twice the form factor more, and slightly over, as more of
    // the light falls on the centres, with the largest mutual form factors.
    let more = mean(Some(3)) / found - 1.0;
    let twice = lower * upper * FORM_FACTOR * FORM_FACTOR;
    assert!((1.0..1.15).contains(&(more / twice)), "{more} over {twice}");
}

/// Share of a disc of radius 1 beyond a straight edge at `s`.
fn beyond(s: f32) -> f32 {
    let s = s.clamp(-1.0, 1.0);
    (s.acos() - s * (1.0 - s * s).sqrt()) / PI
}

#[test]
fn behind_an_edge_lights_with_a_size_make_penumbrae_as_wide_as_they_look() {
    let floor = Square { y: 0.0, half: 1e4, facing: 1.0, albedo: 0.6 };
    // The square's edge is at x = 1.
    let above = Square { y: 1.0, half: 1.0, facing: 1.0, albedo: 0.6 };
    let (bare, shaded) = (Squares(vec![floor.clone()]), Squares(vec![floor, above]));
    let color = [1.0; 3];
    let lamp = Light::Point { position: [1.0, 2.0, 0.0], intensity: 7.0, color, radius: 0.2 };
    let sun = Light::Directional { direction: [0.0, -1.0, 0.0], intensity: 3.0, color, radius_deg: 10.0 };
    // Behind the edge by the projected radius of the light on the floor.
    for (light, wide) in [(lamp, 0.2), (sun, 10f32.to_radians().tan())] {
        for s in [-1.3, -0.9, -0.5, -0.2, 0.0, 0.3, 0.6, 0.9, 1.3] {
            let mut stream = Stream::new(1, 1);
            let mut mean = |squares| {
                let mut radiance =
                    || upwards(squares, &light, [1.0 - s * wide, 0.0], Settings::default(), &mut stream);
                (0..20_000).map(|_| f64::from(radiance())).sum::<f64>() / 20_000.0
            };
            let share = (mean(&shaded) / mean(&bare)) as f32;
            assert!((share - beyond(s)).abs() < 0.02, "{light:?}, {s}: {share}, not {}", beyond(s));
        }
    }
}
