//! The works: paintings, a sculpture on a plinth, a ring of neon, a screen.

use super::super::block;
use super::super::walls::slab;
use super::{DARK, Finish, HALL};
use crate::scene::world_mesh::WorldMesh;
use glam::{DVec3, dvec3};
use rebounce_shared::elementary::Elementary;
use std::f64::consts::TAU;

/// Depth of a canvas before its wall, and of the layers of paint upon it.
const DEPTH: f64 = 0.045;
const PAINT: f64 = 0.003;

/// A painting of the south wall.
#[derive(Clone, Copy)]
pub(super) struct Painting {
    /// Name of its spot.
    pub name: &'static str,
    /// Its middle.
    pub x: f64,
    pub height: f64,
}

/// The paintings of the south wall, which have spots.
pub(super) const SOUTH: [Painting; 3] = [
    Painting { name: "Spot: colour field", x: 2.4, height: 1.7 },
    Painting { name: "Spot: squares", x: 6.0, height: 1.65 },
    Painting { name: "Spot: grid", x: 9.6, height: 1.7 },
];

pub(super) fn add(mesh: &mut WorldMesh) {
    let south = |painting: Painting| Canvas {
        axis: 0,
        wall: HALL.z,
        out: -1.0,
        along: painting.x,
        height: painting.height,
    };
    let north = |along, height| Canvas { axis: 0, wall: 0.0, out: 1.0, along, height };
    let east = |along, height| Canvas { axis: 2, wall: HALL.x, out: -1.0, along, height };
    let west = |along, height| Canvas { axis: 2, wall: 0.0, out: 1.0, along, height };
    let [field, squares, grid] = SOUTH.map(south);
    colour_field(mesh, field, [1.8, 2.3], [Finish::Red, Finish::Orange, Finish::Yellow, Finish::Red]);
    nested_squares(mesh, squares);
    primary_grid(mesh, grid);
    stripes(mesh, north(2.2, 1.6));
    hard_edges(mesh, north(9.7, 1.6));
    colour_field(
        mesh,
        east(2.3, 1.75),
        [1.7, 2.4],
        [Finish::Navy, Finish::Blue, Finish::Green, Finish::Navy],
    );
    colour_field(
        mesh,
        west(3.6, 1.65),
        [1.9, 1.5],
        [Finish::Sand, Finish::Pink, Finish::Canvas, Finish::Orange],
    );
    sculpture(mesh, dvec3(7.4, 0.0, 2.1));
    neon(mesh, dvec3(5.9, 1.65, 0.12));
    screen(mesh);
}

/// A place on a wall that a painting hangs at.
#[derive(Clone, Copy)]
struct Canvas {
    /// Axis that the wall runs along: 0, x; 2, z.
    axis: usize,
    /// Where the wall's face is on the other axis, and which way the painting looks there.
    wall: f64,
    out: f64,
    /// The painting's middle along the wall, and its height.
    along: f64,
    height: f64,
}

impl Canvas {
    /// A rectangle of one colour, seen by who stands before it: its least and greatest place to the right and upwards of
    /// the middle, and the layer of paint (0: the canvas).
    fn rectangle(
        self,
        mesh: &mut WorldMesh,
        [left, right]: [f64; 2],
        [low, high]: [f64; 2],
        layer: usize,
        is: Finish,
    ) {
        let top = DEPTH + PAINT * layer as f64;
        let bottom = if layer == 0 { 0.0 } else { top - PAINT };
        let [a, b] = [bottom, top].map(|depth| self.wall + self.out * depth);
        let [from, to] = if self.right() < 0.0 { [-right, -left] } else { [left, right] };
        let [along, heights] =
            [[self.along + from, self.along + to], [self.height + low, self.height + high]];
        slab(mesh, self.axis, along, heights, [a.min(b), a.max(b)], is as u32);
    }

