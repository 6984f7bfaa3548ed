//! Surfaces.

use super::curves::{DEEPEST, Geometry};
use super::file::spoken;
use super::{Flaw, Read};
use crate::frame::Frame;
use crate::surface::Surface;
use glam::DVec2;
use std::f64::consts::FRAC_PI_2;

/// Surfaces that this module reads.
const SURFACES: [&str; 13] = [
    "PLANE",
    "CYLINDRICAL_SURFACE",
    "CONICAL_SURFACE",
    "SPHERICAL_SURFACE",
    "DEGENERATE_TOROIDAL_SURFACE",
    "TOROIDAL_SURFACE",
    "SURFACE_OF_REVOLUTION",
    "SURFACE_OF_LINEAR_EXTRUSION",
    "RECTANGULAR_TRIMMED_SURFACE",
    "B_SPLINE_SURFACE_WITH_KNOTS",
    "UNIFORM_SURFACE",
    "QUASI_UNIFORM_SURFACE",
    "BEZIER_SURFACE",
];

/// A surface of a file.
pub(super) struct Placed {
    /// It.
    pub surface: Surface,
    /// Whether its normal is against that of the surface in the file.
    pub is_flipped: bool,
    /// Numbers that pcurves may refer to it by.
    pub ids: Vec<u64>,
    /// From the file's parameters to those of `surface`.
    pub scale: DVec2,
    /// Where it is cut out of its basis by parameters.
    pub window: Option<[DVec2; 2]>,
}

impl Geometry<'_> {
    /// A surface.
    pub fn surface(&self, id: u64) -> Read<Placed> {
        self.nested_surface(id, 0)
    }

    fn nested_surface(&self, id: u64, depth: usize) -> Read<Placed> {
        if depth > DEEPEST {
            return Err(Flaw::UnreadAt(id, "surfaces are nested too deep".into()));
        }
        let kind = self.file.kind(id, &SURFACES)?;
        let unread = || Flaw::Unread(format!("{}s are not read", spoken(kind)));
        if !SURFACES.contains(&kind) {
            return Err(unread());
        }
        let fields = self.file.expect(id, kind).map_err(|_| unread())?;
        let frame = || self.frame(fields.reference(1)?);
        let (length, angle) = (self.units.length, self.units.angle);
        let mut scale = DVec2::ONE;
        let surface = match kind {
            "PLANE" => {
                scale = DVec2::splat(length);
                Surface::Plane(frame()?)
            }
            "CYLINDRICAL_SURFACE" => {
                scale = DVec2::new(angle, length);
                Surface::Cylinder { frame: frame()?, radius: self.length(id, fields.real(2)?)? }
            }
            "CONICAL_SURFACE" => {
                scale = DVec2::new(angle, length);
                let (radius, half_angle) = (length * fields.real(2)?, angle * fields.real(3)?);
                if !(radius >= 0.0 && radius.is_finite() && half_angle.abs() < FRAC_PI_2) || half_angle == 0.0
                {
                    return Err(Flaw::Unread("cones of no angle are not read".into()));
                }
                let Frame { origin, x, y, z } = frame()?;
                // A cone that narrows along its axis is turned about x: u and v change sign.
                let sign = half_angle.signum();
                scale *= sign;
                let frame = Frame { origin, x, y: sign * y, z: sign * z };
                Surface::Cone { frame, radius, half_angle: half_angle.abs() }
            }
            "SPHERICAL_SURFACE" => {
                scale = DVec2::splat(angle);
                Surface::Sphere { frame: frame()?, radius: self.length(id, fields.real(2)?)? }
            }
            "TOROIDAL_SURFACE" | "DEGENERATE_TOROIDAL_SURFACE" => {
                if kind == "DEGENERATE_TOROIDAL_SURFACE" && !fields.flag(4) {
                    return Err(Flaw::Unread("the inner parts of degenerate tori are not read".into()));
                }
                scale = DVec2::splat(angle);
                let (major, minor) = (fields.real(2)?, fields.real(3)?);
                Surface::Torus {
                    frame: frame()?,
                    major: self.length(id, major)?,
                    minor: self.length(id, minor)?,
                }
            }
            "SURFACE_OF_REVOLUTION" => {
                scale = DVec2::new(angle, 1.0);
                let profile = self.curve(fields.reference(1)?)?;
                Surface::Revolution { frame: self.frame(fields.reference(2)?)?, profile }
            }
            "SURFACE_OF_LINEAR_EXTRUSION" => {
                let profile = self.curve(fields.reference(1)?)?;
                Surface::Extrusion { profile, along: self.vector(fields.reference(2)?)? }
            }
            "RECTANGULAR_TRIMMED_SURFACE" => {
                let basis = fields.reference(1)?;
                let Placed { surface, is_flipped, mut ids, scale, .. } =
                    self.nested_surface(basis, depth + 1)?;
                ids.push(id);
                let corner =
                    |u: usize, v: usize| Ok::<_, Flaw>(scale * DVec2::new(fields.real(u)?, fields.real(v)?));
                let (from, to) = (corner(2, 4)?, corner(3, 5)?);
                let is_flipped = is_flipped ^ (fields.flag(6) != fields.flag(7));
                return Ok(Placed { surface, is_flipped, ids, scale, window: Some([from, to]) });
            }
            _ => self.spline_surface(id, kind)?,
        };
        Ok(Placed { surface, is_flipped: false, ids: vec![id], scale, window: None })
    }
}
