//! A baked scene in memory: reading, writing and validation of a .rbn file.

mod check;
mod moved;
#[cfg(feature = "radiosity")]
mod optional;

use crate::basis::{Functions, ParentWeights, Relations};
use crate::interpolation::Rows;
use crate::light::Light;
use crate::link::{LaterLink, Link, SourceLink};
use crate::openness::LEVELS;
use crate::rbn::LinkMatrix;
use crate::rbn::bulk::{Copies, Cut, Instance, Point, Vertex};
use crate::rbn::codec::{Damaged, Reader, Writer, columns, links};
#[cfg(feature = "radiosity")]
use crate::rbn::cube_maps::CubeMaps;
#[cfg(feature = "radiosity")]
use crate::rbn::diffuse_transfer::DiffuseTransfer;
#[cfg(feature = "radiosity")]
use crate::rbn::gloss::Gloss;
use crate::rbn::groups::{self, Groups};
use crate::rbn::light_groups::{self, LightGroups};
#[cfg(feature = "radiosity")]
use crate::rbn::lightmap::Lightmap;
use crate::rbn::meta::{self, Meta};
#[cfg(feature = "radiosity")]
use crate::rbn::rig_layout::Rig;
use crate::rbn::sources::{self, Sources};
#[cfg(feature = "radiosity")]
use crate::rbn::specular;
use crate::rbn::{RbnError, container, extras, shown};
use glam::Vec3;
use std::ops::Range;

/// Baked scene: contents of a .rbn file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BakedScene {
    /// Metadata: materials, cameras, levels, lights.
    pub meta: Meta,
    /// Vertices of the render geometry.
    pub vertices: Vec<Vertex>,
    /// Vertex indices, three per triangle, grouped by `meta.draws`.
    pub indices: Vec<u32>,
    /// Transforms of instanced triangles.
    pub instances: Vec<Instance>,
    /// Range of instances for each of `meta.draws`; empty without instanced triangles.
    pub copies: Vec<Copies>,
    /// Textures in their original compressed bytes, located by `meta.textures`.
    pub texture_bytes: Vec<u8>,
    /// Basis functions, level after level.
    pub points: Vec<Point>,
    /// Planes that end the points' supports.
    pub cuts: Vec<Cut>,
    /// [Openness](crate::openness) of the points, 0 to [`LEVELS`]; empty if unknown. Optional section `OPEN`: readers
    /// without support show the light between the points without detail.
    pub openness: Vec<u8>,
    /// Weighting of parents, determined by the version of the file.
    pub parent_weights: ParentWeights,
    /// Parents and children. Not in the file but derived from the points by [`Self::relate`].
    pub relations: Relations,
    /// T: from light sent by the senders to irradiance along the points' normals; a row per point of every level.
    pub links: LinkMatrix<Link>,
    /// Sources with links of their own: sky and emissive surfaces.
    pub sources: Sources,
    /// From strengths of the sources to irradiance along the points' normals; a row per point of every level, without
    /// sources no rows.
    pub source_links: LinkMatrix<SourceLink>,
    /// Reconstruction groups, and the nodes that may move.
    pub groups: Groups,
    /// Reconstruction group of each point; empty where all are of group 0.
    pub point_groups: Vec<u32>,
    /// Mean reflectance of the surface under each point, in 255ths; empty where bounced light comes from links or light groups
    /// alone. [Radiosity](crate::radiosity) is computed from it when surfaces have moved, or where there are no links.
    pub reflectance: Vec<u8>,
    /// Light of a fixed solution, in place of links; empty where lights may move.
    pub light_groups: LightGroups,
    /// The same light as a texture, if there is one.
    #[cfg(feature = "radiosity")]
    pub lightmap: Lightmap,
    /// What arrives at points of glossy surfaces from each direction, if there are any.
    #[cfg(feature = "radiosity")]
    pub gloss: Gloss,
    /// What is seen from places near metals, if there are any.
    #[cfg(feature = "radiosity")]
    pub cube_maps: CubeMaps,
    /// From the environment to irradiance along the points' normals, in place of links; empty where light comes by links.
    #[cfg(feature = "radiosity")]
    pub diffuse_transfer: DiffuseTransfer,
    /// Meshes that animations deform, if there are any; the other fields have them at rest.
    #[cfg(feature = "radiosity")]
    pub rig: Rig,
    /// H: from irradiance at the points of the coarse levels to irradiance of further bounces at the same points.
    pub later: LinkMatrix<LaterLink>,
}

