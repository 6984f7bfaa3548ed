//! Validation of the format's rules, so that a loaded scene needs no further checks.

mod meta;

use super::BakedScene;
use crate::basis::ParentWeights;
use crate::interpolation::MAX_POINTS;
use crate::link::MAX_SENDERS;
use crate::rbn::bulk::{Copies, Instance, MAX_ALL_CUTS, MAX_CUTS, Point};
use crate::rbn::codec::links;
use crate::rbn::limits::{MAX_COPIES, MAX_ROW, MAX_TRIANGLES, all_sane, sane};
use crate::rbn::meta::Meta;
use crate::rbn::shown::{GROUND, SIDE, Shown};
use crate::rbn::sources::{self, Sources};
use crate::rbn::{LinkMatrix, RbnError, container};
#[cfg(feature = "radiosity")]
use crate::rbn::{cube_maps, diffuse_transfer, gloss, groups, light_groups, lightmap, rig, specular};
use glam::Vec3;

/// Least support radius, scene units.
const LEAST_RADIUS: f32 = 1e-15;

impl BakedScene {
    /// Checks every rule of the format.
    pub(super) fn check(&self) -> Result<(), RbnError> {
        let bad = |section: &str, problem: &str| RbnError::invalid(section, problem);
        let m = &self.meta;
        if self.points.len() > MAX_POINTS {
            return Err(RbnError::TooLarge(format!(
                "{} basis functions; a file holds at most {MAX_POINTS}: bake with fewer levels",
                self.points.len()
            )));
        }
        if self.cuts.len() > MAX_ALL_CUTS {
            return Err(RbnError::TooLarge(format!(
                "{} planes that end supports; a file holds at most {MAX_ALL_CUTS}: bake with fewer functions",
                self.cuts.len()
            )));
        }
        if self.version() > container::PUNCTUAL_LIGHTS && self.parent_weights != ParentWeights::LeastSquares {
            return Err(bad("META", "a file with older weights has only punctual lights"));
        }
        meta::check(m, self.points.len() as u64, self.texture_bytes.len() as u64)?;
        if !is_shown_sound(m) {
            return Err(bad("SHOW", "names or ground"));
        }
        let mut drawn = 0u64;
        for draw in &m.draws {
            let end = draw.first_index as u64 + draw.index_count as u64;
            if draw.material as usize >= m.materials.len()
                || draw.index_count == 0
                || !draw.index_count.is_multiple_of(3)
                || end > self.indices.len() as u64
            {
                return Err(bad("META", "a draw call lies outside section INDX"));
            }
            drawn += draw.index_count as u64;
        }
        // A triangle is drawn by one draw call.
        if drawn > self.indices.len() as u64 {
            return Err(bad("META", "draw calls overlap"));
        }
        self.check_copies()?;
        if self.indices.iter().any(|&i| i as usize >= self.vertices.len()) {
            return Err(bad("INDX", "an index lies outside section VERT"));
        }
        if !self.vertices.iter().all(|v| all_sane(&v.position) && all_sane(&v.uv)) {
            return Err(bad("VERT", "a number is not finite, or far too large"));
        }
        let placed = |p: &Point| all_sane(&p.position) && sane(p.radius) && p.radius >= LEAST_RADIUS;
        if !self.points.iter().all(placed) {
            return Err(bad("PNTS", "a number is not finite, or far too large or small"));
        }
        if !self.points.iter().all(|p| p.cuts().len() <= MAX_CUTS && p.cuts().end <= self.cuts.len()) {
            return Err(bad("PNTS", "a cut lies outside section CUTS"));
        }
        if !self.cuts.iter().all(|cut| cut.towards.iter().all(|x| x.is_finite())) {
            return Err(bad("CUTS", "a number is not finite"));
        }
        self.check_openness()?;
        let senders = self.sender_count();
        if senders > MAX_SENDERS {
            return Err(RbnError::TooLarge(format!(
                "{senders} senders; links can name {MAX_SENDERS}: bake with fewer sender levels"
            )));
        }
        let later = self.later_count();
        check_rows("LINK", &self.links.offsets, &self.links.links, self.points.len(), senders)?;
        check_rows("LATL", &self.later.offsets, &self.later.links, later, later)?;
        #[cfg(feature = "radiosity")]
        specular::check(m.materials.iter().map(|material| &material.specular_extras))?;
        #[cfg(feature = "radiosity")]
        self.check_groups()?;
        sources::check(&self.sources, m.materials.len())?;
        let rows = if self.sources == Sources::default() { 0 } else { self.points.len() };
        let LinkMatrix { offsets, links } = &self.source_links;
        check_rows("SRCL", offsets, links, rows, self.sources.count())?;
        #[cfg(feature = "radiosity")]
        self.check_light_groups()?;
        #[cfg(feature = "radiosity")]
        gloss::check(&self.gloss, [self.points.len(), senders, self.sources.groups.len()])?;
        #[cfg(feature = "radiosity")]
        cube_maps::check(
            &self.cube_maps,
            [self.gloss.links.links.len(), self.gloss.layout.emission.len(), 1 + self.groups.groups.len()],
        )?;
        #[cfg(feature = "radiosity")]
        self.check_transfer()?;
        #[cfg(feature = "radiosity")]
        self.check_rig()?;
        Ok(())
    }

