//! The functions that cover what the texels of cube maps see; found once, when a file is loaded.

use rebounce_shared::baked::BakedScene;
use rebounce_shared::glam::Vec3;

/// Functions of a texel, at most: those of the largest weights.
pub(super) const FUNCTIONS: usize = 8;
/// Codes of a weight's root, and the bit that it begins at; as slots.wgsl.
const ROOTS: f32 = 1023.0;
const SHIFT: u32 = 22;

/// Returns the row of a place of a reconstruction group: functions of the finest level that covers it, as find.wgsl has them;
/// ends with 0.
pub(super) fn row(scene: &BakedScene, place: Vec3, normal: Vec3, group: u32) -> [u32; FUNCTIONS] {
    let (lookup, levels) = (&scene.relations.lookup, scene.meta.levels.len());
    let mut found = lookup.covering(levels, (&scene.points, &scene.cuts), (place, normal), group);
    found.sort_by(|a, b| b.1.total_cmp(&a.1));
    let mut out = [0; FUNCTIONS];
    for (entry, (j, weight)) in out.iter_mut().zip(found) {
        let root = (weight.sqrt() * ROOTS).round().clamp(1.0, ROOTS) as u32;
        *entry = j | root << SHIFT;
    }
    out
}