#[cfg(feature = "radiosity")]
use crate::rbn::SPECULAR_SECTION;
use crate::rbn::{
    COPY_SECTIONS, EXTRAS_SECTION, GROUP_SECTIONS, OPENNESS_SECTION, RECONSTRUCTION_SECTIONS, SECTIONS,
    SHOWN_SECTION, SOURCE_SECTIONS,
};

impl BakedScene {
    /// The points of level `l`.
    pub fn level(&self, l: usize) -> Range<usize> {
        let level = &self.meta.levels[l];
        level.first as usize..(level.first + level.count) as usize
    }

    /// Number of senders: the points of the coarsest `sender_levels` levels.
    pub fn sender_count(&self) -> usize {
        self.first_of_level(self.meta.sender_levels)
    }

    /// Number of points at which direct light is sampled.
    pub fn direct_count(&self) -> usize {
        self.first_of_level(self.meta.direct_levels)
    }

    /// Number of points with rows of H: the points of the coarsest `later_levels` levels.
    pub fn later_count(&self) -> usize {
        self.first_of_level(self.meta.later_levels)
    }

    /// Number of transport links without links of later bounces.
    pub fn link_count(&self) -> usize {
        self.links.links.len()
    }

    /// Points interpolated in pictures: the points of the finest level.
    pub fn display(&self) -> Range<usize> {
        self.meta.levels.len().checked_sub(1).map_or(0..0, |finest| self.level(finest))
    }

    /// The planes that end the support of point `i`.
    pub fn cuts_of(&self, i: usize) -> &[Cut] {
        &self.cuts[self.points[i].cuts()]
    }

    fn first_of_level(&self, l: u32) -> usize {
        self.meta.levels.get(l as usize).map_or(self.points.len(), |level| level.first as usize)
    }