    /// A rectangle without thickness on the canvas: of a picture that shines, as what lies behind it lights nothing.
    fn face(self, mesh: &mut WorldMesh, across: [f64; 2], upwards: [f64; 2], is: Finish) {
        let depth = self.wall + self.out * (DEPTH + PAINT);
        let corner = |x: usize, y: usize| {
            let [along, y] = [self.along + self.right() * across[x], self.height + upwards[y]];
            if self.axis == 0 { dvec3(along, y, depth) } else { dvec3(depth, y, along) }
        };
        mesh.quad([corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)], is as u32);
    }

    /// Which way along the wall is to the right: greater x for who looks north, greater z for who looks east.
    fn right(self) -> f64 {
        if (self.axis == 0) == (self.out < 0.0) { -1.0 } else { 1.0 }
    }

    /// The canvas, `[width, height]`, all of one colour.
    fn ground(self, mesh: &mut WorldMesh, [width, height]: [f64; 2], is: Finish) {
        self.rectangle(mesh, [-0.5 * width, 0.5 * width], [-0.5 * height, 0.5 * height], 0, is);
    }
}

/// Three soft rectangles above each other on a ground: the colours from the top, then the ground's.
fn colour_field(
    mesh: &mut WorldMesh,
    at: Canvas,
    [width, height]: [f64; 2],
    [top, middle, low, ground]: [Finish; 4],
) {
    at.ground(mesh, [width, height], ground);
    let half = 0.5 * width - 0.08;
    for ([from, to], is) in [([0.64, 0.96], top), ([0.27, 0.61], middle), ([0.04, 0.24], low)] {
        let heights = [from, to].map(|share| (share - 0.5) * height);
        at.rectangle(mesh, [-half, half], heights, 1, is);
    }
}

/// Squares within squares, nearer to the lower edge.
fn nested_squares(mesh: &mut WorldMesh, at: Canvas) {
    const SIDE: f64 = 2.0;
    at.ground(mesh, [SIDE, SIDE], Finish::Yellow);
    for (layer, (share, is)) in
        [(0.78, Finish::Orange), (0.56, Finish::Pink), (0.34, Finish::Red)].into_iter().enumerate()
    {
        let half = 0.5 * share * SIDE;
        let low = 0.12 * (1.0 - share) * SIDE - 0.5 * SIDE;
        at.rectangle(mesh, [-half, half], [low, low + 2.0 * half], layer + 1, is);
    }
}

/// A grid of black bars with fields of primary colours.
fn primary_grid(mesh: &mut WorldMesh, at: Canvas) {
    const BAR: f64 = 0.045;
    const UPRIGHT: [f64; 5] = [-0.9, -0.35, 0.4, 0.72, 0.9];
    const LEVEL: [f64; 5] = [-1.1, -0.62, 0.1, 0.78, 1.1];
    at.ground(mesh, [1.8, 2.2], Finish::Canvas);
    let mut field = |x: usize, y: usize, is: Finish| {
        at.rectangle(mesh, [UPRIGHT[x], UPRIGHT[x + 1]], [LEVEL[y], LEVEL[y + 1]], 1, is);
    };
    field(1, 1, Finish::Red);
    field(0, 0, Finish::Blue);
    field(3, 2, Finish::Blue);
    field(2, 3, Finish::Yellow);
    field(3, 0, Finish::Yellow);
    for x in &UPRIGHT[1..4] {
        at.rectangle(mesh, [x - 0.5 * BAR, x + 0.5 * BAR], [-1.1, 1.1], 2, Finish::Ink);
    }
    for y in &LEVEL[1..4] {
        at.rectangle(mesh, [-0.9, 0.9], [y - 0.5 * BAR, y + 0.5 * BAR], 3, Finish::Ink);
    }
}

/// Upright stripes of uneven width.
fn stripes(mesh: &mut WorldMesh, at: Canvas) {
    const HALF: f64 = 1.2;
    let colours = [
        Finish::Navy,
        Finish::Canvas,
        Finish::Blue,
        Finish::Green,
        Finish::Canvas,
        Finish::Yellow,
        Finish::Orange,
        Finish::Pink,
    ];
    at.ground(mesh, [2.0 * HALF, 1.5], Finish::Canvas);
    let mut left = -HALF;
    let mut number = 0;
    while left < HALF {
        let right = (left + 0.06 + 0.035 * ((number * 7) % 5) as f64).min(HALF);
        at.rectangle(mesh, [left, right], [-0.75, 0.75], 1, colours[(number * 3) % colours.len()]);
        (left, number) = (right, number + 1);
    }
}

