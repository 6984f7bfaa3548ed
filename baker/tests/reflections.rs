//! Laws of the ways to reflections: even light is even in all of them, and rays find what the path tracer finds.

use crate::gloss::{add_ball, metal};
use crate::gloss_links::{baked, shining_furnace};
use glam::Vec3;
use rebounce::bake::{BakeSettings, Preset, bake};
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::io::picture::Only;
use rebounce::light::illumination::Illumination;
use rebounce::sampling::cube_maps::CubeMapSettings;
use rebounce::transport::gloss::Transfer;
use rebounce::verify::compare::compare;
use rebounce::verify::expose::Exposure;
use rebounce::verify::path_trace::{self, path_trace};
use rebounce::verify::render::Relit;
use rebounce::verify::render::reflections::cube_maps::{Correction, CubeMapLookup};
use rebounce::verify::render::reflections::{ReflectionView, Way};
use rebounce_shared::camera::Camera;
use rebounce_shared::light::Light;
use rebounce_shared::lighting::Lighting;

const MAPS: CubeMapSettings = CubeMapSettings { count: 4, side: 16, lift: 0.05, most_open: 1.0 };

#[test]
fn in_a_shining_furnace_all_ways_find_the_same_even_light() {
    let scene = shining_furnace();
    let (file, _) = baked(Transfer::Links);
    let surfaces = TriangleSurfaces::from_scene(&scene);
    let lighting = Lighting { emission: vec![Vec3::ONE; file.sources.groups.len()], ..Lighting::default() };
    let exposure = Exposure { size: [24, 24], samples: 4, seed: 1 };
    let view = ReflectionView { frame: scene.cameras[0].frame(file.meta.origin), size: exposure.size };
    let by = |correction| Way::CubeMaps(MAPS, CubeMapLookup { correction, ..CubeMapLookup::default() });
    let corrections = [Correction::Depth, Correction::MiddleDepth, Correction::Box, Correction::None];
    let mut ways =
        vec![Way::Baked, Way::Transfer, Way::Rays, Way::Screen(view, None), Way::Screen(view, Some(MAPS))];
    ways.extend(corrections.map(by));
    for way in ways {
        let relit = Relit::lit(&file, &surfaces, lighting.clone(), false);
        let relit = relit.with_reflections(&file, &surfaces, &way);
        let picture = relit.picture(&file, &surfaces, &scene.cameras[0], exposure, Only::All, || ());
        // Emission over 1 − ρ.
        let off: Vec<f32> = picture.pixels.iter().map(|pixel| pixel.x / 2.0 - 1.0).collect();
        let mean = off.iter().sum::<f32>() / off.len() as f32;
        let worst = off.iter().fold(0.0f32, |worst, off| worst.max(off.abs()));
        // Walls that are seen in walls are metals, too: of even light they give back ρ (E + ρ (1 − E)), E of some 0.97.
        assert!(mean.abs() < 0.02 && worst < 0.05, "{way:?}: {mean}, at most {worst}");
        let cost = relit.reflection_cost();
        assert_eq!(cost.samples > 0, !matches!(way, Way::Transfer), "{way:?}");
    }
}

#[test]
#[ignore = "takes much processor time: docs/dev/testing.md"]
fn rays_and_cube_maps_show_a_ball_as_the_path_tracer_does() {
    // Functions of a small bake, and metals that scatter like chalk in transport.
    const MOST: f64 = 0.03;
    let mut scene = rebounce::io::load("builtin:furnace").unwrap();
    scene.materials.push(metal([0.9, 0.7, 0.5], 0.3));
    add_ball(&mut scene, Vec3::new(0.0, -0.4, -0.3), 0.35, 1);
    // Coloured walls, by height.
    scene.materials.push(rebounce_shared::rbn::meta::Material {
        base_color: [0.6, 0.1, 0.1, 1.0],
        ..scene.materials[0].clone()
    });
    scene.triangle_material[..2].fill(2);
    let lamp = Light::Point { position: [0.5, 0.7, 0.3], intensity: 1.0, color: [1.0; 3], radius: 0.0 };
    let camera =
        Camera { position: [0.0, -0.1, 0.9], target: [0.0, -0.4, -0.3], up: [0.0, 1.0, 0.0], yfov_deg: 25.0 };
    let mut settings = BakeSettings::new(Preset::Draft);
    (settings.place.levels, settings.place.functions) = (4, 6000);
    let file = bake(&scene, &settings.normalised(), &()).unwrap().0;
    let surfaces = TriangleSurfaces::from_scene(&scene);
    let lights = [lamp];
    let illumination = Illumination::of_scene(&surfaces, &lights, scene.origin, &[], None);
    let exposure = |seed| Exposure { size: [40, 40], samples: 256, seed };
    let [a, b] = [1, 2].map(|seed| {
        let settings = path_trace::Settings { gloss: true, ..path_trace::Settings::default() };
        path_trace(&surfaces, scene.origin, &camera, &illumination, exposure(seed), settings, || ())
    });
    let lighting = Lighting::new(&lights, None, file.meta.origin, 0);
    let error = |way: Way| {
        let relit = Relit::lit(&file, &surfaces, lighting.clone(), false);
        let relit = relit.with_reflections(&file, &surfaces, &way);
        let picture = relit.picture(&file, &surfaces, &camera, exposure(3), Only::All, || ());
        compare(&picture, &a, Some(&b)).unwrap().error.figure()
    };
    let [transfer, rays, by_maps] = [Way::Transfer, Way::Rays, Way::Baked].map(error);
    assert!(rays < MOST && by_maps < MOST, "{rays} {by_maps}");
    assert!(rays < 0.5 * transfer && by_maps < 0.5 * transfer, "{rays} {by_maps} {transfer}");
}