    /// The push matrix.
    pub fn push(&self) -> Rows<'_> {
        self.relations.push()
    }

    /// The pull matrix.
    pub fn pull(&self) -> Rows<'_> {
        self.relations.pull()
    }

    /// Reconstruction group of point `i`.
    #[inline]
    pub fn group_of(&self, i: usize) -> u32 {
        self.point_groups.get(i).copied().unwrap_or(0)
    }

    /// Recomputes the points' relations. The points must satisfy the rules of the format.
    ///
    /// # Errors
    /// [`RbnError`] for an excess of functions in one place.
    pub fn relate(&mut self) -> Result<(), RbnError> {
        let direct_levels = self.meta.direct_levels as usize;
        let Self { points, cuts, meta, parent_weights, point_groups, groups, .. } = self;
        let functions = Functions { points, cuts, levels: &meta.levels, groups: point_groups };
        self.relations = Relations::new(&functions, direct_levels, *parent_weights)?;
        if cfg!(feature = "radiosity") {
            self.relations
                .lookup
                .add_materials(meta.materials.len(), |material| groups.of_material(material));
        }
        Ok(())
    }

    /// Whether bounced light is computed by [radiosity](crate::radiosity): there are neither links nor light groups.
    #[inline]
    pub fn is_unlinked(&self) -> bool {
        cfg!(feature = "radiosity")
            && !self.reflectance.is_empty()
            && self.links.links.is_empty()
            && !self.is_precomputed()
    }

    /// Whether points have values in the place of links: a [fixed solution](Self::is_solved), or a file
    /// [for an environment](Self::is_for_environment).
    #[inline]
    pub fn is_precomputed(&self) -> bool {
        self.is_solved() || self.is_for_environment()
    }

    /// Whether the light of the environment comes by diffuse transfer, and there are no links.
    #[inline]
    pub fn is_for_environment(&self) -> bool {
        #[cfg(feature = "radiosity")]
        return !self.diffuse_transfer.is_empty();
        #[cfg(not(feature = "radiosity"))]
        false
    }

    /// Albedo of the surface under point `i`, linear RGB.
    pub fn albedo(&self, i: usize) -> Vec3 {
        self.points[i].tint() * (f32::from(self.reflectance[i]) / 255.0)
    }

    /// Whether the file has the light of lights that stay in place, and no links.
    #[inline]
    pub fn is_solved(&self) -> bool {
        cfg!(feature = "radiosity") && !self.light_groups.groups.is_empty()
    }

    /// Returns the lights that the groups of a fixed solution are for; `None` where lights may move.
    pub fn solved_lights(&self) -> Option<&[Light]> {
        self.is_solved().then_some(self.meta.lights.as_slice())
    }

    /// Range of `instances` of the triangles of draw call `i`; empty for triangles without copies, in local space.
    pub fn copies_of(&self, i: usize) -> Range<usize> {
        self.copies.get(i).map_or(0..0, Copies::range)
    }

    /// Number of triangles drawn, counted once per copy.
    pub fn triangles_placed(&self) -> u64 {
        let copies = |i: usize| self.copies_of(i).len().max(1) as u64;
        (0..).zip(&self.meta.draws).map(|(i, draw)| draw.index_count as u64 / 3 * copies(i)).sum()
    }

    /// The compressed bytes of texture `i`.
    pub fn texture(&self, i: usize) -> &[u8] {
        let t = &self.meta.textures[i];
        &self.texture_bytes[t.offset as usize..(t.offset + t.len) as usize]
    }

    /// Returns the format version of the file: the least version with the features used.
    pub fn version(&self) -> u32 {
        let has_extras = self.meta.materials.iter().any(|m| m.extras != extras::Extras::default());
        #[cfg(feature = "radiosity")]
        if !self.rig.is_empty() {
            return container::VERSION;
        }
        if self.is_for_environment() {
            return container::WITHOUT_RIG;
        }
        if !self.groups.is_empty() || !self.reflectance.is_empty() {
            return container::WITHOUT_TRANSFER;
        }
        if self.is_solved() || !self.meta.lights.iter().all(|light| light.kind().is_punctual()) {
            return container::ONE_GROUP;
        }
        match (self.parent_weights, has_extras, self.copies.is_empty()) {
            (ParentWeights::LeastSquares, ..) => container::PUNCTUAL_LIGHTS,
            (_, true, _) => container::SHEPARD_WEIGHTS,
            (_, false, false) => container::WITHOUT_EXTRAS,
            (_, false, true) => container::WITHOUT_COPIES,
        }
    }

    /// Returns the file's bytes.
    ///
    /// # Errors
    /// [`RbnError`] if the scene breaks a rule of the format.
    pub fn to_bytes(&self) -> Result<Vec<u8>, RbnError> {
        self.check()?;
        let packed: [Vec<u8>; 7] = [
            meta::encode(&self.meta)?,
            columns::encode(&self.vertices),
            columns::encode(&self.indices),
            columns::encode(&self.points),
            columns::encode(&self.cuts),
            links::encode(&self.links.offsets, &self.links.links),
            links::encode(&self.later.offsets, &self.later.links),
        ];
        let contents = packed.iter().map(Vec::as_slice).chain([self.texture_bytes.as_slice()]);
        let mut sections: Vec<_> = SECTIONS.into_iter().zip(contents).collect();
        let copied = [columns::encode(&self.instances), columns::encode(&self.copies)];
        if !self.copies.is_empty() {
            sections.extend(COPY_SECTIONS.into_iter().zip(copied.iter().map(Vec::as_slice)));
        }
        let extras = extras::encode(self.meta.materials.iter().map(|material| &material.extras))?;
        sections.extend(extras.iter().map(|bytes| (EXTRAS_SECTION, bytes.as_slice())));
        #[cfg(feature = "radiosity")]
        let specular =
            specular::encode(self.meta.materials.iter().map(|material| &material.specular_extras))?;
        #[cfg(feature = "radiosity")]
        sections.extend(specular.iter().map(|bytes| (SPECULAR_SECTION, bytes.as_slice())));
        let openness = packed_bytes(&self.openness);
        let reflectance = packed_bytes(&self.reflectance);
        sections.extend(openness.iter().map(|bytes| (OPENNESS_SECTION, bytes.as_slice())));
        let sources = sources::encode(&self.sources)?;
        let LinkMatrix { offsets, links: all } = &self.source_links;
        let source_links = if sources.is_some() { links::encode(offsets, all) } else { Vec::new() };
        if let Some(sources) = &sources {
            sections.extend(SOURCE_SECTIONS.into_iter().zip([sources.as_slice(), &source_links]));
        }
        let groups = light_groups::encode(&self.light_groups.groups)?;
        let values = columns::encode(&self.light_groups.values);
        if let Some(groups) = &groups {
            sections.extend(GROUP_SECTIONS.into_iter().zip([groups.as_slice(), &values]));
        }
        #[cfg(feature = "radiosity")]
        let of_lightmap = self.lightmap_sections()?;
        #[cfg(feature = "radiosity")]
        sections.extend(of_lightmap.iter().map(|(name, bytes)| (*name, bytes.as_slice())));
        let reconstruction = groups::encode(&self.groups)?;
        let of_groups = [columns::encode(&self.groups.of_material), columns::encode(&self.point_groups)];
        let [groups, of_materials, of_points, of_reflectance] = RECONSTRUCTION_SECTIONS;
        sections.extend(reconstruction.iter().map(|bytes| (groups, bytes.as_slice())));
        if !self.groups.is_empty() {
            sections.extend([of_materials, of_points].into_iter().zip(of_groups.iter().map(Vec::as_slice)));
        }
        sections.extend(reflectance.iter().map(|bytes| (of_reflectance, bytes.as_slice())));
        #[cfg(feature = "radiosity")]
        let of_gloss = self.gloss_sections()?;
        #[cfg(feature = "radiosity")]
        sections.extend(of_gloss.iter().map(|(name, bytes)| (*name, bytes.as_slice())));
        #[cfg(feature = "radiosity")]
        let of_transfer = self.transfer_sections()?;
        #[cfg(feature = "radiosity")]
        sections.extend(of_transfer.iter().map(|(name, bytes)| (*name, bytes.as_slice())));
        #[cfg(feature = "radiosity")]
        let of_cube_maps = self.cube_map_sections()?;
        #[cfg(feature = "radiosity")]
        sections.extend(of_cube_maps.iter().map(|(name, bytes)| (*name, bytes.as_slice())));
        #[cfg(feature = "radiosity")]
        let of_rig = self.rig_sections()?;
        #[cfg(feature = "radiosity")]
        sections.extend(of_rig.iter().map(|(name, bytes)| (*name, bytes.as_slice())));
        let shown = shown::encode(&self.meta.shown);
        sections.extend(shown.iter().map(|bytes| (SHOWN_SECTION, bytes.as_slice())));
        Ok(container::write(self.version(), &sections))
    }

    /// Reads a file: checks checksums, then every length, index and float, so that the scene can be used without
    /// further checks.
    ///
    /// # Errors
    /// [`RbnError`] for a truncated, damaged or inconsistent file.
    pub fn from_bytes(file: &[u8]) -> Result<Self, RbnError> {
        let sections = container::read(file)?;
        let bytes = |name: [u8; 4]| {
            sections
                .iter()
                .find(|s| s.name == name)
                .map(|s| &file[s.offset..s.offset + s.len])
                .ok_or_else(|| RbnError::invalid(&String::from_utf8_lossy(&name), "it is missing"))
        };
        let has = |name: [u8; 4]| sections.iter().any(|s| s.name == name);
        // Readers of an older version would draw a different scene.
        let version = container::version(file).unwrap_or_default();
        for (name, since) in container::SINCE {
            if has(*name) && version < *since {
                let name = String::from_utf8_lossy(name);
                return Err(RbnError::invalid(&name, "a file of this version has none"));
            }
        }
        let has_copies = has(*b"INST") || has(*b"COPY");
        let mut scene = Self {
            meta: meta::decode(bytes(*b"META")?)?,
            vertices: records("VERT", bytes(*b"VERT")?)?,
            indices: records("INDX", bytes(*b"INDX")?)?,
            instances: if has_copies { records("INST", bytes(*b"INST")?)? } else { Vec::new() },
            copies: if has_copies { records("COPY", bytes(*b"COPY")?)? } else { Vec::new() },
            points: records("PNTS", bytes(*b"PNTS")?)?,
            cuts: records("CUTS", bytes(*b"CUTS")?)?,
            openness: Vec::new(),
            parent_weights: match version {
                ..=container::SHEPARD_WEIGHTS => ParentWeights::Shepard,
                _ => ParentWeights::LeastSquares,
            },
            relations: Relations::default(),
            links: matrix("LINK", bytes(*b"LINK")?)?,
            later: matrix("LATL", bytes(*b"LATL")?)?,
            sources: Sources::default(),
            source_links: LinkMatrix::default(),
            groups: Groups::default(),
            point_groups: Vec::new(),
            reflectance: Vec::new(),
            light_groups: LightGroups::default(),
            #[cfg(feature = "radiosity")]
            lightmap: Lightmap::default(),
            #[cfg(feature = "radiosity")]
            gloss: Gloss::default(),
            #[cfg(feature = "radiosity")]
            cube_maps: CubeMaps::default(),
            #[cfg(feature = "radiosity")]
            diffuse_transfer: DiffuseTransfer::default(),
            #[cfg(feature = "radiosity")]
            rig: Rig::default(),
            texture_bytes: bytes(*b"TEXD")?.to_vec(),
        };
        if version <= container::PUNCTUAL_LIGHTS && scene.version() > container::PUNCTUAL_LIGHTS {
            return Err(RbnError::invalid("META", "a file of this version has only punctual lights"));
        }
        if has(EXTRAS_SECTION) {
            let mut all: Vec<_> =
                scene.meta.materials.iter_mut().map(|material| &mut material.extras).collect();
            extras::decode(bytes(EXTRAS_SECTION)?, &mut all)?;
        }
        if has(OPENNESS_SECTION) {
            scene.openness = unpacked_bytes("OPEN", bytes(OPENNESS_SECTION)?, scene.points.len())?;
        }
        if SOURCE_SECTIONS.into_iter().any(has) {
            scene.sources = sources::decode(bytes(*b"SRCS")?)?;
            scene.source_links = matrix("SRCL", bytes(*b"SRCL")?)?;
        }
        #[cfg(feature = "radiosity")]
        scene.read_groups(&has, &bytes)?;
        if has(SHOWN_SECTION) {
            let shown = shown::decode(bytes(SHOWN_SECTION)?);
            scene.meta.shown = shown.ok_or_else(|| RbnError::invalid("SHOW", "names or ground"))?;
        }
        scene.check()?;
        scene.relate()?;
        Ok(scene)
    }
}

