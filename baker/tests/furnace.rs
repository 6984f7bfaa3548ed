//! Laws of a whole bake, on the built-in furnace: a closed box of albedo 0.5.

use glam::Vec3;
use rebounce::bake::{BakeReport, BakeSettings, Preset, bake};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::relight;

fn baked() -> BakedScene {
    baked_with_report().0
}

fn baked_with_report() -> (BakedScene, BakeReport) {
    let mut settings = BakeSettings::new(Preset::Draft);
    settings.place.levels = 4;
    settings.place.functions = 4000;
    settings.operator.rays = vec![512, 512, 512, 256];
    let scene = rebounce::io::load("builtin:furnace").unwrap();
    bake(&scene, &settings, &()).unwrap()
}

#[test]
fn a_furnace_is_as_bright_everywhere_as_the_series_says() {
    let scene = baked();
    let irradiance = relight::relight(&scene, vec![Vec3::ONE; scene.direct_count()]);
    // ρ / (1 − ρ) with ρ = 0.5.
    let mean: Vec3 = irradiance.iter().sum::<Vec3>() / irradiance.len() as f32;
    assert!((mean - 1.0).abs().max_element() < 0.002, "{mean}");
    for (i, e) in irradiance.iter().enumerate() {
        assert!((*e - 1.0).abs().max_element() < 0.005, "point {i}: {e}");
    }
}

#[test]
fn a_bounce_in_a_closed_room_loses_no_light_and_reports_say_so() {
    let (_, report) = baked_with_report();
    assert!(report.lost_share < 1e-4, "{}", report.lost_share);
    assert!(report.link_loss.abs() < 5e-4, "{}", report.link_loss);
    assert!(report.to_string().contains("a bounce loses 0.00"), "{report}");
}

#[test]
fn relighting_is_linear_in_the_light() {
    let scene = baked();
    let n = scene.direct_count();
    let a: Vec<Vec3> = (0..n).map(|i| Vec3::new((i % 7) as f32, 1.0, (i % 3) as f32)).collect();
    let b: Vec<Vec3> = (0..n).map(|i| Vec3::new(0.5, (i % 5) as f32, 2.0)).collect();
    let both: Vec<Vec3> = a.iter().zip(&b).map(|(a, b)| 2.0 * a + 3.0 * b).collect();
    let [a, b, both] = [a, b, both].map(|light| relight::relight(&scene, light));
    let mut largest = 0f32;
    for ((a, b), both) in a.iter().zip(&b).zip(&both) {
        let sum = 2.0 * a + 3.0 * b;
        assert!((sum - both).abs().max_element() < 1e-3 * (1.0 + sum.abs().max_element()));
        largest = largest.max(sum.max_element());
    }
    assert!(largest > 1.0);
}

#[test]
fn a_bake_survives_the_file_and_repeats_to_the_byte() {
    let scene = baked();
    let bytes = scene.to_bytes().unwrap();
    assert_eq!(BakedScene::from_bytes(&bytes).unwrap(), scene);
    assert_eq!(baked().to_bytes().unwrap(), bytes);
}

#[test]
fn a_quantised_link_is_off_by_under_three_percent_and_their_sum_by_none() {
    use rebounce_shared::link::Link;
    let mut stream = rebounce::random::Stream::new(4, 4);
    let (mut error, mut power, mut bias, mut sum) = (0.0, 0.0, 0.0, 0.0);
    for _ in 0..20_000 {
        let amount = 1e-3 * (0.1 + stream.unit());
        let off = Link::pack(0, amount).amount() - amount;
        error += off * off;
        power += amount * amount;
        bias += off as f64;
        sum += amount as f64;
    }
    assert!((error / power).sqrt() < 0.03, "{}", (error / power).sqrt());
    assert!((bias / sum).abs() < 1e-3, "{}", bias / sum);
}
