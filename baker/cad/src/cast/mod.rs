//! Faces cut into pieces for rays: a bounding volume hierarchy is built over the pieces' boxes.
//!
//! The domain of a face is halved until its patches are small in angle and either wholly in the domain or crossed by its
//! boundary; patches outside are left out. A ray is met with the exact surface of a piece ([`Surface::meet`], or the Bézier
//! patches of a spline), and where the boundary crosses the piece, the [trapezoidal map](crate::trim) says whether the meeting
//! belongs to the face.

use crate::curve::Curve;
use crate::face::Face;
use crate::spline::{BezierPatch, patches};
use crate::surface::{NurbsSurface, Ray, Surface, SurfaceHit, SurfaceHits};
use crate::trim::{Coverage, TrapezoidalMap, TrimError};
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};

mod sweep;
#[cfg(test)]
mod tests;

/// Most halvings of a domain along its boundary, after those for angles.
const DEEPEST: u32 = 6;
/// Widest angle of a piece of a surface of revolution, radians.
const WIDEST: f64 = FRAC_PI_2 + 1e-9;

/// A face ready for rays.
#[derive(Clone, Debug)]
pub struct CastFace {
    surface: Surface,
    map: TrapezoidalMap,
    /// Whether normals are against those of the surface.
    pub is_reversed: bool,
}

/// Part of a face.
#[derive(Clone, Debug)]
pub struct FacePiece {
    shape: PieceShape,
    /// Whether all of it belongs to the face.
    is_plain: bool,
    /// Least and greatest corner of a box that holds it.
    pub bounds: [DVec3; 2],
}

#[derive(Clone, Debug)]
enum PieceShape {
    /// Patch of a surface with a closed form: least and greatest parameters.
    Patch([DVec2; 2]),
    /// Piece of a spline.
    Bezier(Box<BezierPatch>),
    /// Piece of a swept surface, whose parameters are not those of the patch.
    Swept(Box<BezierPatch>),
}

impl CastFace {
    /// Prepares a face: itself, and its pieces.
    ///
    /// # Errors
    /// [`TrimError`] for loops that bound nothing.
    pub fn new(face: &Face) -> Result<(Self, Vec<FacePiece>), TrimError> {
        let map = TrapezoidalMap::new(&face.loops)?;
        let cast = Self { surface: face.surface.clone(), map, is_reversed: face.is_reversed };
        let domain = cast.map.bounds();
        let pieces = match &cast.surface {
            Surface::Nurbs(nurbs) => cast.of_splines(patches(nurbs), PieceShape::Bezier),
            Surface::Revolution { frame, profile } => {
                let swept = sweep::revolution(frame, profile, domain);
                cast.of_splines(patches(&swept), PieceShape::Swept)
            }
            Surface::Extrusion { profile, along } => {
                let swept = sweep::extrusion(profile, *along, domain);
                cast.of_splines(patches(&swept), PieceShape::Swept)
            }
            _ => {
                let mut pieces = Vec::new();
                cast.halve(domain, DEEPEST, &mut pieces);
                pieces
            }
        };
        Ok((cast, pieces))
    }

    /// The surface.
    pub fn surface(&self) -> &Surface {
        &self.surface
    }

    /// Domain of the face.
    pub fn map(&self) -> &TrapezoidalMap {
        &self.map
    }

    /// Unit normal of the face at parameters of its surface.
    pub fn normal(&self, at: DVec2) -> DVec3 {
        let normal = self.surface.normal(at);
        if self.is_reversed { -normal } else { normal }
    }

