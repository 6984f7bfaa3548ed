//! Diffuse transfer in files.

use crate::rules::scene;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::diffuse_transfer::{DistantLight, TransferField};
use rebounce_shared::glam::Vec3;
use rebounce_shared::harmonics::COUNT;
use rebounce_shared::link::Link;
use rebounce_shared::rbn::clustered::{ClusterScales, MAX_COMPONENTS, NO_CLUSTER};
use rebounce_shared::rbn::diffuse_transfer::{DiffuseTransfer, TransferLayout};
use rebounce_shared::rbn::light_groups::{GroupValue, LightGroup, LightGroups};
use rebounce_shared::rbn::{DIFFUSE_SECTIONS, LinkMatrix, container};
use std::f32::consts::PI;

/// [`scene`] without links: two points, one of them with a vector, two clusters of one component.
fn object() -> BakedScene {
    let mut scene = scene();
    scene.links = LinkMatrix { offsets: vec![0; 3], links: Vec::new() };
    scene.later = LinkMatrix { offsets: vec![0], links: Vec::new() };
    scene.meta.later_levels = 0;
    let layout = TransferLayout {
        groups: 0,
        scales: ClusterScales {
            components: 1,
            vectors: vec![0.5, 0.25, 1.0, 0.125],
            weights: vec![2.0, 0.0],
        },
    };
    let vectors = (0..4 * layout.dimensions()).map(|i| (i * i % 251) as u8).collect();
    let clusters = vec![1, NO_CLUSTER];
    scene.diffuse_transfer = DiffuseTransfer { layout, clusters, weights: vec![200], vectors };
    scene.relate().unwrap();
    scene
}

#[test]
fn diffuse_transfer_survives_the_file_and_needs_all_of_its_sections() {
    let scene = object();
    let bytes = scene.to_bytes().unwrap();
    let back = BakedScene::from_bytes(&bytes).unwrap();
    assert!(back == scene && back.to_bytes().unwrap() == bytes);
    assert!(back.is_for_environment() && !back.is_unlinked() && !back.is_solved());
    let version = container::version(&bytes).unwrap();
    assert_eq!(version, container::WITHOUT_RIG);
    let sections = container::read(&bytes).unwrap();
    let parts: Vec<_> = sections.iter().map(|s| (s.name, &bytes[s.offset..s.offset + s.len])).collect();
    // An older reader would show a dark object.
    let error = BakedScene::from_bytes(&container::write(version - 1, &parts)).unwrap_err();
    assert!(error.to_string().contains("DTLY"), "{error}");
    for missing in DIFFUSE_SECTIONS {
        let rest: Vec<_> = parts.iter().filter(|part| part.0 != missing).copied().collect();
        let error = BakedScene::from_bytes(&container::write(version, &rest)).unwrap_err();
        assert!(error.to_string().contains(&String::from_utf8_lossy(&missing)[..]), "{error}");
    }
    let without = crate::rules::scene().to_bytes().unwrap();
    let sections = container::read(&without).unwrap();
    assert!(sections.iter().all(|section| !DIFFUSE_SECTIONS.contains(&section.name)));
}

#[test]
fn diffuse_transfer_that_does_not_fit_is_refused() {
    type Break = fn(&mut BakedScene);
    let breaks: [(&str, Break); 15] = [
        ("DTLY", |s| s.diffuse_transfer.layout.groups = 1),
        ("DTLY", |s| s.diffuse_transfer.layout.scales.components = MAX_COMPONENTS as u32 + 1),
        ("DTLY", |s| s.diffuse_transfer.layout.scales.components = 2),
        ("DTLY", |s| s.diffuse_transfer.layout.scales.vectors[1] = f32::NAN),
        ("DTLY", |s| s.diffuse_transfer.layout.scales.weights[0] = f32::INFINITY),
        ("DTLY", |s| s.diffuse_transfer.layout.scales.weights.truncate(1)),
        ("DTLY", |s| s.links = LinkMatrix::from_rows(&[vec![Link::pack(0, 0.5)], Vec::new()])),
        ("DTLY", |s| {
            s.light_groups = LightGroups {
                groups: vec![LightGroup { floor: 1e-3, has_direct: false }],
                values: vec![GroupValue::default(); 2],
            };
            s.meta.animations.clear();
        }),
        ("DTCL", |s| s.diffuse_transfer.clusters.truncate(1)),
        ("DTCL", |s| s.diffuse_transfer.clusters = vec![2, NO_CLUSTER]),
        ("DTCL", |s| s.diffuse_transfer.clusters = Vec::new()),
        ("DTWT", |s| s.diffuse_transfer.clusters = vec![0, 1]),
        ("DTWT", |s| s.diffuse_transfer.weights.clear()),
        ("DTBS", |s| s.diffuse_transfer.vectors.truncate(100)),
        ("DTBS", |s| s.diffuse_transfer.vectors.push(0)),
    ];
    for (i, (section, damage)) in breaks.into_iter().enumerate() {
        let mut scene = object();
        damage(&mut scene);
        let error = scene.to_bytes().expect_err("refused").to_string();
        assert!(error.contains(section), "{i}: {error}");
    }
}

#[test]
fn a_point_without_a_vector_of_its_own_has_its_parents_and_an_open_one_all_of_the_sky() {
    let mut sky = [Vec3::ZERO; COUNT];
    sky[0] = Vec3::splat((4.0 * PI).sqrt());
    let light = DistantLight { sky, all: sky, emission: Vec::new() };
    let [coarse, fine] = TransferField::new(&object()).irradiance(&light)[..] else { panic!() };
    // Both have one normal, and one is the parent of the other.
    assert_eq!(coarse, fine);
    let mut open = object();
    open.diffuse_transfer.clusters = vec![NO_CLUSTER; 2];
    open.diffuse_transfer.weights.clear();
    for received in TransferField::new(&open).irradiance(&light) {
        assert!((received.direct - PI).abs().max_element() < 1e-5 && received.bounced == Vec3::ZERO);
        assert!(received.direct != coarse.direct);
    }
}