    /// Checks groups and reflectances, and that triangles that move with a node stand at instances that move with no other.
    #[cfg(feature = "radiosity")]
    fn check_groups(&self) -> Result<(), RbnError> {
        let points = self.points.len();
        groups::check(&self.groups, &self.point_groups, points, self.meta.materials.len())?;
        if !self.reflectance.is_empty() && self.reflectance.len() != points {
            return Err(RbnError::invalid("REFL", "it does not fit the points"));
        }
        if self.groups.nodes.is_empty() {
            return Ok(());
        }
        // Node that each instance moves with: none yet, or one more than its number, or 0 for an instance that stays.
        let mut moves_with = vec![None; self.instances.len()];
        for (i, draw) in self.meta.draws.iter().enumerate() {
            let node = self.groups.node_of(self.groups.of_material(draw.material));
            let instances = self.copies_of(i);
            let with = node.map_or(0, |node| node + 1);
            let is_alone = |own: &mut Option<u32>| own.replace(with).is_none_or(|own| own == with);
            if (node.is_some() && instances.is_empty()) || !moves_with[instances].iter_mut().all(is_alone) {
                return Err(RbnError::invalid("COPY", "triangles that move have no instance of their own"));
            }
        }
        Ok(())
    }

    /// Checks a rig, and that its triangles are those of no copies.
    #[cfg(feature = "radiosity")]
    fn check_rig(&self) -> Result<(), RbnError> {
        rig::check(&self.rig, [self.vertices.len(), self.points.len()])?;
        if self.rig.is_empty() || self.copies.is_empty() {
            return Ok(());
        }
        let numbers = self.rig.numbers(self.vertices.len());
        for (i, draw) in self.meta.draws.iter().enumerate().filter(|(i, _)| !self.copies_of(*i).is_empty()) {
            let first = draw.first_index as usize;
            let corners = &self.indices[first..first + draw.index_count as usize];
            if corners.iter().any(|corner| numbers[*corner as usize].is_some()) {
                return Err(RbnError::invalid("RIGV", format!("draw call {i} has copies of what deforms")));
            }
        }
        Ok(())
    }

    /// Number of links of transport, later bounces and sources.
    #[cfg(feature = "radiosity")]
    fn all_links(&self) -> usize {
        self.links.links.len() + self.later.links.len() + self.source_links.links.len()
    }

    /// Checks that diffuse transfer fits points and groups, and that a file with it has neither links nor a fixed solution.
    #[cfg(feature = "radiosity")]
    fn check_transfer(&self) -> Result<(), RbnError> {
        let other = self.all_links() + self.light_groups.groups.len() + self.gloss.links.links.len();
        let counts = [self.points.len(), self.sources.groups.len(), other];
        diffuse_transfer::check(&self.diffuse_transfer, counts)
    }

    /// Checks that light groups fit lights and points, and that a file with groups has neither links nor animations that
    /// move a light.
    #[cfg(feature = "radiosity")]
    fn check_light_groups(&self) -> Result<(), RbnError> {
        light_groups::check(&self.light_groups, self.meta.lights.len(), self.points.len())?;
        let columns = self.light_groups.columns();
        lightmap::check(&self.lightmap, columns, self.vertices.len(), self.instances.len())?;
        if self.is_solved() && self.all_links() > 0 {
            return Err(RbnError::invalid("LGRP", "a file with groups of light has no links"));
        }
        let mut tracks = self.meta.animations.iter().flat_map(|animation| &animation.tracks);
        if self.is_solved() && tracks.any(|track| track.property.is_signed()) {
            return Err(RbnError::invalid("LGRP", "an animation moves a light that stays in place"));
        }
        Ok(())
    }
}

