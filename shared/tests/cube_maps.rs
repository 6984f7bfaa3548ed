//! Cube maps in files: sections and rules.

use crate::gloss_links::{glossy, link};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::glam::Vec3;
use rebounce_shared::rbn::cube_maps::{CubeMapLayout, CubeMaps, CubeTexel, SeenSurface};
use rebounce_shared::rbn::gloss::Gloss;
use rebounce_shared::rbn::{CUBE_MAP_SECTIONS, container};

/// A scene with glossy links and a map of two texels a side that sees the group of its emissive surfaces.
fn seen() -> BakedScene {
    let mut scene = glossy(vec![link(0, 0.5)]);
    let layout = CubeMapLayout { side: 2, range: [0.25, 4.0], places: vec![[0.5, 1.0, -2.0]] };
    let surface = |i: u32| SeenSurface {
        distance: 0.25 * (1.0 + i as f32),
        normal: Vec3::Y,
        reflectance: Vec3::splat(0.5),
        metal: (i == 3).then_some(0.25),
        emitter: (i == 4).then_some(0),
        group: 0,
    };
    let texel =
        |i: u32| if i == 0 { CubeTexel::default() } else { CubeTexel::pack(&layout, &surface(i % 15)) };
    scene.cube_maps = CubeMaps { texels: (0..24).map(texel).collect(), layout };
    scene
}

#[test]
fn cube_maps_survive_the_file_and_need_both_of_their_sections() {
    let scene = seen();
    let bytes = scene.to_bytes().unwrap();
    assert_eq!(BakedScene::from_bytes(&bytes).unwrap(), scene);
    let sections = container::read(&bytes).unwrap();
    let named: Vec<_> = sections.iter().map(|s| (s.name, &bytes[s.offset..s.offset + s.len])).collect();
    for name in CUBE_MAP_SECTIONS {
        let rest: Vec<_> = named.iter().filter(|part| part.0 != name).copied().collect();
        let error = BakedScene::from_bytes(&container::write(scene.version(), &rest)).expect_err("refused");
        assert!(error.to_string().contains(&*String::from_utf8_lossy(&name)), "{error}");
    }
    // Files without maps have the bytes that they had.
    let without = glossy(vec![link(0, 0.5)]).to_bytes().unwrap();
    let rest: Vec<_> = named.iter().filter(|part| !CUBE_MAP_SECTIONS.contains(&part.0)).copied().collect();
    assert_eq!(container::write(scene.version(), &rest), without);
}

#[test]
fn cube_maps_that_do_not_fit_are_refused() {
    type Damage = fn(&mut BakedScene);
    let damages: [(&str, Damage); 8] = [
        ("CMLY", |scene| scene.cube_maps.layout.side = 6),
        ("CMLY", |scene| scene.cube_maps.layout.range[0] = 8.0),
        ("CMLY", |scene| scene.cube_maps.layout.places.clear()),
        ("CMLY", |scene| scene.cube_maps.layout.places[0][0] = f32::INFINITY),
        ("CMLY", |scene| scene.gloss = Gloss::default()),
        ("CMTX", |scene| scene.cube_maps.texels.truncate(23)),
        ("CMTX", |scene| scene.cube_maps.texels[1].groups = 2),
        ("CMTX", |scene| scene.cube_maps.texels[1].groups = 1 << 16),
    ];
    for (i, (section, damage)) in damages.into_iter().enumerate() {
        let mut scene = seen();
        damage(&mut scene);
        let error = scene.to_bytes().expect_err("refused").to_string();
        assert!(error.contains(section), "{i}: {error}");
    }
}

#[test]
fn texels_become_points_where_they_see_something() {
    let maps = seen().cube_maps;
    assert!(maps.point(0).is_none());
    let cube = maps.cube();
    for i in 1..cube.texels() {
        let (point, distance) = (maps.point(i).unwrap(), maps.texels[i].distance(&maps.layout));
        let place = maps.place(0) + distance * cube.direction(i);
        assert!(point.position().distance(place) < 1e-6 && point.normal().dot(Vec3::Y) > 0.999);
        assert!(point.has_sample(0) && !point.has_sample(1) && point.cuts().is_empty());
    }
}
