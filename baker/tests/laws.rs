//! Laws of points, basis and operator, on a closed box seen only through the surface interface.

use crate::box_room;

use box_room::BoxRoom;
use glam::Vec3;
use rebounce::basis::{Evaluator, Relations, Support, relate};
use rebounce::sampling::emitter::ParticleEmitter;
use rebounce::sampling::{PlaceSettings, Points, SurfacePoint, place};
use rebounce::transport::direct_to_indirect::{
    Operator, OperatorSettings, Refinement, bounces::add_later_bounces, refine::refine,
};
use rebounce_shared::interpolation::mean;
use rebounce_shared::kernel::distance_5d;
use rebounce_shared::link::{LaterLink, Sent};

fn room(albedo: f32) -> BoxRoom {
    BoxRoom { low: Vec3::new(-2.0, -1.0, -1.5), high: Vec3::new(2.0, 1.0, 1.5), albedo: Vec3::splat(albedo) }
}

fn small_place() -> PlaceSettings {
    PlaceSettings { levels: 4, functions: 3000, ..PlaceSettings::default() }
}

fn small_operator() -> OperatorSettings {
    OperatorSettings {
        refinement: Refinement::Gather,
        sender_levels: 3,
        epsilon: 1e-3,
        reflected: 1.0,
        rays: vec![1024, 512, 256, 256],
        significance: 0.5,
        pooled_levels: 0,
        bounces: None,
        later_levels: 2,
        far_levels: 0,
        levels: 4,
        seed: 1,
    }
}

fn bake(albedo: f32) -> (Points, Relations, Operator) {
    let room = room(albedo);
    let points = place(&room, &ParticleEmitter::within(Vec3::ZERO), &small_place(), &()).unwrap();
    let relations = relate(&points, 4).unwrap();
    let mut operator = refine(&room, &points, &relations, &small_operator());
    add_later_bounces(&mut operator, &small_operator());
    (points, relations, operator)
}

#[test]
fn points_keep_their_poisson_distance_and_cover_the_room() {
    let room = room(0.5);
    let points = place(&room, &ParticleEmitter::within(Vec3::ZERO), &small_place(), &()).unwrap();
    assert_eq!(points.levels.len(), 4);
    for (l, level) in points.levels.iter().enumerate() {
        let list = &points.points[level.range()];
        for (i, p) in list.iter().enumerate() {
            for q in &list[..i] {
                assert!(distance_5d(p.position, p.normal, q.position, q.normal) >= level.disk_radius);
            }
        }
        // Maximal: nearly every place is covered by a function.
        let support = |p: &SurfacePoint| Support {
            group: p.group,
            position: p.position,
            normal: p.normal,
            radius: level.support_radius,
            cuts: &[],
        };
        let evaluator = Evaluator::new(list.iter().map(support), 0);
        let finest = &points.points[points.levels[3].range()];
        let covered = finest
            .iter()
            .filter(|p| evaluator.gather(p.position, p.normal, p.group, |_, _| {}) > 0.0)
            .count();
        assert!(covered as f32 > 0.97 * finest.len() as f32, "level {l}: {covered} of {}", finest.len());
    }
    let counts: Vec<f32> = points.levels.iter().map(|l| l.count as f32).collect();
    assert!((30.0..120.0).contains(&counts[0]), "{counts:?}");
    for w in counts.windows(2) {
        assert!(
            (2.5..6.0).contains(&(w[1] / w[0])),
            "halving the radius makes about four times the points: {counts:?}"
        );
    }
}

#[test]
fn placement_does_not_depend_on_units_or_place() {
    let metres = place(&room(0.5), &ParticleEmitter::within(Vec3::ZERO), &small_place(), &()).unwrap();
    let scale = 1000.0;
    let room = room(0.5);
    let millimetres = BoxRoom { low: room.low * scale, high: room.high * scale, albedo: room.albedo };
    let millimetres = place(&millimetres, &ParticleEmitter::within(Vec3::ZERO), &small_place(), &()).unwrap();
    for (a, b) in metres.levels.iter().zip(&millimetres.levels) {
        let ratio = b.count as f32 / a.count as f32;
        assert!((0.9..1.1).contains(&ratio), "{} {}", a.count, b.count);
    }
}

