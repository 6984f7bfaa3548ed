//! The lightmap of a wavelet solution has the solution's light: on polygons, on exact faces, on copies, on backs; exports take
//! its charts.

use glam::Vec3;
use rebounce::bake::{BakeSettings, FixedSolver, Preset, SolveSettings, solve};
use rebounce::export::unwrap::Density;
use rebounce::export::{Export, ExportSettings, Form, export};
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::geometry::{Ray, Surfaces};
use rebounce::io::picture::Only;
use rebounce::scene::Scene;
use rebounce::transport::radiosity::RadiositySettings;
use rebounce::transport::wavelet::WaveletSettings;
use rebounce::verify::expose::Exposure;
use rebounce::verify::render::{Content, Relit, render};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::light_group::group_strengths;
use rebounce_shared::lighting::Lighting;
use rebounce_shared::lightmap::MixedLightmap;
use rebounce_shared::rbn::lightmap::{Lightmap, TexelCoordinates};
use rebounce_shared::relight::from_groups;

/// Solves; returns the file, and the number of charts.
fn solved(scene: &Scene, wavelets: WaveletSettings) -> (BakedScene, u64) {
    let mut bake = BakeSettings::new(Preset::Draft);
    bake.place.functions = 2500;
    let solver = FixedSolver::Wavelet(wavelets);
    let settings = SolveSettings { bake, radiosity: RadiositySettings::default(), solver };
    let (file, report) = solve(scene, &settings).unwrap();
    let report = report.wavelet.unwrap();
    assert_eq!(report.lightmap, Some(file.lightmap.layout.size), "{report:?}");
    // As another program reads it.
    (BakedScene::from_bytes(&file.to_bytes().unwrap()).unwrap(), report.charts)
}

fn coarse() -> WaveletSettings {
    WaveletSettings { max_level: 2, convergence: 0.8, ..WaveletSettings::default() }
}

fn picture(file: &BakedScene, only: Only) -> Vec<Vec3> {
    let surfaces = TriangleSurfaces::from_baked(file).unwrap();
    let exposure = Exposure { size: [80, 60], samples: 4, seed: 7 };
    let content = Content { only, detail: false };
    let lights = &file.meta.lights;
    render(file, &surfaces, &file.meta.cameras[0], lights, exposure, content, || ()).pixels
}

/// Relative RMS difference of the pictures with the lightmap and without it, and the bias.
fn difference(file: &BakedScene, only: Only) -> [f32; 2] {
    let by_points = BakedScene { lightmap: Lightmap::default(), ..file.clone() };
    let [charted, points] = [file, &by_points].map(|file| picture(file, only));
    let square: f32 = points.iter().map(|p| p.length_squared()).sum();
    let apart: f32 = charted.iter().zip(&points).map(|(a, b)| a.distance_squared(*b)).sum();
    let mean = |pixels: &[Vec3]| pixels.iter().map(|p| p.element_sum()).sum::<f32>();
    [(apart / square).sqrt(), mean(&charted) / mean(&points) - 1.0]
}

/// Relative RMS difference between the light of the points of the finest level and that of the texels where they are, the bias,
/// and the share of points where a chart was found.
fn difference_at_points(file: &BakedScene) -> [f32; 3] {
    let surfaces = TriangleSurfaces::from_baked(file).unwrap();
    let strengths = group_strengths(&file.meta.lights, &file.meta.lights).unwrap();
    let of_points = from_groups(file, &strengths).bounced;
    let mixed = MixedLightmap::new(file, &strengths);
    // Points are on the exact surface, rays meet triangles.
    let reach = 1e-3 * (surfaces.bounds().1 - surfaces.bounds().0).length();
    let (mut apart, mut square, mut sums, mut found) = (0.0, 0.0, [0.0; 2], 0);
    for i in file.display() {
        let point = &file.points[i];
        let origin = point.position() + reach * point.normal();
        let ray = Ray { max_distance: 2.0 * reach, ..Ray::visibility(origin, -point.normal()) };
        let Some(texels) = surfaces.see(&ray, 0).and_then(|hit| hit.lightmap) else { continue };
        let ([light, _], own) = (mixed.at(texels), of_points[i]);
        found += 1;
        apart += light.distance_squared(own);
        square += own.length_squared();
        sums = [sums[0] + light.element_sum(), sums[1] + own.element_sum()];
    }
    [(apart / square).sqrt(), sums[0] / sums[1] - 1.0, found as f32 / file.display().len() as f32]
}

fn charted(file: &BakedScene) -> usize {
    let coordinates = &file.lightmap.coordinates;
    file.indices.iter().filter(|i| coordinates[**i as usize] != TexelCoordinates::NONE).count()
}

