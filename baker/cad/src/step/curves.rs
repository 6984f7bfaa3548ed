//! Points, placements and curves.

use super::file::{File, broken, spoken};
use super::units::Units;
use super::{Flaw, Read};
use crate::curve::Curve;
use crate::frame::Frame;
use glam::DVec3;

/// Nesting of curves and surfaces that refer to others.
pub(super) const DEEPEST: usize = 16;

/// Curves that this module reads.
pub(super) const CURVES: [&str; 16] = [
    "SEAM_CURVE",
    "INTERSECTION_CURVE",
    "SURFACE_CURVE",
    "TRIMMED_CURVE",
    "COMPOSITE_CURVE",
    "LINE",
    "CIRCLE",
    "ELLIPSE",
    "HYPERBOLA",
    "PARABOLA",
    "POLYLINE",
    "B_SPLINE_CURVE_WITH_KNOTS",
    "UNIFORM_CURVE",
    "QUASI_UNIFORM_CURVE",
    "BEZIER_CURVE",
    "PCURVE",
];

/// Reads geometry in one representation's units.
#[derive(Clone, Copy)]
pub(super) struct Geometry<'a> {
    /// The records.
    pub file: &'a File,
    /// Units of the representation.
    pub units: Units,
}

impl Geometry<'_> {
    /// A cartesian point, metres; in a parameter plane z is 0.
    pub fn point(&self, id: u64) -> Read<DVec3> {
        let place = self.units.length * self.triple(id, "CARTESIAN_POINT")?;
        if place.is_finite() { Ok(place) } else { Err(broken(id)) }
    }

    /// A direction, not always of unit length.
    pub fn direction(&self, id: u64) -> Read<DVec3> {
        self.triple(id, "DIRECTION")
    }

    fn triple(&self, id: u64, kind: &str) -> Read<DVec3> {
        let values = self.file.expect(id, kind)?.reals(1)?;
        match values[..] {
            [x, y] => Ok(DVec3::new(x, y, 0.0)),
            [x, y, z] => Ok(DVec3::new(x, y, z)),
            _ => Err(broken(id)),
        }
    }

    /// A placement: `axis2_placement_3d`, `axis2_placement_2d` or `axis1_placement`.
    pub fn frame(&self, id: u64) -> Read<Frame> {
        let direction = |id: Option<u64>| id.map(|id| self.direction(id)).transpose();
        if let Some(fields) = self.file.fields(id, "AXIS2_PLACEMENT_2D") {
            let origin = self.point(fields.reference(1)?)?;
            let x = direction(fields.optional_reference(2))?.unwrap_or(DVec3::X);
            return Frame::new(origin, DVec3::Z, x).ok_or_else(|| broken(id));
        }
        let axis1 = self.file.fields(id, "AXIS1_PLACEMENT");
        let fields = match axis1 {
            Some(fields) => fields,
            None => self.file.expect(id, "AXIS2_PLACEMENT_3D")?,
        };
        let origin = self.point(fields.reference(1)?)?;
        let axis = direction(fields.optional_reference(2))?.unwrap_or(DVec3::Z);
        let reference = direction(fields.optional_reference(3))?.unwrap_or(DVec3::X);
        let some_way_round = axis.try_normalize().map_or(DVec3::X, DVec3::any_orthonormal_vector);
        Frame::new(origin, axis, reference)
            .or_else(|| Frame::new(origin, axis, some_way_round))
            .ok_or_else(|| broken(id))
    }

    /// A vector: direction times magnitude, metres.
    pub fn vector(&self, id: u64) -> Read<DVec3> {
        let fields = self.file.expect(id, "VECTOR")?;
        let direction = self.direction(fields.reference(1)?)?.try_normalize().ok_or_else(|| broken(id))?;
        let vector = self.units.length * fields.real(2)? * direction;
        if vector == DVec3::ZERO || !vector.is_finite() { Err(broken(id)) } else { Ok(vector) }
    }

    /// A length above zero, metres.
    pub fn length(&self, id: u64, value: f64) -> Read<f64> {
        let length = self.units.length * value;
        if length > 0.0 && length.is_finite() { Ok(length) } else { Err(broken(id)) }
    }

    /// A curve, untrimmed: of a trimmed curve its basis, of a surface curve the curve in space.
    pub fn curve(&self, id: u64) -> Read<Curve> {
        self.nested_curve(id, 0)
    }

    fn nested_curve(&self, id: u64, depth: usize) -> Read<Curve> {
        if depth > DEEPEST {
            return Err(Flaw::UnreadAt(id, "curves are nested too deep".into()));
        }
        let kind = self.file.kind(id, &CURVES)?;
        let fields = self.file.expect(id, kind)?;
        match kind {
            "SURFACE_CURVE" | "SEAM_CURVE" | "INTERSECTION_CURVE" => {
                self.nested_curve(fields.reference(1)?, depth + 1)
            }
            "TRIMMED_CURVE" => {
                let basis = self.nested_curve(fields.reference(1)?, depth + 1)?;
                Ok(if fields.flag(4) { basis } else { reversed(basis) })
            }
            "LINE" => Ok(Curve::Line {
                origin: self.point(fields.reference(1)?)?,
                direction: self.vector(fields.reference(2)?)?,
            }),
            "CIRCLE" => Ok(Curve::Circle {
                frame: self.frame(fields.reference(1)?)?,
                radius: self.length(id, fields.real(2)?)?,
            }),
            "ELLIPSE" | "HYPERBOLA" => {
                let frame = self.frame(fields.reference(1)?)?;
                let radii = [self.length(id, fields.real(2)?)?, self.length(id, fields.real(3)?)?];
                Ok(if kind == "ELLIPSE" {
                    Curve::Ellipse { frame, radii }
                } else {
                    Curve::Hyperbola { frame, radii }
                })
            }
            "PARABOLA" => Ok(Curve::Parabola {
                frame: self.frame(fields.reference(1)?)?,
                focal_distance: self.length(id, fields.real(2)?)?,
            }),
            "POLYLINE" => {
                let places = fields.references(1)?.into_iter().map(|id| self.point(id));
                self.polyline(id, places.collect::<Read<_>>()?)
            }
            "B_SPLINE_CURVE_WITH_KNOTS" | "UNIFORM_CURVE" | "QUASI_UNIFORM_CURVE" | "BEZIER_CURVE" => {
                self.spline_curve(id, kind)
            }
            _ => Err(Flaw::Unread(format!("{}s are not read as edges", spoken(kind)))),
        }
    }
}

/// The same curve run the other way.
fn reversed(curve: Curve) -> Curve {
    let turned = |frame: Frame| Frame { y: -frame.y, z: -frame.z, ..frame };
    match curve {
        Curve::Line { origin, direction } => Curve::Line { origin, direction: -direction },
        Curve::Circle { frame, radius } => Curve::Circle { frame: turned(frame), radius },
        Curve::Ellipse { frame, radii } => Curve::Ellipse { frame: turned(frame), radii },
        Curve::Hyperbola { frame, radii } => Curve::Hyperbola { frame: turned(frame), radii },
        Curve::Parabola { frame, focal_distance } => Curve::Parabola { frame: turned(frame), focal_distance },
        Curve::Nurbs(mut nurbs) => {
            nurbs.poles.reverse();
            nurbs.weights.reverse();
            nurbs.knots.reverse();
            nurbs.knots.iter_mut().for_each(|knot| *knot = -*knot);
            Curve::Nurbs(nurbs)
        }
    }
}
