//! Colours of styled items.

use super::file::File;
use glam::Vec3;
use std::collections::HashMap;

/// Colours by the number of the item styled, linear RGB.
pub(super) struct Styles(HashMap<u64, Vec3>);

/// Records between a styled item and the colour of its surfaces.
const ON_THE_WAY: [&str; 8] = [
    "PRESENTATION_STYLE_ASSIGNMENT",
    "PRESENTATION_STYLE_BY_CONTEXT",
    "SURFACE_STYLE_USAGE",
    "SURFACE_SIDE_STYLE",
    "SURFACE_STYLE_FILL_AREA",
    "FILL_AREA_STYLE",
    "SURFACE_STYLE_RENDERING",
    "SURFACE_STYLE_RENDERING_WITH_PROPERTIES",
];

impl Styles {
    /// Those of a file. Of several styles of one item the overriding one counts, else the first.
    pub fn new(file: &File) -> Self {
        let mut colours = HashMap::new();
        for &styled in file.of_kind("STYLED_ITEM") {
            if let Some((item, colour)) = styled_colour(file, styled, "STYLED_ITEM") {
                colours.entry(item).or_insert(colour);
            }
        }
        for &styled in file.of_kind("OVER_RIDING_STYLED_ITEM") {
            if let Some((item, colour)) = styled_colour(file, styled, "OVER_RIDING_STYLED_ITEM") {
                colours.insert(item, colour);
            }
        }
        Self(colours)
    }

    /// The colour of an item.
    pub fn of(&self, item: u64) -> Option<Vec3> {
        self.0.get(&item).copied()
    }
}

fn styled_colour(file: &File, styled: u64, kind: &str) -> Option<(u64, Vec3)> {
    let fields = file.fields(styled, kind)?;
    let colour = fields.references(1).ok()?.into_iter().find_map(|style| colour(file, style, 0))?;
    Some((fields.optional_reference(2)?, colour))
}

/// The first colour of surfaces below a style.
fn colour(file: &File, id: u64, depth: usize) -> Option<Vec3> {
    if depth > 8 {
        return None;
    }
    if let Some(fields) = file.fields(id, "COLOUR_RGB") {
        let channel = |at: usize| fields.real(at).ok().map(|value| value.clamp(0.0, 1.0) as f32);
        return Some(Vec3::new(channel(1)?, channel(2)?, channel(3)?));
    }
    for kind in ["DRAUGHTING_PRE_DEFINED_COLOUR", "PRE_DEFINED_COLOUR"] {
        if let Some(fields) = file.fields(id, kind) {
            return pre_defined(fields.text(0));
        }
    }
    // One attribute, a colour.
    if let Some(fields) = file.fields(id, "FILL_AREA_STYLE_COLOUR") {
        return colour(file, fields.optional_reference(1)?, depth + 1);
    }
    ON_THE_WAY.iter().any(|kind| file.is(id, kind)).then_some(())?;
    file.any_fields(id)?.all_references().into_iter().find_map(|next| colour(file, next, depth + 1))
}

fn pre_defined(name: &str) -> Option<Vec3> {
    Some(match name.to_lowercase().as_str() {
        "red" => Vec3::X,
        "green" => Vec3::Y,
        "blue" => Vec3::Z,
        "yellow" => Vec3::new(1.0, 1.0, 0.0),
        "magenta" => Vec3::new(1.0, 0.0, 1.0),
        "cyan" => Vec3::new(0.0, 1.0, 1.0),
        "black" => Vec3::ZERO,
        "white" => Vec3::ONE,
        _ => return None,
    })
}
