//! Optional sections that only readers with the feature `radiosity` know.

use super::{BakedScene, packed_bytes, records, unpacked_bytes};
use crate::rbn::codec::{MOST_TIMES, columns};
use crate::rbn::cube_maps::{self, CubeMaps};
use crate::rbn::diffuse_transfer::{self, DiffuseTransfer};
use crate::rbn::gloss::{self, Gloss};
use crate::rbn::light_groups::{self, LightGroups};
use crate::rbn::lightmap::{self, Lightmap};
use crate::rbn::rig_layout::Rig;
use crate::rbn::{
    CUBE_MAP_SECTIONS, DIFFUSE_SECTIONS, GLOSS_LINK_SECTIONS, GLOSS_SECTIONS, GROUP_SECTIONS,
    LIGHTMAP_SECTIONS, LinkMatrix, RIG_SECTIONS, RbnError, SPECULAR_SECTION, groups, rig, specular,
};

/// A section's name and bytes.
pub(super) type NamedSection = ([u8; 4], Vec<u8>);

impl BakedScene {
    /// Packs the sections of the lightmap; none without one.
    pub(super) fn lightmap_sections(&self) -> Result<Vec<NamedSection>, RbnError> {
        let Lightmap { layout, coordinates, offsets, texels } = &self.lightmap;
        if self.lightmap.is_empty() {
            return Ok(Vec::new());
        }
        let packed = [
            lightmap::encode(layout)?,
            columns::encode(coordinates),
            columns::encode(offsets),
            columns::encode(texels),
        ];
        Ok(LIGHTMAP_SECTIONS.into_iter().zip(packed).collect())
    }

    /// Packs the sections of glossy transfer; none without it.
    pub(super) fn gloss_sections(&self) -> Result<Vec<NamedSection>, RbnError> {
        let Gloss { layout, points, clusters, weights, vectors, links } = &self.gloss;
        if self.gloss.is_empty() {
            return Ok(Vec::new());
        }
        let packed = |bytes: &[u8]| packed_bytes(bytes).unwrap_or_default();
        let sections = [
            gloss::encode(layout)?,
            columns::encode(points),
            packed(clusters),
            packed(weights),
            packed(vectors),
        ];
        let mut out: Vec<NamedSection> = GLOSS_SECTIONS.into_iter().zip(sections).collect();
        if !links.is_empty() {
            let packed = [columns::encode(&links.links), columns::encode(&links.offsets)];
            out.extend(GLOSS_LINK_SECTIONS.into_iter().zip(packed));
        }
        Ok(out)
    }

    /// Packs the sections of diffuse transfer; none without it.
    pub(super) fn transfer_sections(&self) -> Result<Vec<NamedSection>, RbnError> {
        let DiffuseTransfer { layout, clusters, weights, vectors } = &self.diffuse_transfer;
        if self.diffuse_transfer.is_empty() {
            return Ok(Vec::new());
        }
        let packed = |bytes: &[u8]| packed_bytes(bytes).unwrap_or_default();
        let sections =
            [diffuse_transfer::encode(layout)?, packed(clusters), packed(weights), packed(vectors)];
        Ok(DIFFUSE_SECTIONS.into_iter().zip(sections).collect())
    }

    /// Packs the sections of cube maps; none without them.
    pub(super) fn cube_map_sections(&self) -> Result<Vec<NamedSection>, RbnError> {
        let CubeMaps { layout, texels } = &self.cube_maps;
        if self.cube_maps.is_empty() {
            return Ok(Vec::new());
        }
        let packed = [cube_maps::encode(layout)?, columns::encode(texels)];
        Ok(CUBE_MAP_SECTIONS.into_iter().zip(packed).collect())
    }

    /// Packs the sections of a rig; none without it.
    pub(super) fn rig_sections(&self) -> Result<Vec<NamedSection>, RbnError> {
        let Rig { layout, vertices, deltas, points } = &self.rig;
        if self.rig.is_empty() {
            return Ok(Vec::new());
        }
        let packed = [
            rig::encode(layout)?,
            columns::encode(vertices),
            columns::encode(deltas),
            columns::encode(points),
        ];
        Ok(RIG_SECTIONS.into_iter().zip(packed).collect())
    }

