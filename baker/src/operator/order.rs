//! The order in which rays are cast: by their directions, so that those that go alike can [walk
//! together](crate::surface::Pieces::find_all).

use crate::surface::Ray;
use glam::Vec3;

/// Cells of directions of one [class](Ray::class) along each of two axes: a power of two.
const GRID: u32 = 8;
/// Cells in all.
const CELLS: usize = Ray::CLASSES * (GRID * GRID) as usize;

/// Replaces `order` by the rays' numbers in the order of their directions: class by class, in each along a Morton curve;
/// rays of one cell keep their order. `cells` is working memory.
pub fn sort(rays: &[(Ray, u32)], order: &mut Vec<u32>, cells: &mut Vec<u16>) {
    cells.clear();
    cells.extend(rays.iter().map(|(ray, _)| cell(ray.direction)));
    let mut ends = [0u32; CELLS];
    cells.iter().for_each(|cell| ends[*cell as usize] += 1);
    let mut next = 0;
    for end in &mut ends {
        let count = std::mem::replace(end, next);
        next += count;
    }
    order.clear();
    order.resize(rays.len(), 0);
    for (number, cell) in (0..).zip(cells) {
        let place = &mut ends[*cell as usize];
        order[*place as usize] = number;
        *place += 1;
    }
}

/// The cell of a direction: where it goes through a cube's side, of which a class has a quarter.
#[inline]
fn cell(direction: Vec3) -> u16 {
    let class = Ray::class(direction) as u32;
    let size = direction.abs().to_array();
    let main = (class >> 3) as usize;
    // Those of the other axes are no longer.
    let [u, v] = [(main + 1) % 3, (main + 2) % 3].map(|axis| size[axis]);
    let scale = GRID as f32 / size[main];
    let spread = |x: f32| {
        let x = (x as u32).min(GRID - 1);
        let x = (x | x << 4) & 0x0f0f;
        let x = (x | x << 2) & 0x3333;
        (x | x << 1) & 0x5555
    };
    (class * GRID * GRID + (spread(u * scale) | spread(v * scale) << 1)) as u16
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    #[test]
    fn rays_that_go_alike_are_cast_together_and_in_their_order() {
        let mut stream = Stream::new(5, 0);
        let rays: Vec<(Ray, u32)> = (0..5_000)
            .map(|i| {
                let direction = stream.sphere();
                (Ray { origin: Vec3::ZERO, direction, max_distance: f32::INFINITY, spread: 0.0 }, i)
            })
            .collect();
        let (mut order, mut cells) = (Vec::new(), Vec::new());
        for some in [&rays[..0], &rays[..1], &rays] {
            sort(some, &mut order, &mut cells);
            assert_eq!(order.len(), some.len());
            let direction = |ray: u32| some[ray as usize].0.direction;
            let mut far = 0;
            for pair in order.windows(2) {
                let key = |ray: u32| (cell(direction(ray)), ray);
                assert!(key(pair[0]) < key(pair[1]));
                far += (direction(pair[0]).dot(direction(pair[1])) < 0.8) as usize;
            }
            // The curve over the sphere has few jumps.
            assert!(far * 20 <= order.len(), "{far}");
        }
    }
}