/// Large fields with hard edges.
fn hard_edges(mesh: &mut WorldMesh, at: Canvas) {
    at.ground(mesh, [2.2, 1.6], Finish::Pink);
    at.rectangle(mesh, [-1.1, 0.25], [-0.8, -0.1], 1, Finish::Green);
    at.rectangle(mesh, [0.25, 1.1], [-0.8, 0.35], 1, Finish::Navy);
    at.rectangle(mesh, [-0.75, -0.1], [-0.45, 0.5], 2, Finish::Orange);
}

/// A knot of red on a plinth: a tube along a trefoil.
fn sculpture(mesh: &mut WorldMesh, foot: DVec3) {
    const PLINTH: DVec3 = dvec3(0.36, 0.85, 0.36);
    const TUBE: f64 = 0.085;
    let (low, high) = (dvec3(-PLINTH.x, 0.0, -PLINTH.z), PLINTH);
    block(mesh, foot + low, foot + high, Finish::Wall as u32);
    let middle = foot + dvec3(0.0, PLINTH.y + 0.545, 0.0);
    let path = |t: f64| {
        let [a, b] = [TAU * t, 2.0 * TAU * t];
        let across = dvec3(a.sine() + 2.0 * b.sine(), a.cosine() - 2.0 * b.cosine(), -(1.5 * b).sine());
        middle + 0.155 * across
    };
    tube(mesh, path, TUBE, [120, 16], Finish::Red);
}

/// A ring of neon before the north wall, on small holders.
fn neon(mesh: &mut WorldMesh, middle: DVec3) {
    const RADIUS: f64 = 0.72;
    let at = |angle: f64| {
        let (sin, cos) = angle.sine_cosine();
        middle + RADIUS * dvec3(cos, sin, 0.0)
    };
    tube(mesh, |t| at(TAU * t), 0.022, [48, 8], Finish::Neon);
    for k in 0..4 {
        let holder = at(TAU * (f64::from(k) + 0.5) / 4.0);
        let low = dvec3(holder.x - 0.008, holder.y - 0.008, 0.0);
        block(mesh, low, dvec3(holder.x + 0.008, holder.y + 0.008, middle.z - 0.015), Finish::Steel as u32);
    }
}

/// A closed tube around a path that returns to its start at 1; `fine`: squares along and around it.
fn tube(mesh: &mut WorldMesh, path: impl Fn(f64) -> DVec3, radius: f64, fine: [usize; 2], is: Finish) {
    let along = |t: f64| (path(t + 1e-4) - path(t - 1e-4)).normalize_or_zero();
    let at = |u: f64, v: f64| {
        let forward = along(u);
        let side = forward.cross(DVec3::Z).normalize_or(DVec3::X);
        let (sin, cos) = (TAU * v).sine_cosine();
        let normal = cos * side + sin * forward.cross(side);
        (path(u) + radius * normal, normal)
    };
    mesh.sheet(fine, at, is as u32);
}

/// A screen on the dark room's east wall: blocks of colour, as if zoomed far in.
fn screen(mesh: &mut WorldMesh) {
    const SIZE: [f64; 2] = [3.6, 2.0];
    const CELLS: [usize; 2] = [9, 5];
    const COLOURS: [Finish; 5] =
        [Finish::Magenta, Finish::Violet, Finish::Azure, Finish::Cyan, Finish::Amber];
    let [[_, wall], [north, south]] = DARK;
    let at = Canvas { axis: 2, wall, out: -1.0, along: 0.5 * (north + south), height: 1.55 };
    at.ground(mesh, SIZE.map(|length| length + 0.06), Finish::Black);
    let cell = |k: usize, axis: usize| SIZE[axis] * (k as f64 / CELLS[axis] as f64 - 0.5);
    for row in 0..CELLS[1] {
        for column in 0..CELLS[0] {
            let wave = (0.9 * column as f64).sine() + (1.3 * row as f64 + 0.5 * column as f64).cosine();
            let is = COLOURS[((wave + 2.0) * 1.25) as usize % COLOURS.len()];
            let [x, y] = [[column, column + 1].map(|k| cell(k, 0)), [row, row + 1].map(|k| cell(k, 1))];
            at.face(mesh, x, y, is);
        }
    }
}
