//! The rules of the format that a file must keep, so that what is read needs no further checks.

use super::bulk::{MAX_CUTS, Point};
use super::codec::links;
use super::meta::{Animation, Meta, Track};
use super::{RbnError, Scene};
use crate::interpolation::MAX_POINTS;
use crate::link::MAX_SENDERS;

impl Scene {
    /// Checks every rule of the format.
    pub(super) fn check(&self) -> Result<(), RbnError> {
        let bad = |section: &str, problem: &str| RbnError::invalid(section, problem);
        let finite = |v: &[f32]| v.iter().all(|x| x.is_finite());
        let m = &self.meta;
        if self.points.len() > MAX_POINTS {
            return Err(RbnError::TooLarge(format!(
                "{} basis functions; a file holds at most {MAX_POINTS}: bake with fewer levels",
                self.points.len()
            )));
        }
        if !m.origin.iter().all(|x| x.is_finite())
            || !finite(&m.bounds_min)
            || !finite(&m.bounds_max)
            || m.cameras.is_empty()
        {
            return Err(bad("META", "origin, bounds or cameras"));
        }
        let mut next = 0u64;
        for level in &m.levels {
            if level.first as u64 != next || !finite(&[level.disk_radius, level.support_radius]) {
                return Err(bad("META", "levels do not follow each other"));
            }
            next += level.count as u64;
        }
        if next != self.points.len() as u64 {
            return Err(bad(
                "META",
                &format!("levels hold {next} points, section PNTS {}", self.points.len()),
            ));
        }
        if m.later_levels > m.sender_levels
            || m.sender_levels > m.direct_levels
            || m.direct_levels as usize > m.levels.len()
        {
            return Err(bad("META", "later, sender or direct levels"));
        }
        check_look(m, self.texture_bytes.len() as u64)?;
        for animation in &m.animations {
            check_animation(animation, m.lights.len())?;
        }
        for draw in &m.draws {
            let end = draw.first_index as u64 + draw.index_count as u64;
            if draw.material as usize >= m.materials.len()
                || draw.index_count % 3 != 0
                || end > self.indices.len() as u64
            {
                return Err(bad("META", "a draw call lies outside section INDX"));
            }
        }
        if self.indices.iter().any(|&i| i as usize >= self.vertices.len()) {
            return Err(bad("INDX", "an index lies outside section VERT"));
        }
        if !self.vertices.iter().all(|v| finite(&v.position) && finite(&v.uv)) {
            return Err(bad("VERT", "a number is not finite"));
        }
        // Squares and sums of these stay finite.
        let sane = |x: f32| x.abs() < 1e15;
        let placed = |p: &Point| p.position.iter().all(|x| sane(*x)) && sane(p.radius) && p.radius > 0.0;
        if !self.points.iter().all(placed) {
            return Err(bad("PNTS", "a number is not finite, or far too large"));
        }
        if !self.points.iter().all(|p| p.cuts().len() <= MAX_CUTS && p.cuts().end <= self.cuts.len()) {
            return Err(bad("PNTS", "a cut lies outside section CUTS"));
        }
        if !self.cuts.iter().all(|cut| finite(&cut.towards)) {
            return Err(bad("CUTS", "a number is not finite"));
        }
        let senders = self.sender_count();
        if senders > MAX_SENDERS {
            return Err(RbnError::TooLarge(format!(
                "{senders} senders; links can name {MAX_SENDERS}: bake with fewer sender levels"
            )));
        }
        let later = self.later_count();
        check_rows("LINK", &self.links.offsets, &self.links.links, self.points.len(), senders)?;
        check_rows("LATL", &self.later.offsets, &self.later.links, later, later)?;
        Ok(())
    }
}

/// Materials and textures.
fn check_look(m: &Meta, texture_bytes: u64) -> Result<(), RbnError> {
    let bad = |problem: String| Err(RbnError::invalid("META", problem));
    let finite = |v: &[f32]| v.iter().all(|x| x.is_finite());
    for material in &m.materials {
        let numbers = [material.metallic, material.roughness, material.specular, material.normal_scale];
        let details = material.details().into_iter().flatten();
        let mut textures = details.clone().map(|d| d.texture).chain(material.base_color_texture);
        if textures.any(|t| t as usize >= m.textures.len())
            || !finite(&material.base_color)
            || !finite(&material.emission)
            || !finite(&numbers)
            || !details.into_iter().all(|d| finite(d.uv_from_vertex.as_flattened()))
        {
            return bad(format!("material {:?}", material.name));
        }
    }
    for texture in &m.textures {
        if texture.offset.checked_add(texture.len).is_none_or(|end| end > texture_bytes) {
            return bad(format!("texture {:?} lies outside section TEXD", texture.name));
        }
    }
    Ok(())
}

/// Keys in order and as many values as they need, all finite, of lights that are there.
fn check_animation(animation: &Animation, lights: usize) -> Result<(), RbnError> {
    let sound = |track: &Track| {
        let numbers = track.times.iter().chain(&track.values).all(|x| x.is_finite());
        (track.light as usize) < lights
            && !track.times.is_empty()
            && track.values.len() == track.times.len() * track.property.width()
            && track.times.windows(2).all(|t| t[0] < t[1])
            && track.times[0] >= 0.0
            && numbers
    };
    let long = animation.duration.is_finite() && animation.duration >= 0.0;
    if long && animation.tracks.iter().all(sound) {
        Ok(())
    } else {
        Err(RbnError::invalid("META", format!("animation {:?}", animation.name)))
    }
}

/// Checks that there are so many rows, in order, and that the indices of each ascend and are under `limit`.
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
    let ascending = |row: &[E]| row.windows(2).all(|e| e[0].index() < e[1].index());
    if !offsets.windows(2).all(|w| ascending(&entries[w[0] as usize..w[1] as usize])) {
        return Err(RbnError::invalid(section, "the points of a row are out of order"));
    }
    if entries.iter().any(|e| e.index() as usize >= limit) {
        return Err(RbnError::invalid(section, "a point is out of range"));
    }
    Ok(())
}
