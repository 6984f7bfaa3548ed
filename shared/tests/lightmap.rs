//! Lightmaps in files, and their sum under the strengths of a picture.

use crate::rules::solved;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::colour::{pack_rgb9e5, unpack_rgb9e5};
use rebounce_shared::glam::Vec3;
use rebounce_shared::lightmap::MixedLightmap;
use rebounce_shared::rbn::light_groups::LightGroups;
use rebounce_shared::rbn::lightmap::{ChartOffset, Lightmap, LightmapLayout, Texel, TexelCoordinates};
use rebounce_shared::rbn::{LIGHTMAP_SECTIONS, container};

/// [`solved`] with a lightmap of three layers.
fn charted() -> BakedScene {
    let mut scene = solved();
    let texels = (0..3 * 4 * 5).map(|i| Texel(pack_rgb9e5(Vec3::new(0.1, 0.5, 1.0) * i as f32 / 60.0)));
    scene.lightmap = Lightmap {
        layout: LightmapLayout { size: [4, 5], scales: vec![1.0, 0.5, 2.0] },
        coordinates: (0..scene.vertices.len()).map(|i| TexelCoordinates([i as u16, 40_000])).collect(),
        offsets: vec![ChartOffset([1, 2, 3, 4]); scene.instances.len() + 1],
        texels: texels.collect(),
    };
    scene.lightmap.coordinates[0] = TexelCoordinates::NONE;
    scene
}

#[test]
fn lightmaps_survive_the_file_and_other_readers_do_without() {
    let scene = charted();
    let bytes = scene.to_bytes().unwrap();
    assert_eq!(BakedScene::from_bytes(&bytes).unwrap(), scene);
    assert_eq!(container::version(&bytes), Some(container::ONE_GROUP));
    let sections = container::read(&bytes).unwrap();
    let parts: Vec<_> = sections.iter().map(|s| (s.name, &bytes[s.offset..s.offset + s.len])).collect();
    for missing in LIGHTMAP_SECTIONS {
        let rest: Vec<_> = parts.iter().filter(|part| part.0 != missing).copied().collect();
        let error = BakedScene::from_bytes(&container::write(container::ONE_GROUP, &rest)).unwrap_err();
        assert!(error.to_string().contains(&String::from_utf8_lossy(&missing)[..]), "{error}");
    }
    let strengths = [Vec3::new(2.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0)];
    let mixed = MixedLightmap::new(&scene, &strengths);
    let texel = |layer: usize, i: usize| unpack_rgb9e5(scene.lightmap.layer(layer)[i].0);
    let bounced = texel(0, 7) * strengths[0] + 0.5 * texel(1, 7) * strengths[1];
    assert!(mixed.bounced[7].distance(bounced) < 1e-6, "{}", mixed.bounced[7]);
    assert!(mixed.direct[7].distance(2.0 * texel(2, 7) * strengths[1]) < 1e-6, "{}", mixed.direct[7]);
}

#[test]
fn lightmaps_that_do_not_fit_are_refused() {
    type Break = fn(&mut BakedScene);
    let breaks: [(&str, Break); 10] = [
        ("LMAP", |s| s.lightmap.layout.size = [0, 5]),
        ("LMAP", |s| s.lightmap.layout.size = [4, 4097]),
        ("LMAP", |s| s.lightmap.layout.scales.truncate(2)),
        ("LMAP", |s| s.lightmap.layout.scales[1] = 0.0),
        ("LMAP", |s| s.lightmap.layout.scales[1] = f32::NAN),
        ("LMAP", |s| s.lightmap.layout.scales.clear()),
        ("LMUV", |s| s.lightmap.coordinates.truncate(1)),
        ("LMOF", |s| s.lightmap.offsets.clear()),
        ("LMTX", |s| s.lightmap.texels.truncate(59)),
        ("LMAP", |s| s.light_groups = LightGroups::default()),
    ];
    for (i, (section, damage)) in breaks.into_iter().enumerate() {
        let mut scene = charted();
        damage(&mut scene);
        let error = scene.to_bytes().expect_err("refused").to_string();
        assert!(error.contains(section), "{i}: {error}");
    }
}
