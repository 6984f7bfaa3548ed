//! The stages of a bake.

/// Stage of a bake.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Building the BVH, finding a viewpoint.
    Bvh,
    /// Baking coarsely for a first preview; only if previews are wanted.
    Sketch,
    /// Placing points. Counts points.
    Points,
    /// Finding clip planes of supports, and footprints for direct light. Counts each point twice.
    ClipPlanes,
    /// Finding parents and children. Counts points.
    Hierarchy,
    /// Reading the surface colours of points. Counts points.
    Tints,
    /// Precomputing basis weights and light for tiles of the surfaces. Counts tiles.
    HitCache,
    /// Gathering the one-bounce links. Counts rays.
    Links,
    /// Computing the coarse transport matrix, the input of later bounces, after the links of the coarse levels. Counts
    /// coarse points.
    CoarseMatrix,
    /// Adding later bounces, after the links of the coarse levels. Counts coarse points.
    Multibounce,
    /// Gathering the links from the sky and from emissive surfaces. Counts points.
    Sources,
    /// Gathering glossy transfer from the sky. Counts points.
    Gloss,
    /// Computing direct light at the points. Counts points.
    DirectLight,
    /// Computing light transport by a solver without stages of its own.
    Transport,
    /// Assembling the file.
    Assemble,
}

impl Stage {
    /// Returns the stage's name for people, as in docs/glossary.md.
    pub fn label(self) -> &'static str {
        match self {
            Stage::Bvh => "building BVH",
            Stage::Sketch => "sketching preview",
            Stage::Points => "placing points",
            Stage::ClipPlanes => "finding clip planes",
            Stage::Hierarchy => "building hierarchy",
            Stage::Tints => "reading tints",
            Stage::HitCache => "filling hit cache",
            Stage::Links => "gathering links",
            Stage::CoarseMatrix => "coarse transport matrix",
            Stage::Multibounce => "multibounce",
            Stage::Sources => "gathering sources",
            Stage::Gloss => "gathering glossy transfer",
            Stage::DirectLight => "direct light",
            Stage::Transport => "solving transport",
            Stage::Assemble => "assembling file",
        }
    }
}
