//! Validation of the metadata.

use crate::rbn::RbnError;
use crate::rbn::limits::{MAX_LEVELS, MAX_MATERIALS, all_sane, sane};
use crate::rbn::meta::{Alpha, Animation, Material, Meta, Track};

/// Checks the metadata of a file, given the number of points and the bytes of textures. The caller compares section
/// INDX.
pub(super) fn check(m: &Meta, points: u64, texture_bytes: u64) -> Result<(), RbnError> {
    if !m.origin.iter().all(|x| x.abs() < 1e30) || !all_sane(&m.bounds_min) || !all_sane(&m.bounds_max) {
        return bad("origin or bounds are not finite, or far too large");
    }
    if m.cameras.is_empty() || !m.cameras.iter().all(|camera| camera.is_usable()) {
        return bad("there is no camera, or one with a number that is not finite");
    }
    if let Some(light) = m.lights.iter().position(|light| !light.is_usable()) {
        return bad(format!("light {light} has a number that is not finite, or far too large"));
    }
    // Punctual lights were never held to the ranges of their fields.
    let others = m.lights.iter().enumerate().filter(|(_, light)| !light.kind().is_punctual());
    for (i, light) in others {
        if !light.is_within_ranges() {
            return bad(format!("light {i} has a number outside its range"));
        }
    }
    check_levels(m, points)?;
    if m.materials.len() > MAX_MATERIALS {
        return bad(format!("{} materials, more than {MAX_MATERIALS}", m.materials.len()));
    }
    for material in &m.materials {
        if !is_sound(material, m.textures.len()) {
            return bad(format!("material \"{}\"", material.name));
        }
    }
    for texture in &m.textures {
        if texture.offset.checked_add(texture.len).is_none_or(|end| end > texture_bytes) {
            return bad(format!("texture \"{}\" lies outside section TEXD", texture.name));
        }
    }
    for animation in &m.animations {
        check_animation(animation, m.lights.len())?;
    }
    Ok(())
}

fn bad(problem: impl Into<String>) -> Result<(), RbnError> {
    Err(RbnError::invalid("META", problem))
}

/// Checks for at most [`MAX_LEVELS`] contiguous levels that hold every point.
fn check_levels(m: &Meta, points: u64) -> Result<(), RbnError> {
    if m.levels.len() > MAX_LEVELS {
        return bad(format!("{} levels, more than {MAX_LEVELS}", m.levels.len()));
    }
    let mut next = 0u64;
    for level in &m.levels {
        if level.first as u64 != next || !all_sane(&[level.disk_radius, level.support_radius]) {
            return bad("levels do not follow each other");
        }
        next += level.count as u64;
    }
    if next != points {
        return bad(format!("levels hold {next} points, section PNTS {points}"));
    }
    if m.later_levels > m.sender_levels
        || m.sender_levels > m.direct_levels
        || m.direct_levels as usize > m.levels.len()
    {
        return bad("later, sender or direct levels");
    }
    Ok(())
}

/// Returns true for numbers in range and existing textures.
fn is_sound(material: &Material, textures: usize) -> bool {
    let details = material.details().into_iter().flatten();
    let mut used = details.clone().map(|d| d.texture).chain(material.base_color_texture);
    let e = &material.extras;
    let shares = [material.metallic, material.roughness, material.specular, e.transmission, e.scattered];
    let colours = [e.transmission_tint, e.scattered_color];
    let share = |x: &f32| (0.0..=1.0).contains(x);
    let cutoff = match material.alpha {
        Alpha::Mask { cutoff } => cutoff,
        Alpha::Opaque | Alpha::Blend => 0.0,
    };
    used.all(|t| (t as usize) < textures)
        && material.base_color.iter().chain(&shares).chain(colours.as_flattened()).all(share)
        && all_sane(&material.emission)
        && sane(material.normal_scale)
        && sane(cutoff)
        && details.into_iter().all(|d| all_sane(d.uv_from_vertex.as_flattened()))
}

/// Checks for ascending keys, matching numbers of values, finite values, existing lights, and no negative intensity
/// or colour.
fn check_animation(animation: &Animation, lights: usize) -> Result<(), RbnError> {
    let sound = |track: &Track| {
        (track.light as usize) < lights
            && !track.times.is_empty()
            && track.times.len().checked_mul(track.property.width()) == Some(track.values.len())
            && track.times.windows(2).all(|t| t[0] < t[1])
            && track.times[0] >= 0.0
            && all_sane(&track.times)
            && all_sane(&track.values)
            && (track.property.is_signed() || track.values.iter().all(|value| *value >= 0.0))
    };
    if sane(animation.duration) && animation.duration >= 0.0 && animation.tracks.iter().all(sound) {
        Ok(())
    } else {
        bad(format!("animation \"{}\"", animation.name))
    }
}
