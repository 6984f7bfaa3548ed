//! Faces cut into pieces for rays: a bounding volume hierarchy is built over the pieces' boxes.
//!
//! The domain of a face is halved until its patches are small in angle and either wholly in the domain or crossed by its
//! boundary; patches outside are left out. A ray is met with the exact surface of a piece ([`Surface::meet`], or the Bézier
//! patches of a spline), and where the boundary crosses the piece, the [trapezoidal map](crate::trim) says whether the meeting
//! belongs to the face.

use crate::curve::Curve;
use crate::face::Face;
use crate::spline::meet::SplineHits;
use crate::spline::{BezierPatch, patches};
use crate::surface::plane;
use crate::surface::{LineMeetings, NurbsSurface, Ray, Surface, SurfaceHit};
use crate::trim::{Coverage, TrapezoidalMap, TrimError};
use flatten::flattened;
use glam::{DVec2, DVec3};
use oriented_box::{MARGIN, OrientedBox, ROUNDING};
use std::f64::consts::{FRAC_PI_2, PI};

mod flatten;
mod oriented_box;
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
    Bezier(Box<SplinePiece>),
    /// Piece of a swept surface, whose parameters are not those of the patch.
    Swept(Box<SplinePiece>),
}

#[derive(Clone, Debug)]
struct SplinePiece {
    around: OrientedBox,
    patch: BezierPatch,
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
            Surface::Nurbs(nurbs) => cast.of_splines(patches(nurbs), PieceShape::Bezier, |range, _| range),
            Surface::Revolution { frame, profile } => {
                let swept = sweep::revolution(frame, profile, domain);
                let ends = [domain[0].x, domain[1].x];
                cast.of_splines(patches(&swept), PieceShape::Swept, |range, whole| {
                    let [low, high] = range.map(|at| DVec2::new(sweep::angle(ends, at.x), at.y));
                    match sweep::keeps_parameters(profile) {
                        true => [low, high],
                        false => [DVec2::new(low.x, whole[0].y), DVec2::new(high.x, whole[1].y)],
                    }
                })
            }
            Surface::Extrusion { profile, along } => {
                let swept = sweep::extrusion(profile, *along, domain);
                cast.of_splines(patches(&swept), PieceShape::Swept, |range, whole| {
                    match sweep::keeps_parameters(profile) {
                        true => range,
                        false => [DVec2::new(whole[0].x, range[0].y), DVec2::new(whole[1].x, range[1].y)],
                    }
                })
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

    /// Whether [`Self::nearest`] leaves anything for other pieces.
    pub fn has_line_meetings(&self) -> bool {
        use Surface::{Cone, Cylinder, Sphere, Torus};
        matches!(self.surface, Cylinder { .. } | Cone { .. } | Sphere { .. } | Torus { .. })
    }

    /// Domain of the face.
    pub fn map(&self) -> &TrapezoidalMap {
        &self.map
    }

    /// Point and unit normal of the face at parameters of its surface.
    pub fn point_and_normal(&self, at: DVec2) -> [DVec3; 2] {
        let [point, normal] = self.surface.point_and_normal(at);
        [point, if self.is_reversed { -normal } else { normal }]
    }

    /// Unit normal of the face at parameters of its surface.
    pub fn normal(&self, at: DVec2) -> DVec3 {
        let normal = self.surface.normal(at);
        if self.is_reversed { -normal } else { normal }
    }

    /// The nearest hit of a ray with a piece, at distances from the first to the second, of those that `is_wanted`. `known` is
    /// what earlier calls for the same ray and face have left there, for whichever pieces, at these or greater distances; `None`
    /// for the first one.
    pub fn nearest(
        &self,
        piece: &FacePiece,
        ray: &Ray,
        known: &mut Option<LineMeetings>,
        distances: [f64; 2],
        is_wanted: impl Fn(&SurfaceHit) -> bool,
    ) -> Option<SurfaceHit> {
        let is_between = |distance: f64| distances[0] <= distance && distance <= distances[1];
        let belongs = |hit: &SurfaceHit| (piece.is_plain || self.map.contains(hit.at)) && is_wanted(hit);
        match &piece.shape {
            PieceShape::Patch(patch) => {
                if let Surface::Plane(frame) = &self.surface {
                    let hit = plane::meet(frame, ray).filter(|hit| is_between(hit.distance))?;
                    let is_in_patch = hit.at.cmpge(patch[0]).all() && hit.at.cmple(patch[1]).all();
                    return (is_in_patch && belongs(&hit)).then_some(hit);
                }
                if known.is_none() {
                    *known = self.surface.line_meetings(ray, &self.map.bounds(), distances);
                }
                let meetings = known.as_mut()?;
                let reach = MARGIN * (piece.bounds[1] - piece.bounds[0]).max_element()
                    + ROUNDING * ray.origin.abs().max_element();
                let [low, high] = [piece.bounds[0] - reach, piece.bounds[1] + reach];
                (0..meetings.count()).find_map(|index| {
                    let distance = meetings.distance(index);
                    let place = ray.origin + distance * ray.direction;
                    let may_be_here =
                        is_between(distance) && place.cmpge(low).all() && place.cmple(high).all();
                    if !may_be_here {
                        return None;
                    }
                    meetings.in_patch(index, &self.surface, patch).filter(belongs)
                })
            }
            PieceShape::Bezier(spline) => {
                let hits = Self::spline_hits(piece, spline, ray, distances);
                hits.into_iter().find(belongs)
            }
            PieceShape::Swept(spline) => {
                let hits = Self::spline_hits(piece, spline, ray, distances);
                let exact = |hit: SurfaceHit| SurfaceHit { at: self.swept(ray, &hit), ..hit };
                hits.into_iter().map(exact).find(belongs)
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

    /// Hits of a ray with a piece of a spline, near ones first.
    fn spline_hits(piece: &FacePiece, spline: &SplinePiece, ray: &Ray, distances: [f64; 2]) -> SplineHits {
        let mut found = SplineHits::new();
        if spline.around.may_meet(ray, distances) {
            spline.patch.meet_within(&piece.bounds, ray, distances, &mut found);
            found.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        }
        found
    }

    /// Pieces of a spline that are not outside the domain. `covered` has the parameters that a piece covers, of its range and
    /// that of its patch.
    fn of_splines(
        &self,
        patches: Vec<BezierPatch>,
        shape: impl Fn(Box<SplinePiece>) -> PieceShape,
        covered: impl Fn([DVec2; 2], [DVec2; 2]) -> [DVec2; 2],
    ) -> Vec<FacePiece> {
        let whole: Vec<[DVec2; 2]> = patches.iter().map(|patch| patch.range).collect();
        let piece = |(number, patch): (usize, BezierPatch)| {
            let coverage = self.map.coverage(covered(patch.range, whole[number]));
            let bounds = patch.bounds();
            let is_plain = coverage == Coverage::Plain;
            let around = OrientedBox::of(&patch);
            (coverage != Coverage::Empty).then(|| FacePiece {
                shape: shape(Box::new(SplinePiece { around, patch })),
                is_plain,
                bounds,
            })
        };
        flattened(patches).into_iter().filter_map(piece).collect()
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
