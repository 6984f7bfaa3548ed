//! Laws of exported light.

use crate::common::crowd::{Said, glb as crowd};
use glam::{Vec2, Vec3};
use rebounce::bake::{BakeSettings, Preset, bake};
use rebounce::export::dilate::{dilate, fill_charts};
use rebounce::export::meshes::{ExportMesh, meshes};
use rebounce::export::point::{Lit, Shading};
use rebounce::export::rasterize::{Coverage, rasterize};
use rebounce::export::texels::{LightTexture, NO_CHART};
use rebounce::export::unwrap::{Density, UnwrapError, unwrap};
use rebounce::export::{Export, ExportSettings, Form, PADDING, export};
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::geometry::with_lights::WithLights;
use rebounce::io::picture::Only;
use rebounce::scene::Scene;
use rebounce::verify::render::Relit;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::lighting::Lighting;
use rebounce_shared::rbn::meta::Texture;
use std::f32::consts::PI;

const FORMS: [Form; 3] = [Form::Unlit, Form::LightmapTexture, Form::VertexColours];
/// Four pixels.
const PICTURE: &[u8] = include_bytes!("../../tests/src/small.png");

fn settings(form: Form, only: Only) -> ExportSettings {
    let density = Density::AtMost(10.0);
    ExportSettings {
        form,
        density,
        max_size: 512,
        is_unwrapped: false,
        samples: 4,
        seed: 1,
        only,
        exposure: 1.0,
    }
}

/// Exports under the file's own lights, without detail.
fn exported(scene: &BakedScene, settings: &ExportSettings) -> Export {
    let surfaces = TriangleSurfaces::from_baked(scene).unwrap();
    let m = &scene.meta;
    let lighting = Lighting::new(&m.lights, None, m.origin, scene.sources.groups.len());
    let lamps = lighting.lamps.clone();
    let with_lights = WithLights::new(&surfaces, &lamps);
    let relit = Relit::lit(scene, &with_lights, lighting, false);
    export(scene, (&surfaces, &with_lights), &relit, m.cameras.first(), settings, |_| ()).unwrap()
}

fn baked(scene: &Scene, functions: usize) -> BakedScene {
    let mut settings = BakeSettings::new(Preset::Draft);
    (settings.place.levels, settings.place.functions) = (3, functions);
    settings.operator.rays = vec![512];
    bake(scene, &settings.normalised(), &()).unwrap().0
}

/// A crowd of copies, with a picture on a two-sided material.
fn many() -> BakedScene {
    let mut scene = rebounce::io::from_bytes("crowd", &crowd(Said::Nodes)).unwrap();
    scene.materials[0].double_sided = true;
    let mut baked = baked(&scene, 300);
    assert!(!baked.instances.is_empty(), "there are copies");
    baked.texture_bytes = PICTURE.to_vec();
    baked.meta.textures = vec![Texture {
        mime: "image/png".to_owned(),
        len: PICTURE.len() as u64,
        width: 2,
        height: 2,
        linear_filter: true,
        ..Texture::default()
    }];
    baked.meta.materials[0].base_color_texture = Some(0);
    baked
}

/// Area of all triangles, each copy counted; local space.
fn area(surfaces: &[ExportMesh]) -> f64 {
    let of = |mesh: &ExportMesh| -> f64 {
        let copies = 0..mesh.local_from_model.len();
        let all = copies.flat_map(|copy| (0..mesh.triangles.len()).map(move |t| (copy, t)));
        all.map(|(copy, t)| f64::from(mesh.triangle(copy, t).area())).sum()
    };
    surfaces.iter().map(of).sum()
}

/// Area of a loaded scene.
fn area_of_scene(scene: &Scene) -> f64 {
    let doubled = |triangle: &[u32; 3], place: &dyn Fn(Vec3) -> Vec3| {
        let [a, b, c] = triangle.map(|i| place(scene.positions[i as usize]));
        0.5 * f64::from((b - a).cross(c - a).length())
    };
    let end = scene.models.first().map_or(scene.triangles.len(), |m| m.triangles.start as usize);
    let mut total: f64 = scene.triangles[..end].iter().map(|t| doubled(t, &|p| p)).sum();
    for model in &scene.models {
        let triangles = &scene.triangles[model.triangles.start as usize..model.triangles.end as usize];
        for place in &model.local_from_model {
            total += triangles.iter().map(|t| doubled(t, &|p| place.transform_point3(p))).sum::<f64>();
        }
    }
    total
}

/// A furnace whose walls shine with radiance 1.
fn glowing() -> BakedScene {
    let mut scene = rebounce::io::load("builtin:furnace").unwrap();
    scene.materials[0].emission = [1.0; 3];
    scene.lights.clear();
    let mut out = baked(&scene, 1500);
    out.meta.lights.retain(|light| !light.kind().is_punctual());
    assert!(!out.meta.lights.is_empty(), "the walls are lights");
    out
}

