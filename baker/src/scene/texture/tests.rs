//! Textures are sampled according to glTF, with correct means.

use super::*;

fn sampler(wrap: Wrap, linear_filter: bool) -> Sampler {
    let rgba = vec![[0, 0, 0, 0], [255, 255, 255, 255]];
    let texels = Arc::new(Texels::new(2, 1, rgba));
    Sampler { texels, wrap_u: wrap, wrap_v: wrap, linear_filter }
}

#[test]
fn filtering_is_linear_in_light() {
    // Half way between black and white is half the light, not half the sRGB value.
    assert!((sampler(Wrap::Repeat, true).color(Vec2::new(0.5, 0.5), 0.0, false) - 0.5).length() < 1e-6);
    assert_eq!(sampler(Wrap::Repeat, false).color(Vec2::new(0.51, 0.5), 0.0, false), Vec3::ONE);
}

#[test]
fn wrapping_follows_gltf() {
    for (wrap, at_zero, past_the_end) in
        [(Wrap::Repeat, 0.5, 0.0), (Wrap::MirroredRepeat, 0.0, 1.0), (Wrap::ClampToEdge, 0.0, 1.0)]
    {
        let s = sampler(wrap, true);
        assert!((s.color(Vec2::new(0.0, 0.5), 0.0, false).x - at_zero).abs() < 1e-6, "{wrap:?}");
        assert!((s.color(Vec2::new(1.25, 0.5), 0.0, false).x - past_the_end).abs() < 1e-6, "{wrap:?}");
        assert_eq!(s.alpha(Vec2::new(-0.25, 3.5)), if wrap == Wrap::Repeat { 1.0 } else { 0.0 });
    }
}

#[test]
fn what_a_wide_ray_sees_is_the_mean() {
    // Any size, any share: a texture of noise has the mean of its linear values, and one colour is that colour.
    for (width, height) in [(64, 64), (33, 7), (1, 5), (2, 1), (100, 3)] {
        let count = width * height;
        let noise = |i: u32| (crate::random::mix(i as u64) >> 56) as u8;
        let texels = |texel: &dyn Fn(u32) -> [u8; 4]| {
            let texels = Arc::new(Texels::new(width, height, (0..count).map(texel).collect()));
            Sampler { texels, wrap_u: Wrap::Repeat, wrap_v: Wrap::Repeat, linear_filter: true }
        };
        let (red, plain) =
            (texels(&|i| [noise(i), 0, 0, 255]), texels(&|i| [90, 20, 160, (i % 2) as u8 * 255]));
        let mean = (0..count).map(|i| LINEAR[noise(i) as usize]).sum::<f32>() / count as f32;
        // Odd sizes count some texels twice on the way.
        let tolerance = if count.is_power_of_two() { 0.01 } else { 0.15 };
        for share in [0.0, 0.01, 1.0] {
            let places =
                (0..10_000).map(|i| Vec2::new((i % 100) as f32 + 0.5, (i / 100) as f32 + 0.5) / 100.0);
            let whole = places.map(|uv| red.color(uv, share, false).x).sum::<f32>() / 10_000.0;
            assert!((whole / mean - 1.0).abs() < tolerance, "{width} x {height}, {share}: {whole}, {mean}");
        }
        for share in [0.0, 1e-3, 0.1, 1.0, 1e9, f32::INFINITY, f32::NAN] {
            for by_alpha in [false, true] {
                let seen = plain.color(Vec2::new(0.7, 0.2), share, by_alpha);
                assert!((seen - linear([90, 20, 160, 0])).length() < 1e-6, "{share}: {seen}");
            }
        }
    }
}

#[test]
fn a_picture_of_one_very_long_row_keeps_its_colour() {
    // Twice the squared width exceeds 32 bits.
    let texels = Texels::new(200_000, 1, vec![[90, 20, 160, 255]; 200_000]);
    let s =
        Sampler { linear_filter: true, texels: Arc::new(texels), wrap_u: Wrap::Repeat, wrap_v: Wrap::Repeat };
    for share in [0.0, 1e-3, 1.0] {
        for u in [0.01, 0.5, 0.99] {
            let seen = s.color(Vec2::new(u, 0.5), share, false);
            assert!((seen - linear([90, 20, 160, 0])).length() < 1e-6, "{share}, {u}: {seen}");
        }
    }
}

#[test]
fn what_alpha_hides_does_not_colour_the_mean() {
    let rgba = (0..64).map(|i| if i % 4 == 0 { [200, 100, 50, 255] } else { [0, 0, 0, 0] }).collect();
    let texels = Arc::new(Texels::new(8, 8, rgba));
    let s = Sampler { texels, wrap_u: Wrap::Repeat, wrap_v: Wrap::Repeat, linear_filter: true };
    assert!((s.color(Vec2::ZERO, 1.0, true) - linear([200, 100, 50, 0])).length() < 1e-6);
    assert!((s.color(Vec2::ZERO, 1.0, false) - 0.25 * linear([200, 100, 50, 0])).length() < 0.01);
}

#[test]
fn a_picture_that_is_none_is_refused_in_words() {
    let error = Texels::decode(b"DDS 0000").unwrap_err();
    assert!(error.contains("DDS") && error.contains("convert"), "{error}");
    assert!(Texels::decode(b"\x89PNG\r\n\x1a\nnothing").is_err());
}
