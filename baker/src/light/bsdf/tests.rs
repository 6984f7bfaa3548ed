use super::*;
use crate::geometry::Gloss;

const ROUGHNESSES: [f32; 5] = [0.1, 0.2, 0.45, 0.7, 1.0];

/// A hit on a surface with this shading normal, whose true normal is z.
fn hit(normal: Vec3, albedo: Vec3, roughness: f32) -> Hit {
    Hit {
        distance: 1.0,
        position: Vec3::ZERO,
        geometric_normal: Vec3::Z,
        normal,
        albedo,
        emission: Vec3::ZERO,
        emitter: None,
        is_unlit: false,
        group: 0,
        lightmap: None,
        gloss: Gloss { metallic: 1.0, roughness, specular: 0.5 },
    }
}

/// A direction at this cosine to a normal.
fn at_cosine(normal: Vec3, cosine: f32) -> Vec3 {
    normal * cosine + tangents(normal).0 * (1.0 - cosine * cosine).sqrt()
}

/// Share of even light that the samples reflect, with the albedo.
fn reflected(bsdf: &Bsdf, seed: u64, samples: u64) -> Vec3 {
    let mut stream = Stream::new(seed, 0);
    let weights = (0..samples).map(|_| bsdf.sample(&mut stream).map_or(0.0, |sample| sample.weight));
    bsdf.albedo * (weights.sum::<f32>() / samples as f32)
}

#[test]
fn a_conductor_reflects_no_more_than_its_colour_and_a_white_one_all() {
    let colour = Vec3::new(1.0, 0.6, 0.1);
    for roughness in ROUGHNESSES {
        for cosine in [0.02, 0.1, 0.4, 0.8, 1.0] {
            let bsdf = Bsdf::new(&hit(Vec3::Z, colour, roughness), at_cosine(Vec3::Z, cosine), true);
            let share = reflected(&bsdf, 1, 20_000);
            assert!((share.x - 1.0).abs() < 0.02, "{roughness} {cosine}: {share}");
            assert!(share.cmple(colour * 1.02).all(), "{roughness} {cosine}: {share}");
            assert!(share.cmpge(colour * 0.3).all(), "{roughness} {cosine}: {share}");
        }
    }
}

#[test]
fn samples_have_the_density_and_the_weight_that_the_reflectance_has() {
    let mut stream = Stream::new(6, 1);
    let normal = Vec3::new(0.2, -0.3, 0.9).normalize();
    for gloss in [false, true] {
        for (roughness, cosine) in ROUGHNESSES.into_iter().flat_map(|r| [(r, 0.1), (r, 0.5), (r, 0.95)]) {
            let bsdf = Bsdf::new(&hit(normal, Vec3::ONE, roughness), at_cosine(normal, cosine), gloss);
            for _ in 0..200 {
                let Some(sample) = bsdf.sample(&mut stream) else { continue };
                let (density, along) = (bsdf.density(sample.to_light), normal.dot(sample.to_light));
                assert!((sample.density / density - 1.0).abs() < 0.05, "{} {density}", sample.density);
                if along > 0.01 {
                    let expected = bsdf.albedo * sample.weight * sample.density / along;
                    let found = bsdf.reflectance(sample.to_light);
                    assert!((found / expected - 1.0).abs().max_element() < 0.05, "{found} {expected}");
                }
            }
        }
    }
}

#[test]
fn light_from_below_a_conductor_does_not_pass_and_an_eye_below_its_shading_normal_sees_finite_light() {
    // Interpolated normals lean far from the true one.
    let normal = Vec3::new(0.8, 0.0, 0.6);
    let mut stream = Stream::new(3, 5);
    for roughness in ROUGHNESSES {
        for to_eye in [Vec3::new(-0.9, 0.1, 0.4).normalize(), Vec3::new(0.9, 0.3, 0.1).normalize(), -normal] {
            let bsdf = Bsdf::new(&hit(normal, Vec3::ONE, roughness), to_eye, true);
            for _ in 0..500 {
                if let Some(sample) = bsdf.sample(&mut stream) {
                    assert!(sample.to_light.z > 0.0 && sample.weight <= 1.0 && sample.density.is_finite());
                }
                let to_light = stream.sphere();
                let (reflectance, density) = (bsdf.reflectance(to_light), bsdf.density(to_light));
                assert!(reflectance.is_finite() && density.is_finite());
                if to_light.z <= 0.0 || normal.dot(to_light) <= 0.0 {
                    assert_eq!((reflectance, density), (Vec3::ZERO, 0.0));
                }
            }
            assert!(reflected(&bsdf, 4, 2000).is_finite());
        }
    }
}

#[test]
fn only_metals_have_a_lobe_and_only_with_gloss() {
    let metal = hit(Vec3::Z, Vec3::splat(0.5), 0.3);
    let matt = Hit { gloss: Gloss::MATT, ..metal };
    let to_eye = at_cosine(Vec3::Z, 0.7);
    let mirrored = Vec3::new(-to_eye.x, -to_eye.y, to_eye.z);
    for (hit, gloss) in [(metal, false), (matt, false), (matt, true)] {
        let bsdf = Bsdf::new(&hit, to_eye, gloss);
        assert_eq!(bsdf.albedo, hit.albedo);
        assert_eq!(bsdf.reflectance(mirrored), hit.albedo * FRAC_1_PI);
        let (mut one, mut other) = (Stream::new(1, 2), Stream::new(1, 2));
        let sample = bsdf.sample(&mut one).unwrap();
        assert_eq!((sample.to_light, sample.weight), (other.cosine_hemisphere(Vec3::Z), 1.0));
    }
    assert!(Bsdf::new(&metal, to_eye, true).reflectance(mirrored).x > 2.0);
}
