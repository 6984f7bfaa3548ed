//! Section OPEN: the openness of the points.

use rebounce_shared::baked::BakedScene;
use rebounce_shared::camera::Camera;
use rebounce_shared::openness::LEVELS;
use rebounce_shared::rbn::bulk::Point;
use rebounce_shared::rbn::meta::{Level, Meta};
use rebounce_shared::rbn::{OPENNESS_SECTION, container};

/// A row of points with openness values.
fn scene(openness: Vec<u8>) -> BakedScene {
    let point = |i: u32| Point { position: [i as f32, 0.0, 0.0], radius: 1.0, ..Point::default() };
    let level = Level { first: 0, count: 40, disk_radius: 0.5, support_radius: 1.0 };
    let camera = Camera { position: [0.0; 3], target: [0.0, 0.0, -1.0], up: [0.0, 1.0, 0.0], yfov_deg: 50.0 };
    let (levels, cameras) = (vec![level], vec![camera]);
    let meta = Meta { levels, cameras, sender_levels: 1, direct_levels: 1, ..Meta::default() };
    let mut scene =
        BakedScene { meta, points: (0..40).map(point).collect(), openness, ..BakedScene::default() };
    scene.links.offsets = vec![0; 41];
    scene.later.offsets = vec![0];
    scene.relate().unwrap();
    scene
}

#[test]
fn openness_comes_back_and_asks_for_no_newer_version() {
    let some = scene((0..40).map(|i| i % (LEVELS + 1)).collect());
    let (before, now) = (scene(Vec::new()).to_bytes().unwrap(), some.to_bytes().unwrap());
    assert_eq!(container::version(&before), container::version(&now));
    let read = BakedScene::from_bytes(&now).unwrap();
    assert_eq!(read.openness, some.openness);
    assert_eq!(read.to_bytes().unwrap(), now);
    let has = |bytes: &[u8]| container::read(bytes).unwrap().iter().any(|s| s.name == OPENNESS_SECTION);
    assert!(!has(&before) && has(&now));
}

#[test]
fn what_does_not_fit_the_points_is_refused() {
    for openness in [vec![LEVELS; 39], vec![LEVELS; 41], vec![LEVELS + 1; 40]] {
        let error = scene(openness).to_bytes().unwrap_err().to_string();
        assert!(error.contains("OPEN"), "{error}");
    }
}
