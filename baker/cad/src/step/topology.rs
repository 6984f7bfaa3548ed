//! Solids, shells and faces.

use super::curves::Geometry;
use super::file::{File, spoken};
use super::loops::Bound;
use super::path::{Edge, Path};
use super::style::Styles;
use super::surfaces::Placed;
use super::units::Units;
use super::{Flaw, Notes, Read, StepError};
use crate::face::Face;
use crate::frame::Frame;
use crate::model::{FaceColour, Part};
use crate::surface::Surface;
use glam::{DVec2, DVec3};
use std::collections::HashMap;
use std::rc::Rc;

/// Items of representations that are solids or surfaces this module reads.
pub(super) const BODIES: [&str; 10] = [
    "BREP_WITH_VOIDS",
    "FACETED_BREP",
    "MANIFOLD_SOLID_BREP",
    "SHELL_BASED_SURFACE_MODEL",
    "FACE_BASED_SURFACE_MODEL",
    "CLOSED_SHELL",
    "OPEN_SHELL",
    "CONNECTED_FACE_SET",
    "ADVANCED_FACE",
    "FACE_SURFACE",
];

/// Reads bodies.
pub(super) struct Bodies<'a> {
    pub file: &'a File,
    pub styles: &'a Styles,
    /// Edges by number and unit of length: two faces share one.
    pub edges: HashMap<(u64, u64), Option<Rc<Edge>>>,
    pub notes: Notes,
}

/// A face in a shell.
pub(super) struct Use {
    pub face: u64,
    /// Whether it is turned over.
    pub is_flipped: bool,
    /// Colour of what it is in.
    pub colour: FaceColour,
}

/// A face's bounds before trimming.
pub(super) struct Bounded {
    pub placed: Placed,
    /// Normal along that of the surface in the file.
    pub same_sense: bool,
    /// Counter-clockwise about the face's normal.
    pub bounds: Vec<Bound>,
    /// A number for each run of an edge, with its direction: the law of closed shells is stated of these.
    pub runs: Vec<(u64, bool)>,
}

/// A face with what its shell needs to know.
struct FaceRead {
    face: Face,
    colour: FaceColour,
    /// Whether edges stand off the surface.
    is_off: bool,
    /// Whether bounds run clockwise about the normal.
    is_against: bool,
    /// Runs of edges, with their direction in the shell.
    runs: Vec<(u64, bool)>,
}

