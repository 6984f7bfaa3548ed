//! The .rbn file: a scene baked to be relit. docs/format/rbn.md describes it for other readers.
//!
//! * [`container`] – header, section table, checksums;
//! * [`meta`] – the small metadata (bincode);
//! * [`extras`] and `specular` – optional material properties; [`shown`] – names, and the ground under an object;
//! * [`sources`] – the sky and emissive surfaces; [`light_groups`] – light of a fixed solution;
//! * [`lightmap`] – the same as a texture;
//! * `gloss` – glossy transfer; `gloss_links` – its links from the scene's surfaces;
//! * `cube_maps` – surfaces around metals, for pictures to light;
//! * `rig` – meshes that animations deform;
//! * `diffuse_transfer` – from the environment to the points, in place of links; `clustered` – how either is compressed;
//! * [`groups`] – reconstruction groups, and the nodes that may move;
//! * [`bulk`] – the records of the bulk sections as they are in memory and on the GPU;
//! * [`codec`] – packing of the sections in the file;
//! * [`LinkMatrix`] – transport links by receiver;
//! * [`limits`] – limits enforced by a reader.
//!
//! A whole file in memory is a [`BakedScene`](crate::baked::BakedScene).

pub mod bulk;
#[cfg(feature = "radiosity")]
pub mod clustered;
pub mod codec;
pub mod container;
#[cfg(feature = "radiosity")]
pub mod cube_maps;
#[cfg(feature = "radiosity")]
pub mod diffuse_transfer;
pub mod extras;
#[cfg(feature = "radiosity")]
pub mod gloss;
#[cfg(feature = "radiosity")]
pub mod gloss_links;
pub mod groups;
pub mod light_groups;
pub mod lightmap;
pub mod limits;
mod matrix;
pub mod meta;
pub mod node_tracks;
#[cfg(feature = "radiosity")]
pub mod rig;
#[cfg(feature = "radiosity")]
pub mod rig_layout;
pub mod shown;
mod small;
pub mod sources;
#[cfg(feature = "radiosity")]
pub mod specular;
mod texture;

pub use limits::{LARGEST, MAX_COPIES, MAX_LEVELS, MAX_MATERIALS, MAX_ROW, MAX_TRIANGLES};
pub use matrix::LinkMatrix;

/// Names of the sections, in file order.
pub const SECTIONS: [[u8; 4]; 8] =
    [*b"META", *b"VERT", *b"INDX", *b"PNTS", *b"CUTS", *b"LINK", *b"LATL", *b"TEXD"];
/// Names of the sections of files with copies, after [`SECTIONS`].
pub const COPY_SECTIONS: [[u8; 4]; 2] = [*b"INST", *b"COPY"];
/// Name of the optional section of material [extras], after the sections above.
pub const EXTRAS_SECTION: [u8; 4] = *b"MATX";
/// Name of the optional section of how materials shine, after the sections above.
#[cfg(feature = "radiosity")]
pub const SPECULAR_SECTION: [u8; 4] = *b"MATG";
/// Name of the optional section of the points' openness, after the sections above.
pub const OPENNESS_SECTION: [u8; 4] = *b"OPEN";
/// Names of the optional sections of [sources] and of their links, after the sections above.
pub const SOURCE_SECTIONS: [[u8; 4]; 2] = [*b"SRCS", *b"SRCL"];
/// Names of the optional sections of [light groups](light_groups) and of their values, after the sections above.
pub const GROUP_SECTIONS: [[u8; 4]; 2] = [*b"LGRP", *b"LVAL"];
/// Names of the optional sections of a [lightmap], after those of light groups.
pub const LIGHTMAP_SECTIONS: [[u8; 4]; 4] = [*b"LMAP", *b"LMUV", *b"LMOF", *b"LMTX"];
/// Names of the optional sections of [reconstruction groups](groups), of the materials' and the points' groups, and of the
/// points' reflectance, after the sections above.
pub const RECONSTRUCTION_SECTIONS: [[u8; 4]; 4] = [*b"RGRP", *b"MGRP", *b"PGRP", *b"REFL"];
/// Names of the optional sections of glossy transfer, after the sections above.
pub const GLOSS_SECTIONS: [[u8; 4]; 5] = [*b"GLSY", *b"GLPT", *b"GLCL", *b"GLWT", *b"GLBS"];
/// Names of the optional sections of glossy links and of the offsets of their rows, after those of glossy transfer.
pub const GLOSS_LINK_SECTIONS: [[u8; 4]; 2] = [*b"GLLK", *b"GLLO"];
/// Names of the optional sections of diffuse transfer, after those of glossy links.
pub const DIFFUSE_SECTIONS: [[u8; 4]; 4] = [*b"DTLY", *b"DTCL", *b"DTWT", *b"DTBS"];
/// Names of the optional sections of cube maps, after those of diffuse transfer.
pub const CUBE_MAP_SECTIONS: [[u8; 4]; 2] = [*b"CMLY", *b"CMTX"];
/// Names of the optional sections of a rig, after those of cube maps.
#[cfg(feature = "radiosity")]
pub const RIG_SECTIONS: [[u8; 4]; 4] = [*b"RIGL", *b"RIGV", *b"RIGM", *b"RIGP"];
/// Name of the optional section of names and ground, last: see [shown].
pub const SHOWN_SECTION: [u8; 4] = *b"SHOW";

/// Error in reading or writing a .rbn file.
#[derive(Debug, thiserror::Error)]
pub enum RbnError {
    /// Wrong magic bytes.
    #[error("this is not a .rbn file; make one with `rebounce bake SCENE.glb -o FILE.rbn`")]
    NotRbn,
    /// Written by a newer Rebounce.
    #[error(
        "the file was written by {writer} in format version {found}; this Rebounce is older and reads version \
         {supported}: update it, or bake the scene again with this one"
    )]
    NewerVersion {
        /// Program and version of the writer, as stored in the file.
        writer: String,
        /// The file's version.
        found: u32,
        /// Version supported by the reader.
        supported: u32,
    },
    /// Written by an older Rebounce in an unsupported version.
    #[error(
        "the file was written by {writer} in format version {found}; this Rebounce reads version {supported}: bake \
         its scene again with `rebounce bake SCENE.glb -o FILE.rbn`"
    )]
    OlderVersion {
        /// Program and version of the writer, as stored in the file.
        writer: String,
        /// The file's version.
        found: u32,
        /// Version supported by the reader.
        supported: u32,
    },
    /// File shorter than its header or sections.
    #[error(
        "the file is cut short: {expected} bytes were written, {found} are there; download or copy it again"
    )]
    Truncated {
        /// Length in the header, bytes.
        expected: u64,
        /// Actual length, bytes.
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
        /// Description of the error.
        problem: String,
    },
    /// Scene beyond a limit of the format.
    #[error("{0}")]
    TooLarge(String),
}

impl RbnError {
    /// Returns a short error code for programs, used by the viewer's `error` event.
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
