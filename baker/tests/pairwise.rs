//! Laws of pairwise links.

use crate::box_room::BoxRoom;
use crate::tiles;
use glam::{DVec3, Vec3};
use rebounce::bake::{BakeSettings, Preset, bake};
use rebounce::basis::{Relations, relate};
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::geometry::{Hit, Ray, Surfaces};
use rebounce::sampling::emitter::ParticleEmitter;
use rebounce::sampling::{PlaceSettings, Points, cut, place};
use rebounce::transport::direct_to_indirect::pairwise::Pairwise;
use rebounce::transport::direct_to_indirect::refine::refine;
use rebounce::transport::direct_to_indirect::tint;
use rebounce::transport::{Operator, OperatorSettings, Refinement};
use rebounce_shared::interpolation::mean;
use rebounce_shared::link::Sent;

/// Albedo of the closed room.
const ALBEDO: f32 = 0.5;

fn room() -> BoxRoom {
    BoxRoom { low: Vec3::new(-2.0, -1.0, -1.5), high: Vec3::new(2.0, 1.0, 1.5), albedo: Vec3::splat(ALBEDO) }
}

fn placed<S: Surfaces>(surfaces: &S, from: Vec3) -> (Points, Relations) {
    let settings = PlaceSettings { levels: 4, functions: 3_000, ..PlaceSettings::default() };
    let mut points = place(surfaces, &ParticleEmitter::within(from), &settings, &()).unwrap();
    let count = points.points.len();
    cut(surfaces, &mut points, count, &()).unwrap();
    let relations = relate(&points, 4).unwrap();
    (points, relations)
}

fn settings(refinement: Refinement, epsilon: f32) -> OperatorSettings {
    OperatorSettings {
        refinement,
        epsilon,
        reflected: ALBEDO,
        rays: vec![4096, 2048, 1024, 1024],
        ..tiles::settings(1)
    }
}

/// Irradiance of every point from these senders, whose light is pulled to the coarser ones.
fn received(relations: &Relations, operator: &Operator, sent: impl Fn(usize) -> f32) -> Vec<f32> {
    let count = operator.links.len();
    let mut pulled: Vec<f32> = (0..count).map(sent).collect();
    for i in (0..relations.pull().len()).rev() {
        pulled[i] = mean(relations.pull().row(i), 0.0, |child| pulled[child]).unwrap_or(pulled[i]);
    }
    let mut received: Vec<f32> = Vec::with_capacity(count);
    for (i, links) in operator.links.iter().enumerate() {
        let parents = mean(relations.push().row(i), 0.0, |parent| received[parent]).unwrap_or(0.0);
        received.push(parents + links.iter().map(|link| link.amount() * pulled[link.sender()]).sum::<f32>());
    }
    received
}

/// Relative RMS difference of two rows of irradiance.
fn difference(ours: &[f32], theirs: &[f32]) -> f32 {
    let squares = |values: &mut dyn Iterator<Item = f32>| values.map(|value| value * value).sum::<f32>();
    let off = squares(&mut ours.iter().zip(theirs).map(|(a, b)| a - b));
    (off / squares(&mut theirs.iter().copied())).sqrt()
}

#[test]
fn a_row_of_a_closed_room_sums_to_its_albedo() {
    let room = room();
    let (points, relations) = placed(&room, Vec3::ZERO);
    let operator = refine(&room, &points, &relations, &settings(Refinement::Pairwise, 0.01));
    let sums = received(&relations, &operator, |_| 1.0);
    // Rows of the initial gather keep the sum of a hemisphere through all refinement of senders.
    for sum in &sums[points.levels[0].range()] {
        assert!((sum / ALBEDO - 1.0).abs() < 1e-3, "{sum}");
    }
    // Below, ten rays a link: no bias, and a few hundredths of noise.
    let mean = sums.iter().sum::<f32>() / sums.len() as f32;
    assert!((mean / ALBEDO - 1.0).abs() < 0.01, "{mean}");
    let spread = difference(&sums, &vec![ALBEDO; sums.len()]);
    assert!(spread < 0.04, "{spread}");
    assert!(operator.lost_share.abs() < 1e-4, "{}", operator.lost_share);
}

#[test]
fn pairwise_links_come_closer_to_gathered_ones_as_tolerances_shrink() {
    let room = room();
    let (points, relations) = placed(&room, Vec3::ZERO);
    // From 0 to 2, within the length of a room.
    let sent = |i: usize| 1.0 + (2.0 * points.points[i].position.element_sum()).sin();
    let of = |refinement, epsilon| {
        let operator = refine(&room, &points, &relations, &settings(refinement, epsilon));
        received(&relations, &operator, sent)
    };
    let gathered = of(Refinement::Gather, 1e-4);
    let [coarse, middle, fine] =
        [0.1, 0.01, 0.001].map(|epsilon| difference(&of(Refinement::Pairwise, epsilon), &gathered));
    assert!(fine < middle && middle < coarse, "{coarse}, {middle}, {fine}");
    // What is left is the error of ten places a sender.
    assert!(coarse < 0.15 && fine < 0.04, "{coarse}, {fine}");
}

