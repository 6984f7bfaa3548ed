//! Grids of the unit square on surfaces, by their natural parameters and by the virtual mesh, as lines of numbers for
//! `cargo xtask plot-jacobian`:
//!
//! `surface NAME`, then twice `map NAME DEVIATION` and for each cell of the grid `cell JACOBIAN X Y Z X Y Z X Y Z X Y Z`: its
//! Jacobian in the middle, and its corners around it. Jacobians are in multiples of their mean, and DEVIATION is how far from 1 they
//! are at most.

use glam::{DVec2, DVec3};
use rebounce_cad::face::Face;
use rebounce_cad::frame::Frame;
use rebounce_cad::surface::{NurbsSurface, Surface};
use rebounce_cad::trim::TrimEdge;
use rebounce_cad::virtual_mesh::VirtualMesh;
use std::error::Error;
use std::f64::consts::TAU;

/// Cells along each side of the grid.
const CELLS: u32 = 16;
/// Samples of the Jacobian along each side of a cell.
const SAMPLES: u32 = 8;
/// Step of differences, in the unit square.
const STEP: f64 = 1e-5;

fn main() -> Result<(), Box<dyn Error>> {
    let frame = Frame::default();
    let cone = Surface::Cone { frame, radius: 0.0, half_angle: 0.5 };
    print("cone", &cone, [DVec2::new(0.0, 0.3), DVec2::new(TAU, 1.8)])?;
    let torus = Surface::Torus { frame, major: 1.0, minor: 0.5 };
    print("torus", &torus, [DVec2::ZERO, DVec2::splat(TAU)])?;
    print("NURBS surface", &Surface::Nurbs(sail()?), [DVec2::ZERO, DVec2::ONE])
}

/// A bicubic rational surface, narrow on one side and wide on the other.
fn sail() -> Result<NurbsSurface, Box<dyn Error>> {
    let ends = [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0].to_vec();
    let (mut poles, mut weights) = (Vec::new(), Vec::new());
    for i in 0..4 {
        for j in 0..4 {
            let [x, y] = [f64::from(i) / 3.0, f64::from(j) / 3.0];
            let wide = 0.4 + 1.4 * x * x;
            let bulge = if (1..3).contains(&i) && (1..3).contains(&j) { 1.1 } else { 0.0 };
            poles.push(DVec3::new(2.2 * x.powf(1.4), wide * (y - 0.5) * 1.6, bulge - 0.5 * x * y));
            weights.push(if (1..3).contains(&j) { 2.0 } else { 1.0 });
        }
    }
    Ok(NurbsSurface::new([3, 3], [ends.clone(), ends], [4, 4], poles, weights)?)
}

/// Prints the part of a surface between two corners of its parameters.
fn print(name: &str, surface: &Surface, [low, high]: [DVec2; 2]) -> Result<(), Box<dyn Error>> {
    let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
    let edge = |i: usize| TrimEdge::Segment { from: corners[i], to: corners[(i + 1) % 4] };
    let loops = vec![(0..4).map(edge).collect()];
    let mesh = VirtualMesh::new(&Face { surface: surface.clone(), is_reversed: false, loops })?;
    println!("surface {name}");
    print_map("natural parameters", |at| surface.point(low + at * (high - low)));
    print_map("virtual mesh", |at| mesh.point(at));
    Ok(())
}

/// Prints a map of the unit square to a surface.
fn print_map(name: &str, point: impl Fn(DVec2) -> DVec3) {
    let jacobian = |at: DVec2| {
        let along = |axis: DVec2| (point(at + STEP * axis) - point(at - STEP * axis)) / (2.0 * STEP);
        along(DVec2::X).cross(along(DVec2::Y)).length()
    };
    let grid = |side: u32| {
        let cells = (0..side * side).map(move |i| DVec2::new(f64::from(i % side), f64::from(i / side)));
        cells.map(move |cell| (cell + 0.5) / f64::from(side))
    };
    let all: Vec<f64> = grid(CELLS * SAMPLES).map(jacobian).collect();
    let mean = all.iter().sum::<f64>() / all.len() as f64;
    let deviation = all.iter().map(|one| (one / mean - 1.0).abs()).fold(0.0, f64::max);
    println!("map {name} {deviation}");
    for middle in grid(CELLS) {
        let half = 0.5 / f64::from(CELLS);
        let corner = |x: f64, y: f64| point(middle + half * DVec2::new(x, y));
        let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        let numbers: Vec<String> =
            corners.iter().flat_map(|c| c.to_array()).map(|x| format!("{x:.4}")).collect();
        println!("cell {:.3} {}", jacobian(middle) / mean, numbers.join(" "));
    }
}