impl Bodies<'_> {
    /// The part that an item is; `None` if none of its faces can be read.
    pub fn part(
        &mut self,
        units: Units,
        item: u64,
        name: &str,
        colour: FaceColour,
    ) -> Result<Option<Part>, StepError> {
        let (uses, mut is_closed) = match self.uses(item, colour) {
            Ok(found) => found,
            Err(flaw) => {
                let (why, at) = flaw.reason()?;
                self.notes.add_at("body", name, &why, at);
                return Ok(None);
            }
        };
        let mut faces = Vec::with_capacity(uses.len());
        let mut against = Vec::new();
        // How often each edge is run forward and back.
        let mut runs = HashMap::<u64, [u32; 2]>::new();
        for each in uses {
            match self.face(units, &each) {
                Ok(read) => {
                    if read.is_off {
                        self.notes.add(
                            "face",
                            name,
                            "edges stand off the surface by more than a thousandth of the face",
                        );
                    }
                    if read.is_against {
                        against.push(faces.len());
                    }
                    for (edge, forward) in read.runs {
                        runs.entry(edge).or_default()[usize::from(forward)] += 1;
                    }
                    faces.push((read.face, read.colour));
                }
                Err(flaw) => {
                    is_closed = false;
                    let (why, at) = flaw.reason()?;
                    self.notes.add_at("face", name, &why, at);
                }
            }
        }
        // The law of closed shells: every edge is run once each way. Then edges tell the side, and normals against them are wrong.
        if is_closed && runs.values().all(|ways| *ways == [1, 1]) {
            for at in against {
                faces[at].0.is_reversed ^= true;
                self.notes.add("face", name, "the normal is against the bounds and is turned");
            }
        }
        let part = Part { name: name.to_owned(), faces, is_closed };
        Ok((!part.faces.is_empty()).then_some(part))
    }

    /// Faces of an item, and whether they close a body.
    pub fn uses(&self, item: u64, colour: FaceColour) -> Read<(Vec<Use>, bool)> {
        let kind = self.file.kind(item, &BODIES)?;
        let fields = self.file.expect(item, kind)?;
        let colour = self.styles.of(item).or(colour);
        let mut uses = Vec::new();
        let is_closed = match kind {
            "MANIFOLD_SOLID_BREP" | "FACETED_BREP" | "BREP_WITH_VOIDS" => {
                let mut shells = vec![fields.reference(1)?];
                if kind == "BREP_WITH_VOIDS" {
                    shells.extend(fields.references(2)?);
                }
                for shell in shells {
                    self.shell(shell, false, colour, &mut uses)?;
                }
                true
            }
            "SHELL_BASED_SURFACE_MODEL" | "FACE_BASED_SURFACE_MODEL" => {
                let mut is_closed = true;
                for shell in fields.references(1)? {
                    is_closed &= self.shell(shell, false, colour, &mut uses)?;
                }
                is_closed
            }
            "ADVANCED_FACE" | "FACE_SURFACE" => {
                uses.push(Use { face: item, is_flipped: false, colour });
                false
            }
            _ => self.shell(item, false, colour, &mut uses)?,
        };
        Ok((uses, is_closed))
    }

    /// Appends the faces of a shell; gives whether it is a closed one.
    fn shell(&self, id: u64, is_flipped: bool, colour: FaceColour, uses: &mut Vec<Use>) -> Read<bool> {
        for kind in ["ORIENTED_CLOSED_SHELL", "ORIENTED_OPEN_SHELL"] {
            if let Some(fields) = self.file.fields(id, kind) {
                let colour = self.styles.of(id).or(colour);
                let inner = fields.reference(2)?;
                if self.file.is(inner, kind) {
                    return Err(Flaw::UnreadAt(id, "a turned shell is turned again".into()));
                }
                return self.shell(inner, is_flipped == fields.flag(3), colour, uses);
            }
        }
        let kinds = ["CLOSED_SHELL", "OPEN_SHELL", "CONNECTED_FACE_SET"];
        let kind = self.file.kind(id, &kinds)?;
        if !kinds.contains(&kind) {
            return Err(Flaw::Unread(format!("{}s are not read as shells", spoken(kind))));
        }
        let faces = self.file.expect(id, kind)?.references(1)?;
        self.file.spend(faces.len())?;
        let colour = self.styles.of(id).or(colour);
        uses.extend(faces.into_iter().map(|face| Use { face, is_flipped, colour }));
        Ok(kind == "CLOSED_SHELL")
    }

    /// A face.
    fn face(&mut self, units: Units, face: &Use) -> Read<FaceRead> {
        let (mut id, mut is_flipped) = (face.face, face.is_flipped);
        let mut colour = self.styles.of(id);
        if let Some(fields) = self.file.fields(id, "ORIENTED_FACE") {
            id = fields.reference(2)?;
            is_flipped ^= !fields.flag(3);
            colour = colour.or(self.styles.of(id));
        }
        let bounded = self.bounded(units, id)?;
        // Whether the surface read has the face's normal.
        let agrees = bounded.same_sense != bounded.placed.is_flipped;
        let mut bounds = bounded.bounds;
        if !agrees {
            bounds.iter_mut().for_each(turn);
        }
        let trimmed = Geometry { file: self.file, units }.trim(bounded.placed, &bounds)?;
        let is_reversed = agrees == is_flipped;
        let runs = bounded.runs.into_iter().map(|(edge, forward)| (edge, forward != is_flipped)).collect();
        Ok(FaceRead {
            face: Face { surface: trimmed.surface, is_reversed, loops: trimmed.loops },
            colour: colour.or(face.colour),
            is_off: trimmed.is_off,
            is_against: trimmed.is_against,
            runs,
        })
    }

    /// Surface and bounds of a face.
    pub fn bounded(&mut self, units: Units, id: u64) -> Read<Bounded> {
        let geometry = Geometry { file: self.file, units };
        let kind = self.file.kind(id, &["ADVANCED_FACE", "FACE_SURFACE", "FACE"])?;
        if !["ADVANCED_FACE", "FACE_SURFACE", "FACE"].contains(&kind) {
            return Err(Flaw::Unread(format!("{}s are not read as faces", spoken(kind))));
        }
        let fields = self.file.expect(id, kind)?;
        let mut bounds = Vec::new();
        let mut runs = Vec::new();
        let mut corners = None;
        for bound in fields.references(1)? {
            let kind = self.file.kind(bound, &["FACE_OUTER_BOUND", "FACE_BOUND"])?;
            let fields = self.file.expect(bound, kind)?;
            let at = fields.reference(1)?;
            let mut edges = if let Some(fields) = self.file.fields(at, "EDGE_LOOP") {
                self.edge_loop(&geometry, fields.references(1)?, fields.id)?
            } else if let Some(fields) = self.file.fields(at, "POLY_LOOP") {
                let places = fields.references(1)?.into_iter().map(|id| geometry.point(id));
                let places = places.collect::<Read<Vec<_>>>()?;
                self.file.spend(places.len())?;
                corners = corners.or_else(|| Some(places.clone()));
                poly_loop(&places)
            } else if self.file.is(at, "VERTEX_LOOP") {
                Vec::new()
            } else {
                let kind = self.file.kind(at, &[])?;
                return Err(Flaw::Unread(format!("{}s are not read as bounds", spoken(kind))));
            };
            if !fields.flag(2) {
                turn_runs(&mut edges);
            }
            runs.extend(edges.iter().map(|(id, _, forward)| (*id, *forward)));
            bounds.push(edges.into_iter().map(|(_, edge, forward)| (edge, forward)).collect::<Bound>());
        }
        // Vertices alone bound nothing.
        bounds.retain(|bound| !bound.is_empty());
        if kind != "FACE" {
            let placed = geometry.surface(fields.reference(2)?)?;
            return Ok(Bounded { placed, same_sense: fields.flag(3), bounds, runs });
        }
        let plane = corners.and_then(|corners| plane_through(&corners));
        let plane = plane.ok_or_else(|| Flaw::Unread("faces without a surface are not read".into()))?;
        let placed = Placed {
            surface: Surface::Plane(plane),
            is_flipped: false,
            ids: Vec::new(),
            scale: DVec2::ONE,
            window: None,
        };
        Ok(Bounded { placed, same_sense: true, bounds, runs })
    }

    fn edge_loop(
        &mut self,
        geometry: &Geometry<'_>,
        list: Vec<u64>,
        id: u64,
    ) -> Read<Vec<(u64, Rc<Edge>, bool)>> {
        self.file.spend(list.len())?;
        let mut edges = Vec::with_capacity(list.len());
        for run in list {
            let fields = self.file.fields(run, "ORIENTED_EDGE");
            let (edge_id, forward) = match &fields {
                Some(fields) => (fields.reference(3)?, fields.flag(4)),
                None => (run, true),
            };
            if self.file.is(edge_id, "ORIENTED_EDGE") {
                return Err(Flaw::UnreadAt(id, "a turned edge is turned again".into()));
            }
            let key = (edge_id, geometry.units.length.to_bits());
            let edge = match self.edges.get(&key) {
                Some(edge) => edge.clone(),
                None => {
                    let edge = geometry.edge(edge_id)?.map(Rc::new);
                    self.edges.insert(key, edge.clone());
                    edge
                }
            };
            edges.extend(edge.map(|edge| (edge_id, edge, forward)));
        }
        if edges.is_empty() { Err(Flaw::Unread("bounds have no length".into())) } else { Ok(edges) }
    }
}

