//! Several patches that shoot together, as a tree: far from it, a point of one stands for all.
//!
//! Walter, Fernandez, Arbree, Bala, Donikian, Greenberg: Lightcuts: A Scalable Approach to Illumination
//! (2005).

use super::clusters::{PositionAndNormal, halves};
use super::emitter_cell::{EmitterCell, POINTS, QuadraturePoint};
use glam::DVec3;
use rebounce_shared::random::Stream;

/// The tree of cells, one of each patch; `place` is that of a patch.
pub(super) fn joined(
    mut cells: Vec<EmitterCell>,
    place: &impl Fn(usize) -> PositionAndNormal,
    seed: u64,
) -> EmitterCell {
    let mut stream = Stream::new(seed, cells.len() as u64);
    match cells.pop() {
        Some(only) if cells.is_empty() => only,
        last => {
            cells.extend(last);
            let mut cells: Vec<Option<EmitterCell>> = cells.into_iter().map(Some).collect();
            of_slice(&mut cells, place, &mut stream)
        }
    }
}

fn of_slice(
    cells: &mut [Option<EmitterCell>],
    place: &impl Fn(usize) -> PositionAndNormal,
    stream: &mut Stream,
) -> EmitterCell {
    let at = |cell: &Option<EmitterCell>| {
        cell.as_ref().and_then(EmitterCell::member).map_or(PositionAndNormal::default(), place)
    };
    let mut children = Vec::new();
    if cells.len() <= POINTS {
        children.extend(cells.iter_mut().filter_map(Option::take));
    } else {
        for half in halves(cells, at) {
            for quarter in halves(half, at) {
                children.push(match quarter {
                    [] => continue,
                    [one] => match one.take() {
                        Some(one) => one,
                        None => continue,
                    },
                    _ => of_slice(quarter, place, stream),
                });
            }
        }
    }
    let ball = ball(children.iter().map(|child| child.ball));
    let of_child = |i: usize| match children.get(i) {
        Some(child) => representative(child, stream.unit()),
        None => QuadraturePoint { area: 0.0, radiosity: DVec3::ZERO, ..children[0].any_point() },
    };
    let points = [0, 1, 2, 3].map(of_child);
    let first = children[0].bounds;
    let bounds = children.iter().fold(first, |bounds, child| bounds.union(child.bounds));
    EmitterCell::several(points, ball, bounds, children)
}

/// A point of a cell that has all of its power: one of its points, by chance in proportion to their powers.
fn representative(cell: &EmitterCell, chance: f32) -> QuadraturePoint {
    let weight = |point: &QuadraturePoint| point.area * point.radiosity.abs().element_sum();
    let all: f64 = cell.points().map(weight).sum();
    let area: f64 = cell.points().map(|point| point.area).sum();
    let power: DVec3 = cell.points().map(|point| point.area * point.radiosity).sum();
    let mut rest = f64::from(chance) * all;
    let mut chosen = cell.any_point();
    for point in cell.points() {
        chosen = *point;
        rest -= weight(point);
        if rest < 0.0 {
            break;
        }
    }
    let radiosity = if area > 0.0 { power / area } else { DVec3::ZERO };
    QuadraturePoint { at: chosen.at, area, radiosity }
}

/// A ball around balls.
pub(super) fn ball(balls: impl Iterator<Item = (DVec3, f64)> + Clone) -> (DVec3, f64) {
    let count = balls.clone().count().max(1);
    let centre = balls.clone().map(|ball| ball.0).sum::<DVec3>() / count as f64;
    (centre, balls.map(|ball| ball.0.distance(centre) + ball.1).fold(0.0, f64::max))
}