/// Returns true if the number of names equals the number of lights and cameras, or is zero, and the ground's numbers
/// are usable.
fn is_shown_sound(meta: &Meta) -> bool {
    let Shown { names, ground } = &meta.shown;
    let count = names.bytes().filter(|byte| *byte == 0).count();
    let named = names.is_empty() || names.ends_with('\0') && count == meta.lights.len() + meta.cameras.len();
    let grounded = ground.split_at_checked(32).is_none_or(|(numbers, shade)| {
        let n: [f32; 8] = bytemuck::pod_read_unaligned(numbers);
        all_sane(&n) && n[0] < n[2] && n[1] < n[3] && shade.len() == SIDE * SIDE
    });
    named && grounded && (ground.is_empty() || ground.len() == GROUND)
}

impl BakedScene {
    /// Checks that copies refer to existing instances with invertible, unmirrored transforms.
    fn check_copies(&self) -> Result<(), RbnError> {
        if self.copies.is_empty() && self.instances.is_empty() {
            return Ok(());
        }
        if self.copies.len() != self.meta.draws.len() || self.copies.iter().all(|copies| copies.count == 0) {
            return Err(RbnError::invalid("COPY", "it does not fit the draw calls"));
        }
        let end = |copies: &Copies| copies.first as u64 + copies.count as u64;
        if self.copies.iter().any(|copies| end(copies) > self.instances.len() as u64) {
            return Err(RbnError::invalid("COPY", "a copy lies outside section INST"));
        }
        if self.triangles_placed() > MAX_TRIANGLES {
            return Err(RbnError::TooLarge(format!(
                "{} triangles with all copies; a file holds at most {MAX_TRIANGLES}: simplify the scene",
                self.triangles_placed()
            )));
        }
        let runs = self.copies.chunk_by(|a, b| a == b);
        let copies: u64 = runs.map(|run| u64::from(run[0].count)).sum();
        if copies > MAX_COPIES {
            return Err(RbnError::TooLarge(format!(
                "{copies} copies; a file holds at most {MAX_COPIES}: simplify the scene"
            )));
        }
        // Transformed vertices have the same bound as untransformed vertices.
        let most = (self.vertices.iter()).fold(Vec3::ZERO, |most, v| most.max(Vec3::from(v.position).abs()));
        let sound = |instance: &Instance| {
            let place = instance.local_from_model();
            let determinant = place.matrix3.determinant();
            let reach = |row: &[f32; 4]| most.dot(Vec3::new(row[0], row[1], row[2]).abs()) + row[3].abs();
            all_sane(instance.rows.as_flattened())
                && determinant > 0.0
                && determinant.is_normal()
                && all_sane(&place.inverse().to_cols_array())
                && instance.rows.iter().all(|row| sane(reach(row)))
        };
        if !self.instances.iter().all(sound) {
            return Err(RbnError::invalid("INST", "a copy is mirrored or flat, or far too large or small"));
        }
        Ok(())
    }
}

/// Checks for `rows` rows in order, and for ascending indices below `limit` in every row.
fn check_rows<E: links::Beside>(
    section: &str,
    offsets: &[u32],
    entries: &[E],
    rows: usize,
    limit: usize,
) -> Result<(), RbnError> {
    let whole = offsets.len() == rows + 1
        && offsets[0] == 0
        && offsets.windows(2).all(|w| w[0] <= w[1])
        && offsets[rows] as usize == entries.len();
    if !whole {
        return Err(RbnError::invalid(section, "rows do not follow each other"));
    }
    if offsets.windows(2).any(|w| (w[1] - w[0]) as usize > MAX_ROW) {
        return Err(RbnError::TooLarge(format!(
            "section {section} has over {MAX_ROW} links in a row: bake with fewer rays"
        )));
    }
    let ascending = |row: &[E]| row.windows(2).all(|e| e[0].index() < e[1].index());
    if !offsets.windows(2).all(|w| ascending(&entries[w[0] as usize..w[1] as usize])) {
        return Err(RbnError::invalid(section, "the points of a row are out of order"));
    }
    if entries.iter().any(|e| e.index() as usize >= limit) {
        return Err(RbnError::invalid(section, "a point is out of range"));
    }
    Ok(())
}
