//! Virtual mesh: trimmed surfaces mapped to unit squares so that areas keep their proportions.
//!
//! Alonso, Cuny, Petitjean, Paul, Lazard, Wies: The Virtual Mesh: A Geometric Abstraction for Efficiently
//! Computing Radiosity (2001), sections 3 and 4.
//!
//! | module | what it has |
//! |---|---|
//! | `equal_area` | Ψ⁻¹: parameters to a plane, of each kind of surface |
//! | `revolved` | which closed form a surface of revolution has |
//! | `antiderivative` | closed forms of separable area elements, and their inverses |
//! | `cumulative`, `marginal` | tables where there is no closed form, over one parameter and over two |
//! | `density` | area elements where the map is by natural parameters, for comparison |
//! | `boundary` | trimming curves in the square, nearest real points |
//! | `legendre`, `root` | quadrature and Newton's iteration |

mod antiderivative;
mod boundary;
mod cumulative;
mod density;
mod equal_area;
mod legendre;
mod marginal;
mod revolved;
mod root;
#[cfg(test)]
mod tests;

use crate::face::Face;
use crate::surface::Surface;
use crate::trim::parallelogram::minimal_enclosing;
use crate::trim::{Coverage, Parallelogram, TrapezoidalMap, TrimEdge, TrimError};
use boundary::BoundarySegment;
use equal_area::EqualArea;
use glam::{DVec2, DVec3};

/// How far inside of the boundary nearest real points are, in the unit square.
const INSET: f64 = 1e-4;
/// So much of a cell at the rim of the square is of no account.
const RIM: f64 = 1e-9;

/// Why a face has no virtual mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum VirtualMeshError {
    /// Its loops bound nothing.
    #[error(transparent)]
    Trim(#[from] TrimError),
    /// It has no area, or a point or derivative that is not finite.
    #[error("a face has no finite area above 0")]
    NoArea,
}

/// The virtual support of a face: (s, t) in the unit square, mapped to the surface with a constant Jacobian.
///
/// An equal-area map Ψ⁻¹ takes the face to a plane; the smallest parallelogram around its image there
/// (Schwarz et al. 1994) is taken to the unit square by an affine map. Points of the square that belong to
/// the face are real, the others virtual. Trimming curves are segments there, that deviate from the exact
/// ones by 1e-5 of the face's extent at most.
#[derive(Clone, Debug)]
pub struct VirtualMesh {
    surface: Surface,
    is_reversed: bool,
    map: EqualArea,
    parallelogram: Parallelogram,
    /// Trimming curves in the square.
    real: TrapezoidalMap,
    boundary: Vec<BoundarySegment>,
    /// How far they are from the exact ones at most, in the square.
    deviation: f64,
    /// Mean of the area element |σᵤ × σᵥ| over the square; `None` where areas keep their proportions.
    mean_element: Option<f64>,
}

impl VirtualMesh {
    /// The virtual mesh of a face.
    ///
    /// # Errors
    /// [`VirtualMeshError`] for loops that bound nothing and for faces without area.
    pub fn new(face: &Face) -> Result<Self, VirtualMeshError> {
        Self::by_map(face, EqualArea::new)
    }

    /// A face in the smallest parallelogram of its natural parameters, to see what the equal-area map is good
    /// for: the Jacobian is not constant, but in proportion to [`Self::density`].
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn natural(face: &Face) -> Result<Self, VirtualMeshError> {
        Self::by_map(face, EqualArea::natural)
    }

    fn by_map(
        face: &Face,
        map: impl Fn(&Surface, [DVec2; 2]) -> EqualArea,
    ) -> Result<Self, VirtualMeshError> {
        let domain = TrapezoidalMap::new(&face.loops)?.bounds();
        let sides = domain[1] - domain[0];
        if !(sides.min_element() > 0.0 && sides.is_finite()) {
            return Err(VirtualMeshError::NoArea);
        }
        let map = map(&face.surface, domain);
        let chain = boundary::flattened(&face.surface, &map, &face.loops);
        let points: Vec<DVec2> = chain.loops.iter().flatten().copied().collect();
        let parallelogram = minimal_enclosing(&points).ok_or(VirtualMeshError::NoArea)?;
        let mut boundary = Vec::new();
        let mut loops = Vec::new();
        for points in &chain.loops {
            let square = |flat: &DVec2| parallelogram.unit(*flat).clamp(DVec2::ZERO, DVec2::ONE);
            let ends: Vec<_> =
                points.iter().map(|flat| (square(flat), face.surface.point(map.parameters(*flat)))).collect();
            let pairs = ends.iter().zip(ends.iter().cycle().skip(1)).filter(|(a, b)| a.0 != b.0);
            let segments = pairs.map(|(a, b)| BoundarySegment { square: [a.0, b.0], space: [a.1, b.1] });
            let before = boundary.len();
            boundary.extend(segments);
            let edges = &boundary[before..];
            if !edges.is_empty() {
                let segment =
                    |edge: &BoundarySegment| TrimEdge::Segment { from: edge.square[0], to: edge.square[1] };
                loops.push(edges.iter().map(segment).collect());
            }
        }
        if !boundary.iter().all(|segment| segment.space[0].is_finite()) {
            return Err(VirtualMeshError::NoArea);
        }
        let real = TrapezoidalMap::new(&loops)?;
        let (surface, is_reversed) = (face.surface.clone(), face.is_reversed);
        // Extents of the image are at most those of the square.
        let deviation = if chain.deviation > 1e-12 { 2.0 * chain.deviation } else { 0.0 };
        let mean_element = None;
        let mut mesh =
            Self { surface, is_reversed, map, parallelogram, real, boundary, deviation, mean_element };
        mesh.measure()?;
        Ok(mesh)
    }

