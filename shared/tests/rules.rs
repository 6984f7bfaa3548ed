//! What a .rbn file may not say: each broken rule is refused, by the name of its section.

use rebounce_shared::camera::Camera;
use rebounce_shared::glam::Vec3;
use rebounce_shared::light::Light;
use rebounce_shared::link::{LaterLink, Link};
use rebounce_shared::rbn::bulk::{Cut, Point, Vertex};
use rebounce_shared::rbn::meta::{
    Animation, DetailTexture, Draw, Interpolation, Level, Material, Meta, Property, Track,
};
use rebounce_shared::rbn::{LinkMatrix, Scene};

/// A triangle with one coarse function, which has a cut, and one fine one, which has none.
fn scene() -> Scene {
    let corner = |x: f32, y: f32| Vertex { position: [x, y, 0.0], ..Vertex::default() };
    let point = |cuts: u32| Point { position: [0.3, 0.3, 0.0], radius: 1.0, normal: 0, cuts, tint: 0 };
    let level = |first: u32| Level { first, count: 1, disk_radius: 0.5, support_radius: 1.0 };
    let camera = Camera { position: [0.0; 3], target: [0.0, 0.0, -1.0], up: [0.0, 1.0, 0.0], yfov_deg: 50.0 };
    let track = Track {
        light: 0,
        property: Property::Position,
        interpolation: Interpolation::Step,
        times: vec![0.5, 2.0],
        values: vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0],
    };
    let mut scene = Scene {
        meta: Meta {
            bounds_max: [1.0; 3],
            levels: vec![level(0), level(1)],
            sender_levels: 1,
            later_levels: 1,
            direct_levels: 2,
            materials: vec![Material::default()],
            draws: vec![Draw { first_index: 0, index_count: 3, material: 0 }],
            cameras: vec![camera],
            lights: vec![Light::Point { position: [0.0; 3], intensity: 1.0, color: [1.0; 3] }],
            animations: vec![Animation { name: "way".into(), duration: 2.0, tracks: vec![track] }],
            ..Meta::default()
        },
        vertices: vec![corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0)],
        indices: vec![0, 1, 2],
        points: vec![point(Point::pack_cuts(0, 1, 0)), point(0)],
        cuts: vec![Cut::new(Vec3::X, 0.5)],
        links: LinkMatrix::from_rows(&[vec![Link::pack(0, 0.75)], vec![Link::pack(0, -0.5)]]),
        later: LinkMatrix::from_rows(&[vec![LaterLink::pack(0, Vec3::ONE)]]),
        ..Scene::default()
    };
    scene.relate().unwrap();
    scene
}

#[test]
fn a_scene_that_keeps_the_rules_survives_the_file() {
    let scene = scene();
    assert_eq!(Scene::from_bytes(&scene.to_bytes().unwrap()).unwrap(), scene);
    assert!(scene.cuts_of(0)[0].ends(Vec3::X) && !scene.cuts_of(0)[0].ends(Vec3::Y));
    assert!(scene.cuts_of(1).is_empty());
}

#[test]
fn every_broken_rule_is_refused_by_its_section() {
    type Break = fn(&mut Scene);
    let breaks: [(&str, Break); 24] = [
        ("META", |s| s.meta.origin[1] = f64::NAN),
        ("META", |s| s.meta.cameras.clear()),
        ("META", |s| s.meta.levels[1].first = 7),
        ("META", |s| s.meta.sender_levels = 3),
        ("META", |s| s.meta.draws[0].index_count = 6),
        ("META", |s| s.meta.draws[0].material = 1),
        ("INDX", |s| s.indices[2] = 3),
        ("VERT", |s| s.vertices[0].uv[0] = f32::INFINITY),
        ("PNTS", |s| s.points[0].radius = -1.0),
        ("PNTS", |s| s.points[0].radius = 1e20),
        ("PNTS", |s| s.points[0].cuts = Point::pack_cuts(0, 2, 255)),
        ("PNTS", |s| s.points[1].cuts = Point::pack_cuts(1 << 20, 1, 0)),
        ("CUTS", |s| s.cuts[0].towards[2] = f32::NAN),
        ("LINK", |s| s.links.offsets.insert(0, 0)),
        ("LINK", |s| s.links.offsets[1] = 3),
        ("LINK", |s| s.links.links[1] = Link::pack(1, 1.0)),
        ("META", |s| s.meta.materials[0].roughness = f32::NAN),
        ("META", |s| s.meta.materials[0].normal_texture = Some(DetailTexture::default())),
        ("META", |s| s.meta.animations[0].tracks[0].light = 1),
        ("META", |s| s.meta.animations[0].tracks[0].times[1] = 0.5),
        ("META", |s| s.meta.animations[0].tracks[0].values.truncate(3)),
        ("META", |s| s.meta.animations[0].duration = -1.0),
        ("LATL", |s| s.later.offsets = vec![0]),
        ("LATL", |s| s.later.links[0] = LaterLink::pack(1, Vec3::ONE)),
    ];
    for (i, (section, damage)) in breaks.into_iter().enumerate() {
        let mut scene = scene();
        damage(&mut scene);
        let error = scene.to_bytes().expect_err("refused").to_string();
        assert!(error.contains(section), "{i}: {error}");
    }
}