    /// The nearest hit of a ray with a piece, at distances from the first to the second, of those that `is_wanted`.
    pub fn nearest(
        &self,
        piece: &FacePiece,
        ray: &Ray,
        distances: [f64; 2],
        is_wanted: impl Fn(&SurfaceHit) -> bool,
    ) -> Option<SurfaceHit> {
        let belongs = |hit: &SurfaceHit| (piece.is_plain || self.map.contains(hit.at)) && is_wanted(hit);
        match &piece.shape {
            PieceShape::Patch(patch) => {
                let mut found = SurfaceHits::default();
                self.surface.meet(ray, patch, distances, &mut found);
                found.iter().copied().find(belongs)
            }
            PieceShape::Bezier(patch) => Self::first(patch, ray, distances, |hit| hit).find(belongs),
            PieceShape::Swept(patch) => {
                let exact = |hit: SurfaceHit| SurfaceHit { at: self.swept(ray, &hit), ..hit };
                Self::first(patch, ray, distances, exact).find(belongs)
            }
        }
    }

    /// Parameters of a swept surface at a hit of a ray with the spline that it is met as.
    fn swept(&self, ray: &Ray, hit: &SurfaceHit) -> DVec2 {
        let [low, high] = self.map.bounds();
        let known = match &self.surface {
            Surface::Revolution { profile, .. } => sweep::of_revolution(profile, [low.x, high.x], hit.at),
            Surface::Extrusion { profile, .. } => sweep::of_extrusion(profile, hit.at),
            _ => None,
        };
        let position = || ray.origin + hit.distance * ray.direction;
        known.unwrap_or_else(|| self.surface.invert(position(), Some(hit.at)))
    }

    /// Hits of a ray with a Bézier patch, near ones first.
    fn first(
        patch: &BezierPatch,
        ray: &Ray,
        distances: [f64; 2],
        exact: impl Fn(SurfaceHit) -> SurfaceHit,
    ) -> impl Iterator<Item = SurfaceHit> {
        let mut found = Vec::new();
        patch.meet(ray, distances, &mut found);
        found.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        found.into_iter().map(exact)
    }

    /// Pieces of a spline that are not outside the domain.
    fn of_splines(
        &self,
        patches: Vec<BezierPatch>,
        shape: impl Fn(Box<BezierPatch>) -> PieceShape,
    ) -> Vec<FacePiece> {
        let piece = |patch: BezierPatch| {
            let coverage = self.map.coverage(patch.range);
            let bounds = patch.bounds();
            let is_plain = coverage == Coverage::Plain;
            (coverage != Coverage::Empty).then(|| FacePiece {
                shape: shape(Box::new(patch)),
                is_plain,
                bounds,
            })
        };
        patches.into_iter().filter_map(piece).collect()
    }

    /// Halves a patch of a surface with a closed form until it is a piece.
    fn halve(&self, [low, high]: [DVec2; 2], depth: u32, pieces: &mut Vec<FacePiece>) {
        let patch = [low, high];
        let coverage = self.map.coverage(patch);
        if coverage == Coverage::Empty {
            return;
        }
        let size = high - low;
        let turns = match self.surface {
            Surface::Sphere { .. } | Surface::Torus { .. } => size,
            Surface::Plane(_) => DVec2::ZERO,
            _ => DVec2::new(size.x, 0.0),
        };
        let is_wide = turns.max_element() > WIDEST;
        let is_done = !is_wide && (coverage == Coverage::Plain || depth == 0);
        if is_done || turns.max_element() > 1e3 * PI {
            let is_plain = coverage == Coverage::Plain;
            let bounds = self.surface.bounds(patch);
            pieces.push(FacePiece { shape: PieceShape::Patch(patch), is_plain, bounds });
            return;
        }
        let [_, along_u, along_v] = self.surface.derivatives(0.5 * (low + high));
        let in_u = match is_wide {
            true => turns.x >= turns.y,
            false => size.x * along_u.length() >= size.y * along_v.length(),
        };
        let middle = 0.5 * (low + high);
        let rest = if is_wide { depth } else { depth - 1 };
        if in_u {
            self.halve([low, DVec2::new(middle.x, high.y)], rest, pieces);
            self.halve([DVec2::new(middle.x, low.y), high], rest, pieces);
        } else {
            self.halve([low, DVec2::new(high.x, middle.y)], rest, pieces);
            self.halve([DVec2::new(low.x, middle.y), high], rest, pieces);
        }
    }
}
