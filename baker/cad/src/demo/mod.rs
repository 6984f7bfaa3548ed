//! Generated CAD scenes: small assemblies of exact surfaces, for tests, measurements and pictures. Metres, y up.
//!
//! | module | what it has |
//! |---|---|
//! | `loops` | rectangles, circles, polygons in the parameter plane; planar faces |
//! | `revolved` | solids of revolution by their profile |
//! | `prism` | solids of extrusion by their outline |
//! | `teapot` | a teapot of quadrics with trimmed intersections, in a room open towards +z |
//! | `tori` | tori cut open by loops, on a floor in a box open at the top and towards +z |
//! | `chess` | a chess set of surfaces of revolution, each part once, on a board on a table |
//! | `opera` | the front of an opera: planar faces with arched windows, columns, cornices |

mod chess;
mod loops;
mod opera;
mod prism;
mod revolved;
mod teapot;
#[cfg(test)]
mod tests;
mod tori;

use crate::face::Face;
use crate::model::{Assembly, FaceColour, Part, PartInstance};
use glam::{DAffine3, DVec3, Vec3};

/// Names of the scenes.
pub const NAMES: [&str; 4] = ["teapot", "tori", "chess", "opera"];

/// The scene of this name; `None` for a name that is not among [`NAMES`].
pub fn assembly(name: &str) -> Option<Assembly> {
    match name {
        "teapot" => Some(teapot::assembly()),
        "tori" => Some(tori::assembly()),
        "chess" => Some(chess::assembly()),
        "opera" => Some(opera::assembly()),
        _ => None,
    }
}

/// Adds a part; its index.
fn add(scene: &mut Assembly, name: &str, faces: Vec<(Face, FaceColour)>, is_closed: bool) -> usize {
    scene.parts.push(Part { name: name.into(), faces, is_closed });
    scene.parts.len() - 1
}

/// Adds an occurrence of a part.
fn instance(scene: &mut Assembly, part: usize, name: String, world_from_part: DAffine3) {
    scene.instances.push(PartInstance { part, path: vec![name], world_from_part });
}

/// Adds a part and one occurrence of it, moved by a vector.
fn once(
    scene: &mut Assembly,
    name: &str,
    faces: Vec<(Face, FaceColour)>,
    is_closed: bool,
    [x, y, z]: [f64; 3],
) {
    let part = add(scene, name, faces, is_closed);
    instance(scene, part, name.into(), DAffine3::from_translation(DVec3::new(x, y, z)));
}

/// Faces in one colour, linear RGB.
fn coloured(faces: Vec<Face>, colour: [f32; 3]) -> Vec<(Face, FaceColour)> {
    faces.into_iter().map(|face| (face, Some(Vec3::from_array(colour)))).collect()
}
