//! Lightmap of a fixed solution: irradiance on charts of the surfaces, in one texture. Optional sections; readers without
//! support show the light between the points.
//!
//! | section | contents |
//! |---|---|
//! | `LMAP` | [`LightmapLayout`], bincode 2 standard configuration |
//! | `LMUV` | [`TexelCoordinates`] of each vertex |
//! | `LMOF` | [`ChartOffset`] of triangles without copies, then of each entry of `INST` |
//! | `LMTX` | texels, rgb9e5, row after row from v = 0; a layer for each column of the [light groups](super::light_groups) |
//!
//! A chart is the unit square of a face's virtual mesh (Alonso et al. 2001): nothing is unwrapped. The charts of all
//! copies of a model are arranged alike, at offsets of their own.

#[cfg(feature = "radiosity")]
use super::limits::sane;
use super::{RbnError, small};
use bincode::{Decode, Encode};
use bytemuck::{Pod, Zeroable};
use glam::{UVec2, Vec2};
use std::ops::Range;

/// Steps of coordinates in a texel.
pub const STEPS: u32 = 16;
/// Greatest width and height, texels: coordinates have 16 bits.
pub const MAX_SIDE: u32 = 4096;
/// Maximum number of layers: that of a texture array which WebGPU guarantees.
pub const MAX_LAYERS: usize = 256;

/// Where a vertex is in the lightmap, before the [`ChartOffset`]: u and v in 16ths of a texel; row 0 is at v = 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Pod, Zeroable)]
#[repr(C)]
pub struct TexelCoordinates(pub [u16; 2]);

impl TexelCoordinates {
    /// Of vertices without a chart: their triangles show the light of the points.
    pub const NONE: Self = Self([u16::MAX; 2]);

    /// Rounds coordinates in texels.
    pub fn nearest(texels: Vec2) -> Self {
        let steps = (texels * STEPS as f32).round().clamp(Vec2::ZERO, Vec2::splat(65534.0));
        Self([steps.x as u16, steps.y as u16])
    }

    /// Coordinates in texels; `None` without a chart.
    pub fn texels(self) -> Option<Vec2> {
        (self != Self::NONE).then(|| Vec2::from(self.0.map(f32::from)) / STEPS as f32)
    }
}

/// What is added to coordinates, texels: x and y on fronts, then on backs of two-sided surfaces. The front is the side of the
/// shading normals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct ChartOffset(pub [u16; 4]);

impl ChartOffset {
    /// The offset of one side, texels.
    pub fn of_side(self, is_back: bool) -> UVec2 {
        let [x, y, back_x, back_y] = self.0.map(u32::from);
        if is_back { UVec2::new(back_x, back_y) } else { UVec2::new(x, y) }
    }
}

/// A texel, rgb9e5: irradiance per unit strength of the light, over the layer's scale.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub struct Texel(pub u32);

/// Size and scales.
#[derive(Clone, Debug, Default, PartialEq, Encode, Decode)]
pub struct LightmapLayout {
    /// Width and height, texels.
    pub size: [u32; 2],
    /// By layer, the factor of the texels. Above 0.
    pub scales: Vec<f32>,
}

/// Lightmap of a file; empty if it has none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lightmap {
    /// Size and scales.
    pub layout: LightmapLayout,
    /// By vertex.
    pub coordinates: Vec<TexelCoordinates>,
    /// Of triangles without copies, then by instance.
    pub offsets: Vec<ChartOffset>,
    /// Layer after layer, row after row.
    pub texels: Vec<Texel>,
}

impl Lightmap {
    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.layout.scales.is_empty()
    }

    /// Offsets by copy of triangles with this range of instances; an empty range is of those without copies. Empty without a
    /// lightmap.
    pub fn offsets_of(&self, copies: Range<usize>) -> &[ChartOffset] {
        self.offsets.get(offsets_of(copies)).unwrap_or_default()
    }

    /// Number of texels of a layer.
    pub fn area(&self) -> usize {
        self.layout.size[0] as usize * self.layout.size[1] as usize
    }

    /// The texels of a layer.
    pub fn layer(&self, layer: usize) -> &[Texel] {
        &self.texels[layer * self.area()..][..self.area()]
    }
}

/// Where section `LMOF` has the offsets of triangles with this range of instances, which is empty for those without copies.
pub fn offsets_of(copies: Range<usize>) -> Range<usize> {
    if copies.is_empty() { 0..1 } else { copies.start + 1..copies.end + 1 }
}

/// Encodes section `LMAP`.
///
/// # Errors
/// [`RbnError::TooLarge`] past [`MAX_BYTES`](super::limits::MAX_BYTES).
pub fn encode(layout: &LightmapLayout) -> Result<Vec<u8>, RbnError> {
    small::encode(layout, || "a lightmap has too many layers: solve for fewer lights".to_owned())
}

/// Decodes section `LMAP`; the caller checks it.
///
/// # Errors
/// [`RbnError::Invalid`].
pub fn decode(bytes: &[u8]) -> Result<LightmapLayout, RbnError> {
    small::decode("LMAP", bytes)
}

/// Checks a lightmap of unknown origin, for a file with so many columns of light, vertices and instances.
///
/// # Errors
/// [`RbnError::Invalid`].
#[cfg(feature = "radiosity")]
pub(crate) fn check(
    lightmap: &Lightmap,
    columns: usize,
    vertices: usize,
    instances: usize,
) -> Result<(), RbnError> {
    if *lightmap == Lightmap::default() {
        return Ok(());
    }
    let LightmapLayout { size, scales } = &lightmap.layout;
    if !size.iter().all(|side| (1..=MAX_SIDE).contains(side)) {
        return Err(RbnError::invalid("LMAP", format!("its size is {} x {}", size[0], size[1])));
    }
    if scales.len() != columns || columns == 0 || columns > MAX_LAYERS {
        return Err(RbnError::invalid(
            "LMAP",
            format!("{} layers for {columns} columns of light", scales.len()),
        ));
    }
    if !scales.iter().all(|scale| sane(*scale) && scale.is_normal() && *scale > 0.0) {
        return Err(RbnError::invalid("LMAP", "a scale is not above 0, or far too large"));
    }
    if lightmap.coordinates.len() != vertices {
        return Err(RbnError::invalid("LMUV", "it does not fit the vertices"));
    }
    if lightmap.offsets.len() != instances + 1 {
        return Err(RbnError::invalid("LMOF", "it does not fit the instances"));
    }
    if lightmap.area().checked_mul(columns) != Some(lightmap.texels.len()) {
        return Err(RbnError::invalid("LMTX", "it does not fit the lightmap's size and layers"));
    }
    Ok(())
}
