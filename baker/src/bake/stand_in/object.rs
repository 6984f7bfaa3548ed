//! View of an object or a landscape from outside.

use super::YFOV_DEG;
use crate::scene::bounds_of;
use glam::Vec3;
use rebounce_shared::elementary::Elementary;

/// Direction from the object to the eye: from the front (glTF objects face +z), slightly right and above.
const AHEAD: Vec3 = Vec3::new(0.45, 0.35, 1.0);
/// Share of the picture's height filled by the object's box, or share of the width in a picture `WIDE` times as wide as
/// high.
const FILLED: f32 = 0.85;
const WIDE: f32 = 1.3;
/// Share of triangles excluded from the central box at each end of each axis.
const FEW: f32 = 0.02;
/// Interpolation from the central box to the complete box.
const AROUND: f32 = 0.5;
/// Number of bisection steps for the eye.
const STEPS: usize = 32;
/// Approximate maximum number of triangles to examine.
const LOOKED: usize = 1 << 16;

/// Returns the box to frame: the box of the central triangles, enlarged towards the complete box `low`, `high`. A
/// statue on a plate thus appears larger than if the complete plate were framed.
pub fn shown(triangles: impl ExactSizeIterator<Item = [Vec3; 3]>, low: Vec3, high: Vec3) -> (Vec3, Vec3) {
    let step = triangles.len().div_ceil(LOOKED).max(1);
    let triangles: Vec<[Vec3; 3]> = triangles.step_by(step).collect();
    let (mut least, mut most) = (low, high);
    for axis in 0..3 {
        let mut middles: Vec<f32> =
            triangles.iter().map(|[a, b, c]| (a[axis] + b[axis] + c[axis]) / 3.0).collect();
        middles.sort_by(f32::total_cmp);
        let few = (FEW * middles.len() as f32) as usize;
        if let (Some(first), Some(last)) = (middles.get(few), middles.iter().nth_back(few)) {
            (least[axis], most[axis]) = (*first, *last);
        }
    }
    let is_within = |[a, b, c]: &&[Vec3; 3]| {
        let middle = (*a + *b + *c) / 3.0;
        middle.cmpge(least - 1e-6).all() && middle.cmple(most + 1e-6).all()
    };
    let corners: Vec<Vec3> = triangles.iter().filter(is_within).flatten().copied().collect();
    let (least, most) = if corners.is_empty() { (low, high) } else { bounds_of(&corners) };
    (least.lerp(low, AROUND), most.lerp(high, AROUND))
}

/// Returns eye and target, local space, so that the box `low`, `high` fills the picture and is centred.
pub fn view(low: Vec3, high: Vec3) -> (Vec3, Vec3) {
    let middle = 0.5 * (low + high);
    let radius = 0.5 * (high - low).length().max(f32::MIN_POSITIVE);
    let back = AHEAD.normalize();
    let right = Vec3::Y.cross(back).normalize();
    let up = back.cross(right);
    let reach = FILLED * (0.5 * YFOV_DEG as f32).to_radians().tangent();
    let corners: Vec<Vec3> = (0..8).map(|i| Vec3::select(mask(i), high, low) - middle).collect();
    // Coordinates across the view, and along the view towards the eye.
    let seen =
        |axis: Vec3| -> Vec<(f32, f32)> { corners.iter().map(|c| (c.dot(axis), c.dot(back))).collect() };
    let axes = [(seen(right), WIDE * reach), (seen(up), reach)];
    let distance = axes.iter().map(|(seen, reach)| farthest(seen, *reach)).fold(1e-3 * radius, f32::max);
    let [x, y] = axes.map(|(seen, _)| centred(&seen, distance, radius));
    let eye = middle + x * right + y * up + distance * back;
    (eye, eye - distance * back)
}

/// Returns the minimum distance of an eye from which all points (x across the view, z towards the eye) are between
/// lines of slope `reach` through the eye.
fn farthest(seen: &[(f32, f32)], reach: f32) -> f32 {
    let most = seen.iter().map(|(x, z)| x + reach * z).fold(f32::MIN, f32::max);
    let least = seen.iter().map(|(x, z)| x - reach * z).fold(f32::MAX, f32::min);
    (most - least) / (2.0 * reach)
}

/// Returns the position of the eye across the view, at `distance`, that centres the points. Bisection: slopes fall with
/// the position.
fn centred(seen: &[(f32, f32)], distance: f32, radius: f32) -> f32 {
    let (mut low, mut high) = (-2.0 * radius, 2.0 * radius);
    for _ in 0..STEPS {
        let eye = 0.5 * (low + high);
        let slopes = seen.iter().map(|(x, z)| (x - eye) / (distance - z).max(1e-3 * radius));
        let (least, most) = slopes.fold((f32::MAX, f32::MIN), |(a, b), s| (a.min(s), b.max(s)));
        if least + most > 0.0 { low = eye } else { high = eye }
    }
    0.5 * (low + high)
}

fn mask(i: u32) -> glam::BVec3 {
    glam::BVec3::new(i & 1 != 0, i & 2 != 0, i & 4 != 0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;
    use rebounce_shared::camera::Camera;

    #[test]
    fn a_box_fills_the_picture_and_is_in_its_middle() {
        for i in 0..200 {
            let mut stream = Stream::new(7, i);
            let mut any = || Vec3::new(stream.unit(), stream.unit(), stream.unit());
            let low = 50.0 * (any() - 0.5);
            let high = low + 20.0 * any() * any() + 1e-3;
            let (eye, target) = view(low, high);
            let position = eye.as_dvec3().to_array();
            let target = target.as_dvec3().to_array();
            let frame = Camera { position, target, up: [0.0, 1.0, 0.0], yfov_deg: YFOV_DEG }.frame([0.0; 3]);
            let project = |p: Vec3| {
                let (to, t) = (p - eye, frame.tan_half_yfov);
                [to.dot(frame.right), to.dot(frame.up)].map(|x| x / (t * to.dot(frame.forward)))
            };
            let places: Vec<[f32; 2]> = (0..8).map(|i| project(Vec3::select(mask(i), high, low))).collect();
            let ends = [0, 1].map(|axis| {
                let along = places.iter().map(|p| p[axis]);
                (along.clone().fold(f32::MAX, f32::min), along.fold(f32::MIN, f32::max))
            });
            let most =
                ends.iter().zip([WIDE, 1.0]).map(|((a, b), wide)| b.max(-a) / wide).fold(0.0, f32::max);
            assert!((most - FILLED).abs() < 0.02, "{ends:?}");
            assert!(ends.iter().all(|(a, b)| (a + b).abs() < 0.05), "{ends:?}");
            assert!(eye.y > high.y.min(0.5 * (low.y + high.y)), "from above");
        }
    }
}