/// Runs a bound the other way.
fn turn(bound: &mut Bound) {
    bound.reverse();
    bound.iter_mut().for_each(|(_, forward)| *forward = !*forward);
}

fn turn_runs(bound: &mut [(u64, Rc<Edge>, bool)]) {
    bound.reverse();
    bound.iter_mut().for_each(|(_, _, forward)| *forward = !*forward);
}

/// Straight edges through points; they have no number.
fn poly_loop(places: &[DVec3]) -> Vec<(u64, Rc<Edge>, bool)> {
    let next = places.iter().cycle().skip(1);
    let pairs = places.iter().zip(next).filter(|(from, to)| from != to);
    let edge = |(from, to): (&DVec3, &DVec3)| {
        let edge = Edge { path: Path::straight(*from, *to), pcurves: Vec::new() };
        (0, Rc::new(edge), true)
    };
    pairs.map(edge).collect()
}

/// The plane of a polygon, its normal that about which it runs counter-clockwise (M. E. Newell).
fn plane_through(corners: &[DVec3]) -> Option<Frame> {
    let first = *corners.first()?;
    let next = corners.iter().cycle().skip(1);
    let normal: DVec3 = corners.iter().zip(next).map(|(a, b)| (*a - first).cross(*b - first)).sum();
    let reference = corners.iter().map(|corner| *corner - first).find(|side| *side != DVec3::ZERO)?;
    Frame::new(first, normal, reference)
}
