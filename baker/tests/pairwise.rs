//! Laws of pairwise links.

use crate::box_room::BoxRoom;
use glam::Vec3;
use rebounce::basis::{Relations, relate};
use rebounce::geometry::Surfaces;
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::sampling::emitter::ParticleEmitter;
use rebounce::sampling::{PlaceSettings, Points, cut, place};
use rebounce::transport::direct_to_indirect::refine::refine;
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
        sender_levels: 4,
        epsilon,
        reflected: ALBEDO,
        rays: vec![4096, 2048, 1024, 1024],
        significance: 0.0,
        pooled_levels: 0,
        bounces: Some(1),
        later_levels: 2,
        far_levels: 0,
        levels: 4,
        seed: 1,
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

#[test]
fn explore() {
    let room = room();
    let (points, relations) = placed(&room, Vec3::ZERO);
    let sent = |i: usize| 1.0 + (2.0 * points.points[i].position.element_sum()).sin();
    let truth = refine(&room, &points, &relations, &settings(Refinement::Gather, 1e-4));
    let truth = received(&relations, &truth, sent);
    let evaluators: Vec<_> = (0..4).map(|l| rebounce::basis::sender_evaluator(&points, l)).collect();
    let q = rebounce::transport::direct_to_indirect::pairwise::quadrature::Quadrature::new(
        &room,
        &points,
        &evaluators,
        &(),
    )
    .unwrap();
    for level in &points.levels {
        println!("area {} of 52", level.range().map(|i| q.area(i)).sum::<f32>());
    }
    use rebounce::transport::direct_to_indirect::pairwise::coefficient::*;
    use rebounce::transport::direct_to_indirect::{
        directions::Directions, pairwise::hits::HemisphereHits, senders::Senders, tint,
    };
    let tints = tint::tints(&room, &points, 1);
    let set = settings(Refinement::Pairwise, 0.01);
    let senders = Senders::unwatched(&room, &points, &set, &tints);
    let context = senders.context(&room, &points, &relations, &set);
    let mut hits = HemisphereHits::default();
    for i in [0, 5, 10, 15, 20, 25] {
        let v = Viewpoint::of(&room, &points.points[i]);
        let cost = hits.cast(&context, i, &Directions::new(4096), 99.0);
        print!("receiver {i} at {:?} seen {}", points.points[i].position, cost.seen);
        for level in &points.levels {
            let (mut sum, mut far, mut hit) = (0.0, 0.0, 0.0);
            for j in level.range() {
                let c = coefficient(&room, &q, &v, j, context.duals[j], |s| hits.near(j, s));
                sum += c.amount;
                far += c.seen;
                hit += hits.near(j, 1e9).amount;
            }
            print!(" | {sum:.4} {far:.4} {hit:.4}");
        }
        println!();
    }
    for epsilon in [0.01, 0.001] {
        for refinement in [Refinement::Gather, Refinement::Pairwise] {
            let operator = refine(&room, &points, &relations, &settings(refinement, epsilon));
            let links: usize = operator.link_counts().sum();
            println!("{refinement:?} {epsilon}: {links} links, {} rays", operator.rays);
            let sums = received(&relations, &operator, |_| 1.0);
            let light = received(&relations, &operator, sent);
            for level in &points.levels {
                let of = |v: &[f32]| v[level.range()].to_vec();
                let s = of(&sums);
                let mean = s.iter().sum::<f32>() / s.len() as f32;
                let low = s.iter().copied().fold(9.0, f32::min);
                let high = s.iter().copied().fold(0.0, f32::max);
                let rms = (s.iter().map(|x| (x - mean).powi(2)).sum::<f32>() / s.len() as f32).sqrt();
                let (a, b) = (of(&light), of(&truth));
                let m = b.iter().sum::<f32>() / b.len() as f32;
                let e =
                    (a.iter().zip(&b).map(|(a, b)| (a - b).powi(2)).sum::<f32>() / b.len() as f32).sqrt() / m;
                let bias = a.iter().sum::<f32>() / b.iter().sum::<f32>() - 1.0;
                println!(
                    "  mean {mean:.4} rms {rms:.4} {low:.3}..{high:.3}; sine error {e:.4} bias {bias:.4}"
                );
            }
        }
    }
}