#[test]
fn every_texel_of_a_glowing_furnace_has_the_closed_form() {
    let scene = glowing();
    // π L of what shines, and as much again over all bounces of albedo 0.5. Errors of a small bake: of a texel, their RMS,
    // and of the mean. Links of sources have few bits; those of bounces sum over many senders.
    let cases = [
        (Only::All, 2.0 * PI, [0.15, 0.03, 0.01]),
        (Only::Direct, PI, [0.25, 0.05, 0.01]),
        (Only::Indirect, PI, [0.05, 0.01, 0.01]),
    ];
    let mut found = Vec::new();
    for (only, expected, most) in cases {
        let made = exported(&scene, &settings(Form::LightmapTexture, only));
        let picture = made.lightmap.unwrap();
        let count = picture.pixels.len() as f32;
        assert!(count > 4.0 * 400.0, "{count} texels");
        let off: Vec<f32> = picture.pixels.iter().map(|e| (e.x - expected) / expected).collect();
        let worst = off.iter().fold(0f32, |worst, off| worst.max(off.abs()));
        let rms = (off.iter().map(|off| off * off).sum::<f32>() / count).sqrt();
        found.push((only, [worst, rms, off.iter().sum::<f32>().abs() / count], most));
    }
    println!("{found:?}");
    let is_near =
        |(_, errors, most): &(Only, [f32; 3], [f32; 3])| errors.iter().zip(most).all(|(e, m)| e < m);
    assert!(found.iter().all(is_near), "{found:?}");
}

/// Texels, and their light.
fn texels(scene: &BakedScene, only: Only) -> (Vec<ExportMesh>, Coverage, LightTexture) {
    let surfaces = TriangleSurfaces::from_baked(scene).unwrap();
    let lighting = Lighting::new(&scene.meta.lights, None, scene.meta.origin, 0);
    let relit = Relit::lit(scene, &surfaces, lighting, false);
    let meshes = meshes(scene);
    let atlas = unwrap(&meshes, Density::AtMost(10.0), 512, |_| true).unwrap();
    let coverage = rasterize(&meshes, &atlas);
    let shading = Shading::Irradiance;
    let lit = Lit { surfaces: &surfaces, with_lights: &surfaces, relit: &relit, only, shading };
    let settings = ExportSettings { samples: 16, ..settings(Form::LightmapTexture, only) };
    let texture = LightTexture::new(&meshes, &coverage, &lit, atlas.texels_per_unit, &settings, |_| ());
    (meshes, coverage, texture)
}

#[test]
fn direct_light_of_a_texel_is_the_inverse_square_law_at_its_place() {
    /// Of the mean over a texel of 10 cm, whose distance to the lamp is a metre at the least.
    const TOLERANCE: f32 = 0.02;
    let scene = baked(&rebounce::io::load("builtin:furnace").unwrap(), 200);
    let (meshes, coverage, texture) = texels(&scene, Only::Direct);
    let mut checked = 0;
    for (i, light) in texture.values.iter().enumerate() {
        let low = Vec2::new((i % texture.width as usize) as f32, (i / texture.width as usize) as f32);
        let inside = coverage.of(i).iter().map(|t| &coverage.triangles[*t as usize]).find(|triangle| {
            [Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ONE].iter().all(|corner| triangle.contains(low + *corner))
        });
        let Some(texel) = inside else { continue };
        let triangle = meshes[texel.mesh as usize].triangle(texel.copy as usize, texel.triangle as usize);
        let weights = texel.weights(low + 0.5);
        let place: Vec3 = triangle.positions.iter().zip(weights).map(|(p, w)| *p * w).sum();
        let expected = place.length().powi(-3);
        assert!((light.x / expected - 1.0).abs() < TOLERANCE, "{place}: {light} instead of {expected}");
        checked += 1;
    }
    assert!(checked > 1500, "{checked} texels");
}