#[test]
fn no_sender_is_finer_than_the_limit() {
    let room = room();
    let (points, relations) = placed(&room, Vec3::ZERO);
    for limit in [1, 2, 3] {
        let settings = OperatorSettings {
            sender_levels: limit,
            later_levels: 1,
            ..settings(Refinement::Pairwise, 1e-3)
        };
        let operator = refine(&room, &points, &relations, &settings);
        let finest = operator.links.iter().flatten().map(|link| link.sender()).max().unwrap();
        // As fine as it may be, and no finer.
        assert!(points.levels[limit - 1].range().contains(&finest), "{finest} with {limit} levels");
    }
}

/// Two closed rooms; what is on either side of the wall between them is a reconstruction group.
struct TwoGroups {
    rooms: TriangleSurfaces,
    /// The middle of the wall along x, local space.
    middle: f32,
}

impl TwoGroups {
    fn grouped(&self, hit: Hit) -> Hit {
        Hit { group: (hit.position.x > self.middle) as u32, ..hit }
    }
}

impl Surfaces for TwoGroups {
    fn cast(&self, ray: &Ray, seed: u32) -> Option<Hit> {
        self.rooms.cast(ray, seed).map(|hit| self.grouped(hit))
    }

    fn see(&self, ray: &Ray, seed: u32) -> Option<Hit> {
        self.rooms.see(ray, seed).map(|hit| self.grouped(hit))
    }

    fn transmittance(&self, from: Vec3, to: Vec3) -> Vec3 {
        self.rooms.transmittance(from, to)
    }

    fn bounds(&self) -> (Vec3, Vec3) {
        self.rooms.bounds()
    }

    fn epsilon(&self) -> f32 {
        self.rooms.epsilon()
    }
}

#[test]
fn no_link_leads_through_a_wall_and_no_function_reaches_another_group() {
    let scene = rebounce::io::load("builtin:two-rooms").unwrap();
    let middle = -scene.origin[0] as f32;
    let surfaces = TwoGroups { rooms: TriangleSurfaces::from_scene(&scene), middle };
    let eyes = [-2.0, 2.0].map(|x| (DVec3::new(x, 1.2, 2.0) - DVec3::from(scene.origin)).as_vec3());
    let place_settings = PlaceSettings { levels: 4, functions: 3_000, ..PlaceSettings::default() };
    let emitter = ParticleEmitter { viewpoints: eyes.to_vec(), ..ParticleEmitter::within(eyes[0]) };
    let mut points = place(&surfaces, &emitter, &place_settings, &()).unwrap();
    let count = points.points.len();
    cut(&surfaces, &mut points, count, &()).unwrap();
    let relations = relate(&points, 4).unwrap();
    let settings = settings(Refinement::Pairwise, 0.003);
    let tints = tint::tints(&surfaces, &points, 1);
    let pairwise = Pairwise::new(&surfaces, &points, &relations, &settings, &tints, &()).unwrap();
    let mut shares = 0;
    for (parent, point) in points.points.iter().enumerate() {
        for (child, _) in pairwise.sender_children.of(parent) {
            assert_eq!(points.points[*child as usize].group, point.group);
            shares += 1;
        }
    }
    assert!(shares > count, "{shares}");
    let operator = refine(&surfaces, &points, &relations, &settings);
    let mut links = [0; 2];
    for (receiver, row) in operator.links.iter().enumerate() {
        let group = points.points[receiver].group;
        for link in row {
            let (here, there) = (&points.points[receiver], &points.points[link.sender()]);
            assert_eq!(there.group, group, "{here:?} from {there:?}: {}", link.amount());
            links[group as usize] += 1;
        }
    }
    assert!(links.iter().all(|links| *links > 5_000), "{links:?}");
}

#[test]
fn threads_and_repetition_change_nothing() {
    let scene = rebounce::io::load("builtin:cornell-box").unwrap();
    let mut settings = BakeSettings::new(Preset::Draft);
    settings.operator.refinement = Refinement::Pairwise;
    settings.place.functions = 1_500;
    let bytes = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| bake(&scene, &settings, &()).unwrap().0.to_bytes().unwrap())
    };
    let one = bytes(1);
    assert!(one == bytes(2) && one == bytes(1));
    settings.operator.refinement = Refinement::Gather;
    let gathered = bake(&scene, &settings, &()).unwrap().0.to_bytes().unwrap();
    assert!(one != gathered);
}
