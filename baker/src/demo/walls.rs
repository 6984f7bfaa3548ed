//! Walls with openings, and the frames of windows.

use super::block;
use crate::scene::world_mesh::WorldMesh;
use glam::dvec3;

/// A hole in a wall: start and end along the wall, lower and upper height.
pub(super) type Hole = [f64; 4];

/// A wall along an axis (0: x, 2: z), `thick` from one side to the other. Holes in ascending order.
pub(super) fn wall(
    mesh: &mut WorldMesh,
    axis: usize,
    thick: [f64; 2],
    ends: [f64; 2],
    heights: [f64; 2],
    holes: &[Hole],
    material: u32,
) {
    let mut piece = |along: [f64; 2], heights: [f64; 2]| {
        if along[1] > along[0] && heights[1] > heights[0] {
            slab(mesh, axis, along, heights, thick, material);
        }
    };
    let [foot, top] = heights;
    let mut at = ends[0];
    for &[from, to, sill, head] in holes {
        piece([at, from], heights);
        piece([from, to], [foot, sill]);
        piece([from, to], [head, top]);
        at = to;
    }
    piece([at, ends[1]], heights);
}

/// A box whose length runs along x (0) or z (2).
pub(super) fn slab(
    mesh: &mut WorldMesh,
    axis: usize,
    along: [f64; 2],
    heights: [f64; 2],
    thick: [f64; 2],
    material: u32,
) {
    let corner = |k: usize| match axis {
        0 => dvec3(along[k], heights[k], thick[k]),
        _ => dvec3(thick[k], heights[k], along[k]),
    };
    block(mesh, corner(0), corner(1), material);
}

/// Frame and upright bars of a window of so many panes, its middle plane at `at`. The panes are open: clear glass lets
/// all light through, and nothing here reflects like a mirror.
pub(super) fn window(
    mesh: &mut WorldMesh,
    axis: usize,
    at: f64,
    &[from, to, sill, head]: &Hole,
    panes: usize,
    material: u32,
) {
    const BAR: f64 = 0.05;
    let thick = [at - 0.03, at + 0.03];
    for k in 0..=panes {
        let x = from + (to - from - BAR) * k as f64 / panes as f64;
        slab(mesh, axis, [x, x + BAR], [sill + BAR, head - BAR], thick, material);
    }
    for y in [sill, head - BAR] {
        slab(mesh, axis, [from, to], [y, y + BAR], thick, material);
    }
}