#[test]
fn rooms_of_polygons_have_the_same_light_by_texels_as_by_points() {
    // A panel that shines: its direct light is a layer of its own.
    let mut scene = rebounce::io::load("builtin:cornell-box").unwrap();
    scene.materials[0].emission = [0.5, 0.4, 0.3];
    let (file, _) = solved(&scene, WaveletSettings { convergence: 0.9, ..WaveletSettings::default() });
    assert_eq!(charted(&file), file.indices.len());
    assert_eq!(file.lightmap.layout.scales.len(), file.light_groups.columns());
    assert!(file.light_groups.columns() > file.light_groups.groups.len(), "there is direct light");
    for (only, most) in [(Only::Indirect, [0.06, 0.02]), (Only::All, [0.06, 0.02])] {
        let [error, bias] = difference(&file, only);
        println!("{only:?}: {error}, {bias:+}");
        assert!(error < most[0] && bias.abs() < most[1], "{only:?}: {error} {bias}");
    }
}

#[test]
#[ignore = "takes much processor time: docs/dev/testing.md"]
fn exact_faces_copies_and_backs_have_charts_of_their_own() {
    for name in ["teapot", "chess", "opera"] {
        let scene = rebounce::io::load(&format!("builtin:{name}")).unwrap();
        let (file, _) = solved(&scene, coarse());
        assert_eq!(charted(&file), file.indices.len(), "{name}");
        assert_eq!(file.instances.is_empty(), name != "chess", "{name}: copies");
        let [error, bias, found] = difference_at_points(&file);
        println!("{name}: {error}, {bias:+}, {found}");
        assert!(error < 0.15 && bias.abs() < 0.02 && found > 0.99, "{name}: {error} {bias} {found}");
        // Copies lie apart, fronts and backs too where there are backs.
        let mut corners: Vec<[u16; 2]> = (file.lightmap.offsets.iter())
            .flat_map(|offset| [[offset.0[0], offset.0[1]], [offset.0[2], offset.0[3]]])
            .collect();
        corners.sort_unstable();
        corners.dedup();
        let is_two_sided = file.meta.materials.iter().any(|material| material.double_sided);
        assert!(corners.len() > file.instances.len(), "{name}: {} places", corners.len());
        assert!(!is_two_sided || corners.len() > file.instances.len() + 1, "{name}: backs");
    }
}

fn exported(file: &BakedScene, form: Form, is_unwrapped: bool) -> Export {
    let surfaces = TriangleSurfaces::from_baked(file).unwrap();
    let m = &file.meta;
    let lighting = Lighting::new(&m.lights, None, m.origin, file.sources.groups.len());
    let lighting = lighting.with_groups(file.solved_lights(), &m.lights).unwrap();
    let relit = Relit::lit(file, &surfaces, lighting, false);
    let settings = ExportSettings {
        form,
        density: Density::AtMost(1e-3),
        max_size: 2048,
        is_unwrapped,
        samples: 4,
        seed: 1,
        only: Only::Indirect,
        exposure: 1.0,
    };
    export(file, (&surfaces, &surfaces), &relit, m.cameras.first(), &settings, |_| ()).unwrap()
}

#[test]
#[ignore = "takes much processor time: docs/dev/testing.md"]
fn exports_take_the_charts_and_texels_of_the_file() {
    let scene = rebounce::io::load("builtin:teapot").unwrap();
    let (file, charts) = solved(&scene, WaveletSettings { convergence: 0.5, ..WaveletSettings::default() });
    let made = exported(&file, Form::LightmapTexture, false);
    let (atlas, texture) = (made.atlas.unwrap(), made.lightmap.unwrap());
    assert!(atlas.is_own && atlas.size == file.lightmap.layout.size, "{atlas:?}");
    // 18 faces, of which the seven polygons have two sides.
    assert_eq!([u64::from(atlas.charts), charts], [25, 25]);
    // Texels have the light of the file's.
    let strength = file.meta.lights[0].strength();
    let own = |i: usize| {
        let texel = file.lightmap.texels[i].0;
        strength * file.lightmap.layout.scales[0] * rebounce_shared::colour::unpack_rgb9e5(texel)
    };
    let lit: Vec<usize> = (0..texture.pixels.len()).filter(|i| own(*i) != Vec3::ZERO).collect();
    let apart: f32 = lit.iter().map(|i| texture.pixels[*i].distance_squared(own(*i))).sum();
    let square: f32 = lit.iter().map(|i| own(*i).length_squared()).sum();
    let error = (apart / square).sqrt();
    println!("{error} over {} of {} texels", lit.len(), texture.pixels.len());
    // Texels are means over samples, and borders of charts are filled otherwise.
    assert!(error < 0.2 && lit.len() * 2 > texture.pixels.len(), "{error}");
    assert!(!exported(&file, Form::LightmapTexture, true).atlas.unwrap().is_own);
    // In a glTF file again: the triangles have TEXCOORD_1.
    let document = exported(&file, Form::Unlit, false).glb;
    let length = u32::from_le_bytes(document[12..16].try_into().unwrap()) as usize;
    let json: serde_json::Value = serde_json::from_slice(&document[20..20 + length]).unwrap();
    let primitives: Vec<&serde_json::Value> =
        json["meshes"].as_array().unwrap().iter().flat_map(|m| m["primitives"].as_array().unwrap()).collect();
    assert!(!primitives.is_empty() && primitives.iter().all(|p| p["attributes"]["TEXCOORD_1"].is_u64()));
}
