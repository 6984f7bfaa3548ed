//! Triangles of trimmed faces, for the screen: light does not need them.

use crate::face::Face;
use crate::trim::{TrapezoidalMap, TrimEdge, TrimError, TrimLoop};
use glam::{DVec2, DVec3};
use rebounce_shared::elementary::Elementary;
use spade::{
    ConstrainedDelaunayTriangulation, InsertionError, Point2, PositionInTriangulation, Triangulation,
};

#[cfg(test)]
mod tests;

/// Halvings of an edge, and rounds of points added inside a face, before the chord error is left as it is.
const MOST_ROUNDS: u32 = 20;
/// Vertices of a face after which no more are added.
const MOST_VERTICES: usize = 1 << 18;
/// Fractions of an edge where its distance from the surface is measured; not the middle alone, where an S may cross its chord.
const FRACTIONS: [f64; 3] = [0.5, 0.27, 0.73];
/// Parts of an edge that is a point in space.
const POLE_PARTS: u32 = 32;
/// Edges shorter than this part of the chord error are a point in space; others may just be short.
const POINT: f64 = 0.01;
/// Coordinates of the triangulation are multiples of this part of the domain's size: edges along an axis are so exactly, and no
/// coordinate but 0 is smaller than the triangulation takes.
const GRID: f64 = 1.0 / (1_u64 << 44) as f64;
/// Height of a triangle, relative to its longest edge, below which its corners are on one line but for rounding.
const SLIVER: f64 = 1e-11;

/// A triangulated face.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tessellation {
    /// Parameters u and v of vertices.
    pub parameters: Vec<DVec2>,
    /// The surface's points there.
    pub positions: Vec<DVec3>,
    /// Indices of three vertices each, counterclockwise in the parameter plane: the normal of σᵤ × σᵥ.
    pub triangles: Vec<[u32; 3]>,
    /// The vertex of each outline point: where faces share an edge, equal positions may be written there.
    pub outlines: Vec<Vec<u32>>,
}