    /// Parameters (u, v) of a point of the square. Beyond poles, apices and the ends of tables, those at the
    /// border.
    pub fn parameters(&self, st: DVec2) -> DVec2 {
        self.map.parameters(self.parallelogram.at(st))
    }

    /// The point of the square with parameters (u, v); outside of it if they lie beyond the parallelogram.
    pub fn square(&self, uv: DVec2) -> DVec2 {
        self.parallelogram.unit(self.map.flat(uv))
    }

    /// The point of the square at a point of the surface. On a seam it is the one nearest to `st`; where a parameter is
    /// undetermined within `tolerance`, as at a pole, it has that of `st`.
    pub fn square_near(&self, place: DVec3, st: DVec2, tolerance: f64) -> DVec2 {
        let near = self.parameters(st);
        let found = self.surface.invert(place, Some(near));
        let is_here = |at: &DVec2| self.surface.point(*at).distance(place) <= tolerance;
        let along = [DVec2::new(near.x, found.y), DVec2::new(found.x, near.y)];
        self.square(along.into_iter().find(is_here).unwrap_or(found))
    }

    /// Point on the surface.
    pub fn point(&self, st: DVec2) -> DVec3 {
        self.surface.point(self.parameters(st))
    }

    /// Unit normal of the face.
    pub fn normal(&self, st: DVec2) -> DVec3 {
        self.normal_at(self.parameters(st))
    }

    /// Point and unit normal of the face.
    pub fn point_and_normal(&self, st: DVec2) -> [DVec3; 2] {
        let at = self.parameters(st);
        [self.surface.point(at), self.normal_at(at)]
    }

    fn normal_at(&self, at: DVec2) -> DVec3 {
        let normal = self.surface.normal(at);
        if self.is_reversed { -normal } else { normal }
    }

    /// Whether the surface is a plane, on which no point sees another.
    pub fn is_planar(&self) -> bool {
        matches!(self.surface, Surface::Plane(_))
    }

    /// Area of the whole square, real and virtual, on the surface: the Jacobian, or its mean.
    pub fn area(&self) -> f64 {
        self.parallelogram.area() * self.mean_element.unwrap_or(1.0)
    }

    /// Area of the face.
    pub fn real_area(&self) -> f64 {
        self.area() * self.real_density([DVec2::ZERO, DVec2::ONE])
    }

    /// Whether all points of a cell, least and greatest corner, are real, none, or perhaps some: never plain
    /// or empty where that is not so.
    pub fn coverage(&self, cell: [DVec2; 2]) -> Coverage {
        let low = (cell[0] - self.deviation).max(DVec2::splat(RIM));
        let high = (cell[1] + self.deviation).min(DVec2::splat(1.0 - RIM));
        self.real.coverage([low, high])
    }

    /// Whether a point of the square belongs to the face.
    pub fn is_real(&self, st: DVec2) -> bool {
        self.real.contains(st)
    }

    /// The part of a cell's area on the surface that is real, 0 to 1.
    pub fn real_share(&self, cell: [DVec2; 2]) -> f64 {
        let whole = self.mean_density(cell);
        if whole > 0.0 { (self.real_density(cell) / whole).clamp(0.0, 1.0) } else { 0.0 }
    }

    /// The part of a cell's area in the square that is real, 0 to 1.
    fn real_part_of_square(&self, cell: [DVec2; 2]) -> f64 {
        let sides = cell[1] - cell[0];
        (self.real.area_within(cell) / (sides.x * sides.y)).clamp(0.0, 1.0)
    }

    /// The part of a cell's area in the square that is real, 0 to 1, and the centroid of that part there; the
    /// middle of the cell if it is empty.
    pub fn real_part(&self, cell: [DVec2; 2]) -> (f64, DVec2) {
        let area = self.real.area_within(cell);
        let sides = cell[1] - cell[0];
        let share = (area / (sides.x * sides.y)).clamp(0.0, 1.0);
        if share < RIM {
            return (share, cell[0].midpoint(cell[1]));
        }
        (share, (self.real.moments_within(cell) / area).clamp(cell[0], cell[1]))
    }

    /// The real point nearest in space to a point of the square: itself if it is real, else one 1e-4 of the
    /// square inside of where the boundary is nearest, less where the face is narrower.
    pub fn nearest_real(&self, st: DVec2) -> DVec2 {
        if self.is_real(st) { st } else { self.moved_inside(st, INSET) }
    }

    /// A point itself if it is real and `inset` / 8 of the square inside of the boundary; else a real one
    /// about `inset` inside of where the boundary is nearest in space, less where the face is narrower.
    pub fn well_inside(&self, st: DVec2, inset: f64) -> DVec2 {
        let around = [DVec2::X, DVec2::Y, DVec2::NEG_X, DVec2::NEG_Y].map(|axis| st + 0.125 * inset * axis);
        let is_inside = self.is_real(st) && around.into_iter().all(|at| self.is_real(at));
        if is_inside { st } else { self.moved_inside(st, inset) }
    }

    fn moved_inside(&self, st: DVec2, inset: f64) -> DVec2 {
        let Some((foot, along)) = boundary::nearest(&self.boundary, self.point(st)) else { return st };
        let inward = along.perp().normalize_or_zero();
        let steps = (0..8).map(|power| inset * 0.25_f64.powi(power));
        let mut moved = steps.flat_map(|step| [foot + step * inward, foot - step * inward]);
        moved.find(|&at| self.is_real(at)).unwrap_or(foot)
    }

    /// Bytes of memory it takes, about.
    pub fn bytes(&self) -> usize {
        self.boundary.len() * (size_of::<BoundarySegment>() + 64) + size_of::<Self>()
    }
}
