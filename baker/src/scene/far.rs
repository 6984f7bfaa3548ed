//! What lies far away from all the rest of a scene, most likely by mistake.

use super::{Scene, bounds_of};
use glam::{DVec3, Vec3};

/// Surfaces that are looked at; of more, one in so many.
const LOOKED_AT: usize = 100_000;
/// The share of the surface that lies beyond the box around the rest, at each of its six sides.
const BEYOND: f64 = 0.002;
/// It is far where the scene is so many times as large as the box around the rest.
const FAR: f32 = 20.0;

/// A sentence that names what lies far away from nearly all of the scene's surface, where anything does.
pub fn far_away(scene: &Scene) -> Option<String> {
    let first = scene.models.first().map_or(scene.triangles.len(), |model| model.triangles.start as usize);
    let box_of = |corners: &[u32; 3]| bounds_of(&corners.map(|i| scene.positions[i as usize]));
    let area = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|i| scene.positions[i as usize].as_dvec3());
        0.5 * (b - a).cross(c - a).length()
    };
    let triangles = || scene.triangles[..first].iter().zip(&scene.triangle_material);
    let copies = || {
        scene.models.iter().flat_map(|model| {
            let material = scene.triangle_material[model.triangles.start as usize];
            model.boxes().map(move |bounds| (bounds, material))
        })
    };
    let every = (first + scene.instances()).div_ceil(LOOKED_AT).max(1);
    // A copy counts as its box does.
    let of_box = |(low, high): (Vec3, Vec3)| {
        let size = (high - low).as_dvec3();
        2.0 * (size.x * size.y + size.y * size.z + size.z * size.x)
    };
    let middle = |(low, high): (Vec3, Vec3)| 0.5 * (low + high);
    let of_triangles =
        triangles().step_by(every).map(|(corners, _)| (middle(box_of(corners)), area(corners)));
    let of_copies = copies().step_by(every).map(|(bounds, _)| (middle(bounds), of_box(bounds)));
    let (low, high) = without_ends(of_triangles.chain(of_copies).collect())?;
    let (least, greatest) = scene.bounds();
    let (most, all) = ((high - low).length(), (greatest - least).length());
    if most <= 0.0 || all < FAR * most {
        return None;
    }
    let centre = 0.5 * (low + high);
    let away =
        |(low, high): (Vec3, Vec3)| (low - centre).length_squared().max((high - centre).length_squared());
    let parts = triangles().map(|(corners, material)| (box_of(corners), *material)).chain(copies());
    let (bounds, material) = parts.max_by(|a, b| away(a.0).total_cmp(&away(b.0)))?;
    let [x, y, z] = (DVec3::from(scene.origin) + middle(bounds).as_dvec3()).to_array();
    let name = match scene.materials.get(material as usize).map(|material| material.name.as_str()) {
        None | Some("") => format!("material {material}"),
        Some(name) => format!("material {name:?}"),
    };
    Some(format!(
        "nearly all of the scene is {most:.3} units across, but all of it {all:.3}: something with {name} lies far away, \
         around {x:.1}, {y:.1}, {z:.1}; leave it out if it is a stray"
    ))
}

/// The box around places but for the few thousandths of their weight that lie at its ends.
fn without_ends(mut places: Vec<(Vec3, f64)>) -> Option<(Vec3, Vec3)> {
    let total: f64 = places.iter().map(|place| place.1).sum();
    let (mut low, mut high) = (*places.first()?, *places.first()?);
    for axis in 0..3 {
        places.sort_by(|a, b| a.0[axis].total_cmp(&b.0[axis]));
        let mut before = 0.0;
        for place in &places {
            if before <= BEYOND * total {
                low.0[axis] = place.0[axis];
            }
            if before <= (1.0 - BEYOND) * total {
                high.0[axis] = place.0[axis];
            }
            before += place.1;
        }
    }
    Some((low.0, high.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::load;

    #[test]
    fn rooms_have_nothing_far_away_and_a_stray_is_named() {
        for name in ["cornell-box", "apartment", "library", "theatre", "two-rooms", "furnace"] {
            assert_eq!(far_away(&load(&format!("builtin:{name}")).unwrap()), None, "{name}");
        }
        let mut scene = load("builtin:cornell-box").unwrap();
        let first = scene.positions.len() as u32;
        for corner in [Vec3::ZERO, Vec3::X, Vec3::Y] {
            scene.positions.push(Vec3::new(5e4, 0.0, 0.0) + 0.1 * corner);
            scene.normals.push(Vec3::Z);
            scene.uvs.push(glam::Vec2::ZERO);
        }
        scene.triangles.push([first, first + 1, first + 2]);
        scene.triangle_material.push(0);
        let said = far_away(&scene).unwrap();
        assert!(said.contains("50000") && said.contains("material"), "{said}");
    }
}
