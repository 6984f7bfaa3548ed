//! Laws of glossy links in whole bakes.

use glam::Vec3;
use rebounce::bake::{BakeReport, BakeSettings, Preset, bake};
use rebounce::scene::Scene;
use rebounce::transport::gloss::Transfer;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::gloss::GlossyField;
use rebounce_shared::lighting::Lighting;
use rebounce_shared::rbn::gloss_links::GlossLink;
use rebounce_shared::relight;
use std::f32::consts::TAU;

/// The furnace, a closed box of albedo 0.5, whose walls are metals that shine with a radiance of 1.
pub fn shining_furnace() -> Scene {
    let mut scene = rebounce::io::load("builtin:furnace").unwrap();
    for material in &mut scene.materials {
        (material.metallic, material.roughness) = (1.0, 0.4);
        material.emission = [1.0; 3];
    }
    scene.lights.clear();
    scene
}

pub fn baked(transfer: Transfer) -> (BakedScene, BakeReport) {
    let mut settings = BakeSettings::new(Preset::Draft);
    settings.place.levels = 4;
    settings.place.functions = 4000;
    settings.operator.rays = vec![512, 512, 512, 256];
    settings.gloss.as_mut().unwrap().transfer = transfer;
    bake(&shining_furnace(), &settings, &()).unwrap()
}

#[test]
fn in_a_shining_furnace_even_light_arrives_at_every_metal() {
    let (file, report) = baked(Transfer::Links);
    assert!(report.gloss.links > 0 && report.to_string().contains("gloss links"), "{report}");
    // No light comes from outside: points have no matrices, and nothing but links.
    assert!(file.gloss.matrices() == 0 && file.gloss.vectors.is_empty());
    let lighting = Lighting { emission: vec![Vec3::ONE; file.sources.groups.len()], ..Lighting::default() };
    let strengths = file.sources.strengths(None, &lighting.emission);
    let direct = relight::from_sources(&file, &strengths)[..file.direct_count()].to_vec();
    let sent = relight::sent_after_bounces(&file, direct);
    let field = GlossyField::new(&file, &lighting, &sent);
    let (mut sum, mut squares, mut count) = (0.0, 0.0, 0.0f32);
    for point in file.display() {
        let Some(arriving) = field.at(point) else { continue };
        let normal = file.points[point].normal();
        let to_eye = (normal + 0.6 * normal.any_orthonormal_vector()).normalize();
        let lobe = field.reflected(arriving, &[], 0.4, normal, to_eye);
        // Emission over 1 − ρ.
        let off = (lobe.radiance / (2.0 * lobe.shares[0])).x - 1.0;
        // In edges of the box even the finest senders are wide; their lobes are not round there.
        let is_in_edge =
            file.points[point].position().abs().to_array().iter().filter(|x| **x > 0.8).count() > 1;
        assert!(is_in_edge || off.abs() < 0.02, "point {point}: {off}");
        sum += off;
        squares += off * off;
        count += 1.0;
    }
    let (mean, rms) = (sum / count, (squares / count).sqrt());
    assert!(count > 1000.0 && mean.abs() < 0.005 && rms < 0.01, "{mean}, {rms} of {count}");
}

#[test]
fn rows_of_links_are_short_and_keep_the_light_of_all_their_rays() {
    let (file, _) = baked(Transfer::Links);
    let mut rows = 0;
    for row in file.gloss.links.iter().filter(|row| !row.is_empty()) {
        let is_point = |sender: u32| (sender as usize) < file.points.len();
        let (points, groups): (Vec<GlossLink>, Vec<GlossLink>) =
            row.iter().partition(|link| is_point(link.sender));
        assert!(points.len() <= 128, "{}", points.len());
        // The hemisphere, times albedo over π for what is reflected.
        for (links, whole) in [(points, 1.0), (groups, TAU)] {
            let sum: f32 = links.iter().map(|link| link.amount()).sum();
            assert!((sum / whole - 1.0).abs() < 0.01, "{sum}, not {whole}");
        }
        rows += 1;
    }
    assert!((100..=2500).contains(&rows), "{rows}");
}

#[test]
fn glossy_links_depend_on_no_number_of_threads_and_survive_the_file() {
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| baked(Transfer::Links).0)
    };
    let (one, three) = (with(1), with(3));
    let bytes = one.to_bytes().unwrap();
    assert!(bytes == three.to_bytes().unwrap());
    assert_eq!(BakedScene::from_bytes(&bytes).unwrap(), one);
}

#[test]
fn a_closed_room_has_no_matrices() {
    let (file, report) = baked(Transfer::Matrices);
    assert!(file.gloss.is_empty() && report.gloss.links == 0);
}