impl BakedScene {
    /// Checks that openness is given for every point or for none.
    pub(super) fn check_openness(&self) -> Result<(), RbnError> {
        let is_sound = self.openness.is_empty()
            || self.openness.len() == self.points.len() && self.openness.iter().all(|v| *v <= LEVELS);
        if is_sound { Ok(()) } else { Err(RbnError::invalid("OPEN", "it does not fit the points")) }
    }
}

/// Packs a byte per point; `None` without any.
fn packed_bytes(bytes: &[u8]) -> Option<Vec<u8>> {
    let mut writer = Writer::default();
    writer.bytes(bytes);
    (!bytes.is_empty()).then(|| writer.finish(bytes.len()))
}

/// Unpacks at most `most` bytes.
fn unpacked_bytes(section: &str, bytes: &[u8], most: usize) -> Result<Vec<u8>, RbnError> {
    let unpacked = Reader::new(bytes).bytes_up_to(most);
    unpacked.map_err(|Damaged| RbnError::invalid(section, "its bytes cannot be unpacked"))
}

fn records<T: columns::Columns>(section: &str, bytes: &[u8]) -> Result<Vec<T>, RbnError> {
    columns::decode(bytes).map_err(|Damaged| RbnError::invalid(section, "its records cannot be unpacked"))
}

fn matrix<L: links::Beside>(section: &str, bytes: &[u8]) -> Result<LinkMatrix<L>, RbnError> {
    let (offsets, links) =
        links::decode(bytes).map_err(|Damaged| RbnError::invalid(section, "its rows cannot be unpacked"))?;
    Ok(LinkMatrix { offsets, links })
}