#[test]
fn a_constant_projects_to_itself() {
    let (points, relations, _) = bake(0.5);
    for i in 0..points.points.len() {
        if let Some(value) = mean(relations.push().row(i), 0.0, |_| 1.0) {
            assert!((value - 1.0f32).abs() < 1e-6);
        }
    }
    assert!(relations.push().row(points.levels[1].first + 3).len() > 1);
}

/// Bounced irradiance of each point of level 0 under unit irradiance everywhere: S applied to ones (red channel).
fn from_ones(points: &Points, relations: &Relations, operator: &Operator) -> Vec<f32> {
    let row = |i: usize, sent: &[f32]| -> f32 {
        operator.links[i].iter().map(|link| link.amount() * sent[link.sender()]).sum()
    };
    let senders = points.levels[..small_operator().sender_levels].last().unwrap().range().end;
    let ones = vec![1.0; senders];
    // One bounce at the coarse points: their links and their parents'.
    let mut first: Vec<f32> = Vec::new();
    for i in 0..operator.later.len() {
        let parents = mean(relations.push().row(i), 0.0, |p| first[p]);
        first.push(row(i, &ones) + parents.unwrap_or(0.0));
    }
    let further = |row: &[LaterLink]| row.iter().map(|l| l.colour().x * first[l.sender()]).sum::<f32>();
    let mut bounced: Vec<f32> =
        operator.later.iter().zip(&first).map(|(row, first)| first + further(row)).collect();
    for i in bounced.len()..senders {
        let parents = mean(relations.push().row(i), 0.0, |p| bounced.get(p).copied().unwrap_or(0.0));
        bounced.push(parents.unwrap_or(0.0));
    }
    let sent: Vec<f32> = bounced.iter().map(|bounced| 1.0 + bounced).collect();
    points.levels[0].range().map(|i| row(i, &sent)).collect()
}

#[test]
fn furnace_unit_irradiance_comes_back_as_the_geometric_series() {
    for albedo in [0.3, 0.8] {
        let (points, relations, operator) = bake(albedo);
        let want = albedo / (1.0 - albedo);
        let found = from_ones(&points, &relations, &operator);
        for (i, got) in found.iter().enumerate() {
            assert!((got / want - 1.0).abs() < 0.02, "albedo {albedo}, receiver {i}: {got}, not {want}");
        }
        let mean = found.iter().sum::<f32>() / found.len() as f32;
        assert!((mean / want - 1.0).abs() < 0.01, "albedo {albedo}: {mean}, not {want}");
    }
}

#[test]
fn the_same_seed_gives_the_same_operator_at_any_thread_count() {
    let with = |threads: usize| {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| bake(0.6))
    };
    let (one, three) = (with(1), with(3));
    assert_eq!(one.0, three.0);
    assert_eq!(one.1, three.1);
    assert_eq!(one.2.links, three.2.links);
    assert_eq!(one.2.tints, three.2.tints);
    assert_eq!(one.2.later, three.2.later);
    assert!(one.2.link_counts().sum::<usize>() > 1000);
}

#[test]
fn later_bounces_stop_where_they_are_told_to() {
    let room = room(0.5);
    let points = place(&room, &ParticleEmitter::within(Vec3::ZERO), &small_place(), &()).unwrap();
    let relations = relate(&points, 4).unwrap();
    let one = refine(&room, &points, &relations, &small_operator());
    let mut expected = 0.0;
    for bounces in 1..4 {
        expected += 0.5f32.powi(bounces);
        let mut operator = one.clone();
        let settings = OperatorSettings { bounces: Some(bounces as u32), ..small_operator() };
        add_later_bounces(&mut operator, &settings);
        assert_eq!(operator.bounces, bounces as u32);
        let found = from_ones(&points, &relations, &operator);
        let got = found.iter().sum::<f32>() / found.len() as f32;
        assert!((got / expected - 1.0).abs() < 0.02, "{bounces} bounces: {got}, not {expected}");
    }
}