/// Why a face has no triangles.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TessellateError {
    /// The outlines are no domain.
    #[error(transparent)]
    Trim(#[from] TrimError),
    /// A number is not finite or too large.
    #[error("a point of a face cannot be triangulated: {0}")]
    Point(#[from] InsertionError),
    /// The surface has no finite point at these parameters.
    #[error("a surface is not finite at parameters {at}")]
    NotFinite {
        /// u and v.
        at: DVec2,
    },
}

/// Points along a loop, each once, with chords no farther than `chord_error` from the surface's curve, metres. An edge has the
/// same points, in reverse, if it goes the other way.
pub fn outline(edges: &TrimLoop, surface: &impl Fn(DVec2) -> DVec3, chord_error: f64) -> Vec<DVec2> {
    let mut points: Vec<DVec2> = Vec::new();
    for edge in edges {
        // From the lesser end, so that both faces of an edge halve it alike.
        let [from, to] = edge.ends();
        let is_reversed = match *edge {
            TrimEdge::Segment { .. } => (to.x, to.y) < (from.x, from.y),
            TrimEdge::Arc { angles, .. } => angles[1] < angles[0],
        };
        let forward = if is_reversed { edge.reversed() } else { *edge };
        let mut fractions = vec![0.0];
        // An arc's ends may coincide, and a segment may go round: a few parts at least are looked at.
        for i in 0..4 {
            halve(
                [f64::from(i) / 4.0, f64::from(i + 1) / 4.0],
                MOST_ROUNDS,
                &forward,
                surface,
                chord_error,
                &mut fractions,
            );
        }
        simplify(&mut fractions, &forward, surface, chord_error);
        let mut along: Vec<DVec2> = fractions.into_iter().map(|fraction| forward.at(fraction)).collect();
        if is_reversed {
            along.reverse();
        }
        points.extend(along);
        // The last is the first of the next edge.
        points.pop();
    }
    points.dedup();
    points
}

/// Adds the ends of parts of an edge that keep the chord error.
fn halve(
    [begin, end]: [f64; 2],
    rounds: u32,
    edge: &TrimEdge,
    surface: &impl Fn(DVec2) -> DVec3,
    chord_error: f64,
    fractions: &mut Vec<f64>,
) {
    if rounds > 0 && !is_chord(edge, surface, [begin, end], chord_error) {
        let middle = 0.5 * (begin + end);
        halve([begin, middle], rounds - 1, edge, surface, chord_error, fractions);
        halve([middle, end], rounds - 1, edge, surface, chord_error, fractions);
    } else {
        fractions.push(end);
    }
}

/// One chord, where the four first parts of an edge are one straight line in space.
fn simplify(fractions: &mut Vec<f64>, edge: &TrimEdge, surface: &impl Fn(DVec2) -> DVec3, chord_error: f64) {
    let is_plain = fractions.len() == 5
        && [0.25, 0.5, 0.75].iter().all(|&fraction| {
            let ends = [0.0, 1.0].map(|end| surface(edge.at(end)));
            distance_to_segment(surface(edge.at(fraction)), ends) <= chord_error
        });
    // An arc in the plane keeps its middle points: a chord alone would leave the domain without area.
    if is_plain && matches!(edge, TrimEdge::Segment { .. }) {
        let [from, middle, to] = [0.0, 0.5, 1.0].map(|fraction| surface(edge.at(fraction)));
        *fractions = if from.distance(to).max(from.distance(middle)) <= POINT * chord_error {
            // A pole: a point in space, and triangles all around it.
            (0..=POLE_PARTS).map(|i| f64::from(i) / f64::from(POLE_PARTS)).collect()
        } else {
            vec![0.0, 1.0]
        };
    }
}

fn is_chord(
    edge: &TrimEdge,
    surface: &impl Fn(DVec2) -> DVec3,
    [begin, end]: [f64; 2],
    chord_error: f64,
) -> bool {
    let ends = [begin, end].map(|fraction| surface(edge.at(fraction)));
    FRACTIONS.iter().all(|&t| {
        let distance = distance_to_segment(surface(edge.at(begin + (end - begin) * t)), ends);
        // What is not finite is not halved for ever.
        distance <= chord_error || distance.is_nan()
    })
}

fn distance_to_segment(point: DVec3, [a, b]: [DVec3; 2]) -> f64 {
    let along = b - a;
    let squared = along.length_squared();
    let t = if squared > 0.0 { ((point - a).dot(along) / squared).clamp(0.0, 1.0) } else { 0.0 };
    point.distance(a + t * along)
}

/// Triangles of a face within outlines, by the even-odd rule, of which none is farther than about `chord_error` from the
/// surface, metres.
///
/// A constrained Delaunay triangulation in the parameter plane, stretched to the surface's mean lengths along u and v. While
/// the surface is farther than the chord error from the middle of a triangle or of an edge inside, its point there becomes a
/// vertex. Edges of outlines stay as they are. The error is measured at samples, no bound is proven.
///
/// # Errors
/// If the outlines are no domain, or parameters or the surface are not finite.
pub fn face(
    outlines: &[Vec<DVec2>],
    surface: &impl Fn(DVec2) -> DVec3,
    chord_error: f64,
) -> Result<Tessellation, TessellateError> {
    let polygon = |points: &Vec<DVec2>| -> TrimLoop {
        let next = points.iter().cycle().skip(1);
        points.iter().zip(next).map(|(&from, &to)| TrimEdge::Segment { from, to }).collect()
    };
    let domain = TrapezoidalMap::new(&outlines.iter().map(polygon).collect::<Vec<_>>())?;
    let mut mesh = Mesh::new(surface, scale(domain.bounds(), surface), domain.bounds());
    let mut result = Tessellation::default();
    for points in outlines {
        let vertices = points.iter().map(|&at| mesh.insert(at)).collect::<Result<Vec<_>, _>>()?;
        result.outlines.push(vertices);
    }
    for vertices in &result.outlines {
        for (&from, &to) in vertices.iter().zip(vertices.iter().cycle().skip(1)) {
            mesh.constrain(from, to)?;
        }
    }
    for _ in 0..MOST_ROUNDS {
        let points = mesh.missing(&domain, chord_error);
        if points.is_empty() || mesh.parameters.len() + points.len() > MOST_VERTICES {
            break;
        }
        for at in points {
            mesh.insert_inside(at)?;
        }
    }
    result.triangles = mesh.triangles(&domain);
    result.parameters = mesh.parameters;
    result.positions = mesh.positions;
    Ok(result)
}

/// Triangles of a trimmed face: its [`outline`]s and what is within them, by [`face`].
///
/// # Errors
/// As of [`face`].
pub fn trimmed(of: &Face, chord_error: f64) -> Result<Tessellation, TessellateError> {
    let surface = |at| of.surface.point(at);
    let outlines: Vec<_> = of.loops.iter().map(|edges| outline(edges, &surface, chord_error)).collect();
    face(&outlines, &surface, chord_error)
}

/// Lengths on the surface for lengths along u and v, the mean of samples.
fn scale([low, high]: [DVec2; 2], surface: &impl Fn(DVec2) -> DVec3) -> DVec2 {
    let step = (high - low) / 8.0;
    let mut lengths = DVec2::ZERO;
    for i in 0..64 {
        let at = low + DVec2::new(f64::from(i % 8), f64::from(i / 8)) * step;
        let here = surface(at);
        lengths.x += here.distance(surface(at + DVec2::new(step.x, 0.0)));
        lengths.y += here.distance(surface(at + DVec2::new(0.0, step.y)));
    }
    let scale = lengths / (64.0 * step);
    if scale.is_finite() && scale.min_element() > 0.0 { scale } else { DVec2::ONE }
}

/// The triangulation, and what belongs to its vertices.
struct Mesh<'a, S> {
    surface: &'a S,
    scale: DVec2,
    /// A power of two.
    grid: f64,
    plane: ConstrainedDelaunayTriangulation<Point2<f64>>,
    parameters: Vec<DVec2>,
    positions: Vec<DVec3>,
}