#[test]
fn texels_belong_to_one_chart_and_dilation_keeps_to_its_bounds() {
    let (_, coverage, mut texture) = texels(&many(), Only::Direct);
    let width = texture.width as usize;
    let (mut covered, mut centres) = (0, 0);
    for i in 0..texture.values.len() {
        let touched: Vec<_> = coverage.of(i).iter().map(|t| &coverage.triangles[*t as usize]).collect();
        let Some(first) = touched.first() else { continue };
        covered += 1;
        assert!(touched.iter().all(|triangle| triangle.chart == first.chart), "texel {i} has two charts");
        let middle = Vec2::new((i % width) as f32 + 0.5, (i / width) as f32 + 0.5);
        // Well inside: neighbours share their edge.
        let inside = |weights: [f32; 3]| weights.iter().all(|weight| *weight > 1e-3);
        let owners = touched.iter().filter(|triangle| inside(triangle.weights(middle))).count();
        assert!(owners <= 1, "texel {i} is of {owners} triangles");
        centres += owners;
    }
    assert!(covered > 1000 && centres > 500, "{covered} texels, {centres} of them in triangles");
    let own = texture.charts.clone();
    fill_charts(&mut texture);
    let before = texture.clone();
    dilate(&mut texture, PADDING);
    let mut grown = 0;
    for (i, chart) in texture.charts.iter().enumerate() {
        if own[i] != NO_CHART {
            assert_eq!((*chart, texture.values[i]), (own[i], before.values[i]), "a chart's own texel");
            continue;
        }
        let (x, y, reach) = (i % width, i / width, PADDING as usize);
        let rows = y.saturating_sub(reach)..(y + reach + 1).min(texture.height as usize);
        let near =
            |row: usize| (x.saturating_sub(reach)..(x + reach + 1).min(width)).map(move |c| row * width + c);
        let near: Vec<u64> = rows.flat_map(near).map(|j| own[j]).filter(|c| *c != NO_CHART).collect();
        if *chart == NO_CHART {
            continue;
        }
        assert!(near.contains(chart), "texel {i} is farther than {PADDING} from its chart");
        grown += 1;
    }
    assert!(grown > 300, "{grown} texels around charts");
}

#[test]
fn an_exported_file_loads_again_with_the_same_area() {
    let mut surfaces = 0;
    for scene in [many(), baked(&rebounce::io::load("builtin:cornell-box").unwrap(), 200)] {
        let expected = area(&meshes(&scene));
        for form in FORMS {
            let made = exported(&scene, &settings(form, Only::All));
            let again = rebounce::io::from_bytes("lit.glb", &made.glb).unwrap();
            let found = area_of_scene(&again);
            assert!((found / expected - 1.0).abs() < 1e-4, "{form:?}: {found} instead of {expected}");
            // Slivers of a copy may have no area in local space.
            let flat = again.degenerate_triangles as u64;
            assert_eq!(again.triangles_placed() + flat, made.triangles, "{form:?}");
            assert!(100 * flat <= made.triangles, "{form:?}: {flat}");
            assert_eq!(again.cameras.len(), scene.meta.cameras.len().min(1), "{form:?}");
            let is_unlit = again.materials.iter().all(|material| material.extras.unlit);
            assert_eq!(is_unlit, form != Form::LightmapTexture, "{form:?}");
            surfaces += again.triangles.len();
        }
    }
    assert!(surfaces > 1000);
}

#[test]
fn an_export_has_the_same_bytes_twice_and_at_any_number_of_threads() {
    let scene = many();
    for form in FORMS {
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let made = pool.install(|| exported(&scene, &settings(form, Only::All)));
            (made.glb, made.lightmap)
        };
        let first = with(1);
        assert!(first.0.len() > 10_000);
        assert!(first == with(3), "{form:?}");
    }
}

#[test]
fn a_texture_that_does_not_fit_is_refused_or_made_coarser() {
    let scene = baked(&rebounce::io::load("builtin:furnace").unwrap(), 200);
    let meshes = meshes(&scene);
    let of = |density| unwrap(&meshes, density, 128, |_| true);
    let Err(UnwrapError::TooLarge { fitting, .. }) = of(Density::Exactly(100.0)) else { panic!("it fits") };
    let atlas = of(Density::Exactly(fitting)).unwrap();
    assert!(atlas.width.max(atlas.height) <= 128 && atlas.wanted.is_none());
    let atlas = of(Density::AtMost(100.0)).unwrap();
    assert!(atlas.width.max(atlas.height) <= 128 && atlas.wanted == Some(100.0));
    assert!(atlas.texels_per_unit >= fitting, "{} is less than fits", atlas.texels_per_unit);
    assert!(matches!(unwrap(&meshes, Density::AtMost(1.0), 128, |_| false), Err(UnwrapError::Empty)));
}

#[test]
fn a_floor_under_a_block_takes_the_light_beside_it() {
    // In the Cornell box the floor goes on under the blocks, where nobody sees it.
    let scene = baked(&rebounce::io::load("builtin:cornell-box").unwrap(), 400);
    let (_, coverage, mut texture) = texels(&scene, Only::All);
    let hidden: Vec<usize> =
        (0..texture.values.len()).filter(|i| !coverage.of(*i).is_empty() && !texture.is_lit[*i]).collect();
    assert!(hidden.len() > 100, "{} hidden texels", hidden.len());
    fill_charts(&mut texture);
    assert!(hidden.iter().all(|i| texture.is_lit[*i] && texture.values[*i].x > 0.0));
}
