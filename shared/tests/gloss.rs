//! Glossy transfer in files.

use crate::rules::scene;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::rbn::clustered::ClusterScales;
use rebounce_shared::rbn::gloss::{Gloss, GlossLayout, MAX_COMPONENTS, NO_MATRIX};
use rebounce_shared::rbn::{GLOSS_SECTIONS, container};

/// [`scene`] with glossy transfer: two points, one of them with a matrix, two clusters of one component.
fn shining() -> BakedScene {
    let mut scene = scene();
    let layout = GlossLayout {
        has_direct: false,
        roughness: [0.9, 0.35],
        channels: 3,
        scales: ClusterScales {
            components: 1,
            vectors: vec![0.5, 0.25, 1.0, 0.125],
            weights: vec![2.0, 0.0],
        },
        emission: Vec::new(),
    };
    let vectors = (0..4 * layout.dimensions()).map(|i| (i * i % 251) as u8).collect();
    scene.gloss = Gloss {
        layout,
        points: vec![0, 1],
        clusters: vec![1, NO_MATRIX],
        weights: vec![200],
        vectors,
        ..Gloss::default()
    };
    scene
}

#[test]
fn glossy_transfer_survives_the_file_and_needs_all_of_its_sections() {
    let scene = shining();
    let bytes = scene.to_bytes().unwrap();
    let back = BakedScene::from_bytes(&bytes).unwrap();
    assert!(back == scene && back.to_bytes().unwrap() == bytes);
    let version = container::version(&bytes).unwrap();
    let sections = container::read(&bytes).unwrap();
    let parts: Vec<_> = sections.iter().map(|s| (s.name, &bytes[s.offset..s.offset + s.len])).collect();
    for missing in GLOSS_SECTIONS {
        let rest: Vec<_> = parts.iter().filter(|part| part.0 != missing).copied().collect();
        let error = BakedScene::from_bytes(&container::write(version, &rest)).unwrap_err();
        assert!(error.to_string().contains(&String::from_utf8_lossy(&missing)[..]), "{error}");
    }
}

#[test]
fn a_file_without_glossy_transfer_has_no_section_of_it() {
    let bytes = scene().to_bytes().unwrap();
    let sections = container::read(&bytes).unwrap();
    assert!(sections.iter().all(|section| !GLOSS_SECTIONS.contains(&section.name)));
}

#[test]
fn a_matrix_of_one_channel_is_read() {
    let mut scene = shining();
    scene.gloss.layout.channels = 1;
    scene.gloss.vectors.truncate(4 * scene.gloss.layout.dimensions());
    assert_eq!(BakedScene::from_bytes(&scene.to_bytes().unwrap()).unwrap(), scene);
}

#[test]
fn glossy_transfer_that_does_not_fit_is_refused() {
    type Break = fn(&mut Gloss);
    let breaks: [(&str, Break); 25] = [
        ("GLBS", |g| g.layout.channels = 0),
        ("GLSY", |g| g.layout.channels = 2),
        ("GLSY", |g| g.layout.channels = u32::MAX),
        ("GLSY", |g| g.layout.scales.components = MAX_COMPONENTS as u32 + 1),
        ("GLSY", |g| g.layout.scales.components = 2),
        ("GLSY", |g| g.layout.scales.components = 0),
        ("GLSY", |g| g.layout.scales.vectors[1] = f32::NAN),
        ("GLSY", |g| g.layout.scales.vectors[3] = f32::INFINITY),
        ("GLSY", |g| g.layout.scales.weights[0] = f32::NEG_INFINITY),
        ("GLSY", |g| g.layout.scales.vectors.truncate(3)),
        ("GLSY", |g| g.layout.scales.weights.truncate(1)),
        ("GLSY", |g| {
            g.layout.scales.vectors = vec![1.0; 2 * usize::from(NO_MATRIX)];
            g.layout.scales.weights = vec![1.0; usize::from(NO_MATRIX)];
        }),
        ("GLPT", |g| g.points = vec![1, 0]),
        ("GLPT", |g| g.points = vec![1, 1]),
        ("GLPT", |g| g.points = vec![0, 2]),
        ("GLPT", |g| g.points = vec![0, u32::MAX]),
        ("GLCL", |g| g.points.truncate(1)),
        ("GLCL", |g| g.clusters = vec![2, NO_MATRIX]),
        ("GLCL", |g| g.clusters = vec![NO_MATRIX - 1, 0]),
        ("GLCL", |g| g.clusters.truncate(1)),
        ("GLWT", |g| g.clusters = vec![0, 1]),
        ("GLWT", |g| g.clusters = vec![NO_MATRIX; 2]),
        ("GLWT", |g| g.weights.clear()),
        ("GLBS", |g| g.vectors.truncate(100)),
        ("GLBS", |g| g.vectors.push(0)),
    ];
    for (i, (section, damage)) in breaks.into_iter().enumerate() {
        let mut scene = shining();
        damage(&mut scene.gloss);
        let error = scene.to_bytes().expect_err("refused").to_string();
        assert!(error.contains(section), "{i}: {error}");
    }
}
