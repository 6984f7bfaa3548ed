//! B-spline curves and surfaces: with knots, uniform, quasi-uniform, Bézier; rational or not.

use super::curves::Geometry;
use super::file::{Fields, broken};
use super::{Flaw, Read};
use crate::basis::MAX_DEGREE;
use crate::curve::{Curve, NurbsCurve};
use crate::surface::{NurbsSurface, Surface};
use glam::DVec3;

/// Weights of control points, if they are given.
type Weights<T> = Option<Vec<T>>;

/// Reads `#1 = NAME('', …)` and `#1 = (… B_SPLINE_CURVE(…) NAME(…) RATIONAL_B_SPLINE_CURVE(…) …)` alike.
struct Parts<'a> {
    /// Attributes of the B-spline, from the first of its own on at `at`.
    basis: Fields<'a>,
    at: usize,
    /// Multiplicities and knots, from the first on at `knots_at`.
    knots: Fields<'a>,
    knots_at: usize,
    weights: Option<Fields<'a>>,
}

impl Geometry<'_> {
    /// A B-spline curve of this kind.
    pub fn spline_curve(&self, id: u64, kind: &str) -> Read<Curve> {
        let parts = self.parts(id, kind, "B_SPLINE_CURVE", 5)?;
        let degree = self.degree(id, parts.basis.count(parts.at)?)?;
        let poles = parts.basis.references(parts.at + 1)?;
        self.file.spend(poles.len())?;
        let poles = poles.into_iter().map(|id| self.point(id)).collect::<Read<Vec<_>>>()?;
        let knots = match kind {
            "B_SPLINE_CURVE_WITH_KNOTS" => {
                let counts = parts.knots.counts(parts.knots_at)?;
                let values = parts.knots.reals(parts.knots_at + 1)?;
                written_out(id, &counts, &values, poles.len() + degree + 1)?
            }
            _ => regular(id, kind, degree, poles.len())?,
        };
        let weights: Weights<f64> = parts.weights.map(|fields| fields.reals(0)).transpose()?;
        let weights = weights.unwrap_or_else(|| vec![1.0; poles.len()]);
        nurbs_curve(id, degree, knots, poles, weights)
    }

    /// A polyline as a B-spline of degree 1; equal neighbours count once.
    pub fn polyline(&self, id: u64, mut places: Vec<DVec3>) -> Read<Curve> {
        places.dedup();
        self.file.spend(places.len())?;
        let count = places.len();
        if count < 2 {
            return Err(broken(id));
        }
        let knots = std::iter::once(0.0).chain((0..count).map(|at| at as f64)).chain([(count - 1) as f64]);
        nurbs_curve(id, 1, knots.collect(), places, vec![1.0; count])
    }

    /// A B-spline surface of this kind.
    pub fn spline_surface(&self, id: u64, kind: &str) -> Read<Surface> {
        let parts = self.parts(id, kind, "B_SPLINE_SURFACE", 7)?;
        let degrees = [0, 1].map(|axis| parts.basis.count(parts.at + axis));
        let [u, v] = degrees;
        let degrees = [self.degree(id, u?)?, self.degree(id, v?)?];
        let rows = parts.basis.reference_rows(parts.at + 2)?;
        let counts = [rows.len(), rows.first().map_or(0, Vec::len)];
        if rows.iter().any(|row| row.len() != counts[1]) {
            return Err(broken(id));
        }
        self.file.spend(counts[0] * counts[1])?;
        let poles = rows.into_iter().flatten().map(|id| self.point(id)).collect::<Read<Vec<_>>>()?;
        let knots = |axis: usize| match kind {
            "B_SPLINE_SURFACE_WITH_KNOTS" => {
                let multiplicities = parts.knots.counts(parts.knots_at + axis)?;
                let values = parts.knots.reals(parts.knots_at + 2 + axis)?;
                written_out(id, &multiplicities, &values, counts[axis] + degrees[axis] + 1)
            }
            _ => regular(id, &kind.replace("SURFACE", "CURVE"), degrees[axis], counts[axis]),
        };
        let knots = [knots(0)?, knots(1)?];
        let weights = match parts.weights {
            Some(fields) => fields.real_rows(0)?.concat(),
            None => vec![1.0; poles.len()],
        };
        let surface = NurbsSurface::new(degrees, knots, counts, poles, weights);
        surface
            .map(Surface::Nurbs)
            .map_err(|error| Flaw::UnreadAt(id, format!("a B-spline surface is wrong: {error}")))
    }

    fn parts(&self, id: u64, kind: &str, basis: &str, own: usize) -> Read<Parts<'_>> {
        let whole = self.file.own_fields(id, basis);
        let rational = format!("RATIONAL_{basis}");
        let weights = self.file.own_fields(id, &rational);
        let fields = || self.file.own_fields(id, kind).or_else(|| self.file.fields(id, kind));
        let own_kind = fields().ok_or_else(|| broken(id))?;
        Ok(match whole {
            Some(basis) => Parts { basis, at: 0, knots: own_kind, knots_at: 0, weights },
            None => Parts {
                basis: self.file.expect(id, kind)?,
                at: 1,
                knots: own_kind,
                knots_at: 1 + own,
                weights,
            },
        })
    }

    fn degree(&self, id: u64, degree: usize) -> Read<usize> {
        if (1..=MAX_DEGREE).contains(&degree) {
            Ok(degree)
        } else {
            Err(Flaw::UnreadAt(id, format!("B-splines of degree {degree} are not read")))
        }
    }
}

fn nurbs_curve(id: u64, degree: usize, knots: Vec<f64>, poles: Vec<DVec3>, weights: Vec<f64>) -> Read<Curve> {
    let curve = NurbsCurve::new(degree, knots, poles, weights);
    curve.map(Curve::Nurbs).map_err(|error| Flaw::UnreadAt(id, format!("a B-spline curve is wrong: {error}")))
}

/// Knots with their multiplicities written out.
fn written_out(id: u64, counts: &[usize], knots: &[f64], expected: usize) -> Read<Vec<f64>> {
    let total = counts.iter().try_fold(0_usize, |sum, count| sum.checked_add(*count));
    if counts.len() != knots.len() || total != Some(expected) {
        return Err(broken(id));
    }
    Ok(counts.iter().zip(knots).flat_map(|(count, knot)| std::iter::repeat_n(*knot, *count)).collect())
}

/// Knots of a uniform, quasi-uniform or piecewise Bézier curve (ISO 10303-42).
fn regular(id: u64, kind: &str, degree: usize, poles: usize) -> Read<Vec<f64>> {
    if poles <= degree {
        return Err(broken(id));
    }
    let total = poles + degree + 1;
    Ok(match kind {
        "UNIFORM_CURVE" => (0..total).map(|at| at as f64 - degree as f64).collect(),
        "QUASI_UNIFORM_CURVE" => {
            (0..total).map(|at| at.clamp(degree, poles) as f64 - degree as f64).collect()
        }
        _ if (poles - 1).is_multiple_of(degree) => {
            let spans = (poles - 1) / degree;
            let knot = |at: usize| (at.saturating_sub(1) / degree).min(spans) as f64;
            (0..total).map(knot).collect()
        }
        _ => return Err(broken(id)),
    })
}