impl<'a, S: Fn(DVec2) -> DVec3> Mesh<'a, S> {
    fn new(surface: &'a S, scale: DVec2, [low, high]: [DVec2; 2]) -> Self {
        let plane = ConstrainedDelaunayTriangulation::new();
        let size = (scale * (high - low)).max_element();
        let grid = if size.is_normal() { size.log2().floor().exponential2() * GRID } else { 1.0 };
        Self { surface, scale, grid, plane, parameters: Vec::new(), positions: Vec::new() }
    }

    fn planar(&self, at: DVec2) -> Point2<f64> {
        let at = (at * self.scale / self.grid).round() * self.grid;
        Point2::new(at.x, at.y)
    }

    /// Whether a triangle belongs to the domain, of which the outlines enclose nothing between points on one line.
    fn is_within(&self, domain: &TrapezoidalMap, at: [DVec2; 3]) -> bool {
        let [a, b, c] = at.map(|at| self.scale * at);
        let longest = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
        (b - a).perp_dot(c - a).abs() > SLIVER * longest && domain.contains((at[0] + at[1] + at[2]) / 3.0)
    }

    /// The vertex at parameters, new or not.
    fn insert(&mut self, at: DVec2) -> Result<u32, TessellateError> {
        let vertex = self.plane.insert(self.planar(at))?.index();
        if vertex == self.parameters.len() {
            self.record(at)?;
        }
        Ok(vertex as u32)
    }

    fn record(&mut self, at: DVec2) -> Result<(), TessellateError> {
        let position = (self.surface)(at);
        if !position.is_finite() {
            return Err(TessellateError::NotFinite { at });
        }
        self.parameters.push(at);
        self.positions.push(position);
        Ok(())
    }

    /// A vertex that splits no edge of an outline.
    fn insert_inside(&mut self, at: DVec2) -> Result<(), TessellateError> {
        let is_on_outline = match self.plane.locate(self.planar(at)) {
            PositionInTriangulation::OnEdge(edge) => {
                self.plane.directed_edge(edge).as_undirected().is_constraint_edge()
            }
            PositionInTriangulation::OnFace(_) => false,
            _ => true,
        };
        if !is_on_outline {
            self.insert(at)?;
        }
        Ok(())
    }

    /// Makes an edge of an outline one of triangles; where it crosses another, both are split.
    fn constrain(&mut self, from: u32, to: u32) -> Result<(), TessellateError> {
        if from == to {
            return Ok(());
        }
        let vertex = |index: u32| spade::handles::FixedVertexHandle::from_index(index as usize);
        self.plane.add_constraint_and_split(vertex(from), vertex(to), |point| point);
        while self.parameters.len() < self.plane.num_vertices() {
            let vertex = spade::handles::FixedVertexHandle::from_index(self.parameters.len());
            let point = self.plane.vertex(vertex).position();
            self.record(DVec2::new(point.x, point.y) / self.scale)?;
        }
        Ok(())
    }

    /// Points where the surface is farther than the chord error from triangles of the domain.
    fn missing(&self, domain: &TrapezoidalMap, chord_error: f64) -> Vec<DVec2> {
        let mut points = Vec::new();
        for triangle in self.plane.inner_faces() {
            let vertices = triangle.vertices().map(|vertex| vertex.fix().index());
            let at = vertices.map(|vertex| self.parameters[vertex]);
            let middle = (at[0] + at[1] + at[2]) / 3.0;
            if !self.is_within(domain, at) {
                continue;
            }
            let [a, b, c] = vertices.map(|vertex| self.positions[vertex]);
            if a.distance(b).max(b.distance(c)).max(c.distance(a)) <= chord_error {
                continue;
            }
            let mut worst = (chord_error, None);
            for edge in triangle.adjacent_edges() {
                let ends = edge.vertices().map(|vertex| vertex.fix().index());
                if !edge.as_undirected().is_constraint_edge() {
                    // From the lesser vertex, so that both triangles of an edge ask for one point.
                    let ends = [ends[0].min(ends[1]), ends[0].max(ends[1])];
                    for t in FRACTIONS {
                        let at = self.parameters[ends[0]].lerp(self.parameters[ends[1]], t);
                        let chord = ends.map(|vertex| self.positions[vertex]);
                        let error = distance_to_segment((self.surface)(at), chord);
                        if error > worst.0 {
                            worst = (error, Some(at));
                        }
                    }
                }
            }
            let normal = (b - a).cross(c - a).normalize_or_zero();
            let error = ((self.surface)(middle) - a).dot(normal).abs();
            if error > worst.0 {
                worst = (error, Some(middle));
            }
            points.extend(worst.1);
        }
        points
    }

    fn triangles(&self, domain: &TrapezoidalMap) -> Vec<[u32; 3]> {
        let faces = self.plane.inner_faces().map(|face| face.vertices().map(|vertex| vertex.fix().index()));
        let within =
            faces.filter(|vertices| self.is_within(domain, vertices.map(|vertex| self.parameters[vertex])));
        within.map(|vertices| vertices.map(|vertex| vertex as u32)).collect()
    }
}
