//! Reader of STEP files (ISO 10303-21) with boundary representations after AP203, AP214 and AP242.
//!
//! - Solids (`manifold_solid_brep`, `brep_with_voids`, `faceted_brep`) and surface models
//!   (`shell_based_surface_model`, `face_based_surface_model`) become a [`Part`](crate::model::Part) each, once, however often
//!   the assembly has them. What cannot be read is counted and named in [`Assembly::notes`].
//! - A part's coordinates are metres along the file's axes; lengths are scaled as they are read. The turn from z up to y up,
//!   (x, y, z) → (x, z, −y), is part of [`PartInstance::world_from_part`](crate::model::PartInstance::world_from_part), with
//!   the placements of the assembly.
//! - Names are those of products. Colours are those of styled faces, shells, solids and representations, the innermost first.
//!   The numbers of a `colour_rgb` are taken as linear RGB, as kernels such as Open CASCADE hold them. Transparency, layers and colours of single
//!   occurrences are left out.
//! - Where the normal of a face in a closed shell contradicts its edges, the edges are followed, and noted.
//! - Trimming loops come from the edges in space: each is sampled, mapped to the surface's parameters (by its pcurve where
//!   that agrees with it, else by its nearest point) and halved until straight segments in the parameter plane stand off it by
//!   less than 1e-5 of the face's size, measured on the surface. What is straight there becomes one segment; circles, and
//!   ellipses along the axes, on planes become arcs.

mod curves;
mod file;
mod loops;
mod path;
mod period;
mod plane;
mod poles;
mod product;
mod project;
mod splines;
mod style;
mod surfaces;
#[cfg(test)]
mod tests;
mod topology;
mod units;

use crate::model::Assembly;
use std::collections::BTreeMap;

/// Why a file could not be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StepError {
    /// It does not follow ISO 10303-21, or has a number beyond double precision.
    #[error("not a STEP file that can be read ({0}): export it again as AP203, AP214 or AP242")]
    Syntax(String),
    /// An assembly that contains itself.
    #[error("the assembly {0:?} contains itself: export it again without that occurrence")]
    Cycle(String),
    /// Deeper nesting than any honest file has.
    #[error("assemblies or mapped items are nested deeper than {0}: flatten the assembly before export")]
    TooDeep(usize),
    /// More work than a reader should do for one file.
    #[error(
        "the file's faces and occurrences are too many to read at once: export parts of the assembly by themselves"
    )]
    TooLarge,
    /// Neither solids nor surfaces.
    #[error(
        "the file has no solid and no surface model: export the boundary representation, not wires or meshes"
    )]
    Empty,
}

/// Why one item was not read.
enum Flaw {
    /// It is left out: a note says so.
    Unread(String),
    /// It is left out, because of the entity of this number.
    UnreadAt(u64, String),
    /// The file is refused.
    Stop(StepError),
}

impl From<StepError> for Flaw {
    fn from(error: StepError) -> Self {
        Self::Stop(error)
    }
}

impl Flaw {
    /// The reason for a note, and the entity that is at fault if one is; else the error.
    fn reason(self) -> Result<(String, Option<u64>), StepError> {
        match self {
            Self::Unread(why) => Ok((why, None)),
            Self::UnreadAt(id, why) => Ok((why, Some(id))),
            Self::Stop(error) => Err(error),
        }
    }
}

/// What reading an item gives.
type Read<T> = Result<T, Flaw>;

/// Notes, the same ones counted.
#[derive(Default)]
struct Notes(BTreeMap<(String, String), Count>);

/// How often the same is noted, of what, and the first entity at fault.
struct Count {
    count: usize,
    thing: &'static str,
    first: Option<u64>,
}

impl Notes {
    /// One more `thing` of `owner` is left out.
    fn add(&mut self, thing: &'static str, owner: &str, why: &str) {
        self.add_at(thing, owner, why, None);
    }

    /// The same, because of an entity.
    fn add_at(&mut self, thing: &'static str, owner: &str, why: &str, at: Option<u64>) {
        let key = (owner.to_owned(), why.to_owned());
        self.0.entry(key).or_insert(Count { count: 0, thing, first: at }).count += 1;
    }

    fn sentences(self) -> Vec<String> {
        let sentence = |((owner, why), Count { count, thing, first }): ((String, String), Count)| {
            let plural = match (count, thing.strip_suffix('y')) {
                (1, _) => thing.to_owned(),
                (_, Some(stem)) => format!("{stem}ies"),
                (_, None) => format!("{thing}s"),
            };
            let owner = if owner.is_empty() { "the file".to_owned() } else { format!("{owner:?}") };
            let first = first.map(|id| format!(" (#{id})")).unwrap_or_default();
            format!("{count} {plural} of {owner}: {why}{first}")
        };
        self.0.into_iter().map(sentence).collect()
    }
}

/// Reads a STEP file.
///
/// # Errors
///
/// If the text is no STEP file, has no solid or surface, or is built to exhaust the reader: see [`StepError`]. Single faces
/// that cannot be read are no error; [`Assembly::notes`] names them.
pub fn read(bytes: &[u8]) -> Result<Assembly, StepError> {
    let file = file::File::parse(bytes)?;
    product::read(&file)
}
