//! The .rbn file: a scene baked to be relit. docs/FORMAT.md describes it for other readers.
//!
//! * [`container`] – header, section table, checksums;
//! * [`meta`] – the small metadata (bincode);
//! * [`extras`] – what few materials have; [`shown`] – names, and the ground under an object;
//! * [`bulk`] – the records of the bulk sections as they are in memory and on the GPU;
//! * [`codec`] – how the sections are packed in the file;
//! * [`LinkMatrix`] – transport links by receiver;
//! * [`limits`] – what a reader refuses.
//!
//! A whole file in memory is a [`BakedScene`](crate::baked::BakedScene).

pub mod bulk;
pub mod codec;
pub mod container;
pub mod extras;
pub mod limits;
mod matrix;
pub mod meta;
pub mod shown;
mod texture;

pub use limits::{LARGEST, MAX_COPIES, MAX_LEVELS, MAX_MATERIALS, MAX_ROW, MAX_TRIANGLES};
pub use matrix::LinkMatrix;

/// Names of the sections, in file order.
pub const SECTIONS: [[u8; 4]; 8] =
    [*b"META", *b"VERT", *b"INDX", *b"PNTS", *b"CUTS", *b"LINK", *b"LATL", *b"TEXD"];
/// Those that files with copies have besides, after the others.
pub const COPY_SECTIONS: [[u8; 4]; 2] = [*b"INST", *b"COPY"];
/// The one that files have besides, after these, where a material has [extras].
pub const EXTRAS_SECTION: [u8; 4] = *b"MATX";
/// The optional section for the points' openness, after the others.
pub const OPENNESS_SECTION: [u8; 4] = *b"OPEN";
/// The one that files have besides, last, where there are names or a ground: see [shown].
pub const SHOWN_SECTION: [u8; 4] = *b"SHOW";

/// Why a .rbn file could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum RbnError {
    /// The first bytes are not those of a .rbn file.
    #[error("this is not a .rbn file; make one with `rebounce bake SCENE.glb -o FILE.rbn`")]
    NotRbn,
    /// Written by a newer Rebounce.
    #[error(
        "the file was written by {writer} in format version {found}; this Rebounce is older and reads version \
         {supported}: update it, or bake the scene again with this one"
    )]
    NewerVersion {
        /// Program and version that wrote the file, as it says itself.
        writer: String,
        /// The file's version.
        found: u32,
        /// The version that this code reads.
        supported: u32,
    },
    /// Written by an older Rebounce whose files are no longer read.
    #[error(
        "the file was written by {writer} in format version {found}; this Rebounce reads version {supported}: bake \
         its scene again with `rebounce bake SCENE.glb -o FILE.rbn`"
    )]
    OlderVersion {
        /// Program and version that wrote the file, as it says itself.
        writer: String,
        /// The file's version.
        found: u32,
        /// The version that this code reads.
        supported: u32,
    },
    /// The file ends before its header or a section does.
    #[error(
        "the file is cut short: {expected} bytes were written, {found} are there; download or copy it again"
    )]
    Truncated {
        /// The bytes that the header promises.
        expected: u64,
        /// The bytes present.
        found: u64,
    },
    /// A checksum does not match.
    #[error("section {section} is damaged (its checksum does not match); download or copy the file again")]
    Checksum {
        /// The section's four-letter name.
        section: String,
    },
    /// Contents contradict each other.
    #[error("section {section} is invalid: {problem}; bake the scene again")]
    Invalid {
        /// The section's four-letter name.
        section: String,
        /// What is wrong.
        problem: String,
    },
    /// Too much for the format.
    #[error("{0}")]
    TooLarge(String),
}

impl RbnError {
    /// A short code for programs: the viewer's `error` event carries it.
    pub fn code(&self) -> &'static str {
        match self {
            RbnError::NotRbn => "not-rbn",
            RbnError::NewerVersion { .. } => "newer-version",
            RbnError::OlderVersion { .. } => "older-version",
            RbnError::Truncated { .. } => "truncated",
            RbnError::Checksum { .. } | RbnError::Invalid { .. } => "corrupt",
            RbnError::TooLarge(_) => "too-large",
        }
    }

    pub(crate) fn invalid(section: &str, problem: impl Into<String>) -> Self {
        RbnError::Invalid { section: section.to_owned(), problem: problem.into() }
    }
}