    /// Reads the sections of specular extras, of fixed solutions, of lightmaps, of glossy and diffuse transfer, of cube maps, of
    /// a rig, of groups and of reflectances.
    pub(super) fn read_groups<'f>(
        &mut self,
        has: &dyn Fn([u8; 4]) -> bool,
        bytes: &dyn Fn([u8; 4]) -> Result<&'f [u8], RbnError>,
    ) -> Result<(), RbnError> {
        if has(SPECULAR_SECTION) {
            let materials = self.meta.materials.iter_mut();
            let mut all: Vec<_> = materials.map(|material| &mut material.specular_extras).collect();
            specular::decode(bytes(SPECULAR_SECTION)?, &mut all)?;
        }
        if GROUP_SECTIONS.into_iter().any(has) {
            self.light_groups = LightGroups {
                groups: light_groups::decode(bytes(*b"LGRP")?)?,
                values: records("LVAL", bytes(*b"LVAL")?)?,
            };
        }
        if LIGHTMAP_SECTIONS.into_iter().any(has) {
            self.lightmap = Lightmap {
                layout: lightmap::decode(bytes(*b"LMAP")?)?,
                coordinates: records("LMUV", bytes(*b"LMUV")?)?,
                offsets: records("LMOF", bytes(*b"LMOF")?)?,
                texels: records("LMTX", bytes(*b"LMTX")?)?,
            };
        }
        let unpacked = |name: [u8; 4]| {
            let packed = bytes(name)?;
            let most = packed.len().saturating_mul(MOST_TIMES);
            let name = String::from_utf8_lossy(&name);
            if packed.is_empty() { Ok(Vec::new()) } else { unpacked_bytes(&name, packed, most) }
        };
        if DIFFUSE_SECTIONS.into_iter().any(has) {
            self.diffuse_transfer = DiffuseTransfer {
                layout: diffuse_transfer::decode(bytes(*b"DTLY")?)?,
                clusters: unpacked(*b"DTCL")?,
                weights: unpacked(*b"DTWT")?,
                vectors: unpacked(*b"DTBS")?,
            };
        }
        if GLOSS_SECTIONS.into_iter().chain(GLOSS_LINK_SECTIONS).any(has) {
            let links = match GLOSS_LINK_SECTIONS.into_iter().any(has) {
                true => LinkMatrix {
                    links: records("GLLK", bytes(*b"GLLK")?)?,
                    offsets: records("GLLO", bytes(*b"GLLO")?)?,
                },
                false => LinkMatrix::default(),
            };
            self.gloss = Gloss {
                layout: gloss::decode(bytes(*b"GLSY")?)?,
                points: records("GLPT", bytes(*b"GLPT")?)?,
                clusters: unpacked(*b"GLCL")?,
                weights: unpacked(*b"GLWT")?,
                vectors: unpacked(*b"GLBS")?,
                links,
            };
        }
        if CUBE_MAP_SECTIONS.into_iter().any(has) {
            self.cube_maps = CubeMaps {
                layout: cube_maps::decode(bytes(*b"CMLY")?)?,
                texels: records("CMTX", bytes(*b"CMTX")?)?,
            };
        }
        if RIG_SECTIONS.into_iter().any(has) {
            self.rig = Rig {
                layout: rig::decode(bytes(*b"RIGL")?)?,
                vertices: records("RIGV", bytes(*b"RIGV")?)?,
                deltas: records("RIGM", bytes(*b"RIGM")?)?,
                points: records("RIGP", bytes(*b"RIGP")?)?,
            };
            if self.rig.is_empty() {
                return Err(RbnError::invalid("RIGL", "there is no mesh"));
            }
        }
        let mut of_material = Vec::new();
        if has(*b"MGRP") {
            of_material = records("MGRP", bytes(*b"MGRP")?)?;
            self.point_groups = records("PGRP", bytes(*b"PGRP")?)?;
        }
        if has(*b"RGRP") {
            self.groups = groups::decode(bytes(*b"RGRP")?, of_material)?;
        }
        if has(*b"REFL") {
            self.reflectance = unpacked_bytes("REFL", bytes(*b"REFL")?, self.points.len())?;
        }
        Ok(())
    }
}
