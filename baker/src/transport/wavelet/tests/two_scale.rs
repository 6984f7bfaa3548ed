//! Two-scale coefficients on surfaces, with inner products by the surface's own area (Alonso et al. 2001,
//! 5.2).

use super::*;
use crate::transport::wavelet::Order;
use crate::transport::wavelet::basis::{Basis, Coefficients, MOST};
use crate::transport::wavelet::cell::Cell;

/// Nodes from 0 to 1 and weights of the Gauss–Legendre rule of five nodes.
fn rule() -> [(f64, f64); 5] {
    let root = 2.0 * (10.0_f64 / 7.0).sqrt();
    let [near, far] = [(5.0 - root).sqrt() / 3.0, (5.0 + root).sqrt() / 3.0];
    let weight = |sign: f64| (322.0 + sign * 13.0 * 70.0_f64.sqrt()) / 900.0;
    let nodes = [(-far, weight(-1.0)), (-near, weight(1.0)), (0.0, 128.0 / 225.0)];
    let [a, b, c] = nodes;
    [a, b, c, (near, b.1), (far, a.1)].map(|(node, weight)| (0.5 + 0.5 * node, 0.5 * weight))
}

/// ∫ f dA over a cell, by the area element of the surface in differences; f takes points of the cell.
fn integral(mesh: &VirtualMesh, cell: Cell, f: impl Fn(DVec2) -> f64) -> f64 {
    let h = 1e-4;
    let mut sum = 0.0;
    for (x, of_x) in rule() {
        for (y, of_y) in rule() {
            let local = DVec2::new(x, y);
            let st = cell.at(local);
            let along = |axis: DVec2| (mesh.point(st + h * axis) - mesh.point(st - h * axis)) / (2.0 * h);
            let element = along(DVec2::X).cross(along(DVec2::Y)).length();
            sum += of_x * of_y * f(local) * element * cell.area();
        }
    }
    sum
}

#[test]
fn two_scale_coefficients_are_the_same_on_all_levels_of_all_surfaces() {
    let frame = Frame::new(DVec3::X, DVec3::new(0.2, 1.0, 0.3), DVec3::Z).unwrap();
    let patch = |high: DVec2| vec![rectangle(DVec2::ZERO, high)];
    let surfaces = [
        (Surface::Sphere { frame, radius: 1.4 }, DVec2::new(2.0, 1.3)),
        (Surface::Torus { frame, major: 1.5, minor: 0.8 }, DVec2::new(2.0, 4.0)),
        (Surface::Cone { frame, radius: 0.1, half_angle: 0.7 }, DVec2::new(2.0, 2.0)),
    ];
    let basis = Basis::new(Order::M3);
    for (surface, high) in surfaces {
        let mesh = patch_of(surface, false, patch(high)).mesh;
        let whole = mesh.area();
        for cell in [
            Cell::ROOT,
            Cell::ROOT.child(2),
            Cell::ROOT.child(1).child(2),
            Cell::ROOT.child(3).child(0).child(1),
        ] {
            for quadrant in 0..4 {
                let child = cell.child(quadrant);
                let area = whole * child.area();
                let corner = DVec2::new((quadrant % 2) as f64, (quadrant / 2) as f64);
                for a in [0, 1, 4, 5, 8] {
                    let mut unit: Coefficients = [DVec3::ZERO; MOST];
                    unit[a] = DVec3::ONE;
                    let pushed = basis.push(&unit, quadrant);
                    for b in [0, 1, 3, 5, 8] {
                        // g of Equation 4: the parent's function on the child, in the child's basis.
                        let product =
                            |local: DVec2| basis.values(0.5 * (local + corner))[a] * basis.values(local)[b];
                        let measured = integral(&mesh, child, product) / area;
                        assert!((measured - pushed[b].x).abs() < 1e-5, "{a} {b}: {measured} {}", pushed[b].x);
                    }
                }
                // Means alone need no quadrature of polynomials.
                let measured = integral(&mesh, child, |_| 1.0);
                assert!((measured / area - 1.0).abs() < 1e-6, "{measured} {area}");
            }
        }
    }
}
