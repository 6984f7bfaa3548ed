//! Ray sort: rays of a gather batch are cast by octant, major axis and direction, so that
//! consecutive rays are coherent and fill [packets](crate::geometry::Primitives::intersect_packet).

use super::directions::{LANES, Lanes};
use crate::geometry::Ray;

/// Direction cells of a [class](Ray::octant_and_axis) along each of two axes; a cell coordinate has
/// three bits.
const GRID: u32 = 8;
/// Total number of cells.
const CELLS: usize = Ray::OCTANTS_AND_AXES * (GRID * GRID) as usize;

/// Replaces `order` by the ray numbers sorted by cell ([`cells`]): by class, and along a Morton
/// curve within a class. The sort is stable.
pub fn sort(cells: &[u16], order: &mut Vec<u32>) {
    let mut ends = [0u32; CELLS];
    cells.iter().for_each(|cell| ends[*cell as usize] += 1);
    let mut next = 0;
    for end in &mut ends {
        let count = std::mem::replace(end, next);
        next += count;
    }
    order.clear();
    order.resize(cells.len(), 0);
    for (number, cell) in (0..).zip(cells) {
        let place = &mut ends[*cell as usize];
        order[*place as usize] = number;
        *place += 1;
    }
}

/// Returns the cells of directions, given by axis: the direction's position on a face of a cube. A
/// [class](Ray::octant_and_axis) covers a quarter of a face.
#[inline(always)]
pub fn cells([x, y, z]: &[Lanes; 3]) -> [u16; LANES] {
    let mut cells = [0; LANES];
    for i in 0..LANES {
        let (x, y, z) = (x[i], y[i], z[i]);
        let (sx, sy, sz) = (x.abs(), y.abs(), z.abs());
        // As Ray::major_axis, without branches; the other two components are no longer than the
        // major one.
        let (is_x, is_y) = (sx > sy && sx > sz, sy > sz);
        let (main, u, v) = if is_x {
            (sx, sy, sz)
        } else if is_y {
            (sy, sz, sx)
        } else {
            (sz, sx, sy)
        };
        let axis = if is_x {
            0
        } else if is_y {
            1
        } else {
            2
        };
        let down = |of: f32| of.to_bits() >> 31;
        let class = axis << 3 | down(z) << 2 | down(y) << 1 | down(x);
        let scale = GRID as f32 / main;
        let spread = |along: f32| {
            let along = ((along * scale) as i32).min(GRID as i32 - 1) as u32;
            along & 1 | (along & 2) << 1 | (along & 4) << 2
        };
        cells[i] = (class * GRID * GRID + (spread(u) | spread(v) << 1)) as u16;
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;
    use glam::Vec3;

    #[test]
    fn rays_that_go_alike_are_cast_together_and_in_their_order() {
        let mut stream = Stream::new(5, 0);
        let directions: Vec<Vec3> = (0..5_000).map(|_| stream.sphere()).collect();
        let cells: Vec<u16> = directions
            .chunks(LANES)
            .flat_map(|some| {
                let axis = |axis: usize| std::array::from_fn(|i| some[i][axis]);
                cells(&[axis(0), axis(1), axis(2)])
            })
            .collect();
        for (cell, direction) in cells.iter().zip(&directions) {
            assert_eq!(*cell as u32 / (GRID * GRID), Ray::octant_and_axis(*direction) as u32);
        }
        let mut order = Vec::new();
        for some in [&cells[..0], &cells[..1], &cells] {
            sort(some, &mut order);
            assert_eq!(order.len(), some.len());
            let mut far = 0;
            for pair in order.windows(2) {
                let key = |ray: u32| (some[ray as usize], ray);
                assert!(key(pair[0]) < key(pair[1]));
                let direction = |ray: u32| directions[ray as usize];
                far += (direction(pair[0]).dot(direction(pair[1])) < 0.8) as usize;
            }
            // The curve over the sphere has few jumps.
            assert!(far * 20 <= order.len(), "{far}");
        }
    }
}
