//! Outliers: geometry far away from the rest of a scene, most likely by mistake, that makes the rest less exact.
//!
//! A scene splits at a gap along an axis, free of boxes of triangles and instances, if the gap is many times as long as
//! the width of the scene on one side. A plain around a house, or a long corridor, has no gap. The loss of precision
//! decides about a warning: the offset of ray origins from surfaces follows from the position of the local origin and
//! from the size of the scene's [main part](super::detail).

use super::detail::Exactness;
use super::{Scene, bounds_of, union};
use glam::{DVec3, Vec3};

/// Maximum number of triangles and instances examined; larger scenes are subsampled at a regular stride.
const LOOKED_AT: usize = 100_000;
/// Minimum length of a far gap over the diagonal of the rest.
const FAR: f32 = 20.0;
/// Minimum ratio of the rest's offset of ray origins with the outlier to the offset without the outlier.
const COSTS: f32 = 8.0;

/// A triangle or an instance.
#[derive(Clone, Copy)]
struct OutlierPart {
    bounds: (Vec3, Vec3),
    area: f64,
    material: u32,
}

impl OutlierPart {
    fn middle(&self) -> Vec3 {
        0.5 * (self.bounds.0 + self.bounds.1)
    }
}

/// Warning with the name and position of geometry far away from the bulk of the scene's surface, if the outlier makes
/// the bulk less exact.
pub fn far_away(scene: &Scene) -> Option<String> {
    let all = parts(scene);
    let rest = without_far(all.clone());
    let bounds = bounds_of_all(&rest)?;
    let across = (bounds.1 - bounds.0).length();
    if rest.len() == all.len() || across <= 0.0 {
        return None;
    }
    let exactness = Exactness::new(scene.main_part(), scene.bounds());
    let exact = exactness.at(bounds.0.abs().max(bounds.1.abs()));
    let alone = Exactness::new(bounds, (bounds.0 - bounds.1, bounds.1 - bounds.0)).at(Vec3::ZERO);
    if exact < COSTS * alone {
        return None;
    }
    let centre = 0.5 * (bounds.0 + bounds.1);
    let away = |part: &OutlierPart| part.middle().distance(centre);
    let part = all.iter().max_by(|a, b| away(a).total_cmp(&away(b)))?;
    let [x, y, z] = (DVec3::from(scene.origin) + part.middle().as_dvec3()).to_array();
    let name = match scene.materials.get(part.material as usize).map(|material| material.name.as_str()) {
        None | Some("") => format!("material {}", part.material),
        Some(name) => format!("material {name:?}"),
    };
    Some(format!(
        "most of the scene is {across:.3} units across, but something with {name} lies {:.3} units away, around {x:.1}, {y:.1}, \
         {z:.1}: light near surfaces is exact to {exact:.1e} units, to {alone:.1e} without it; leave it out if it is a stray",
        away(part)
    ))
}

/// Triangles and instances, subsampled in very large scenes.
fn parts(scene: &Scene) -> Vec<OutlierPart> {
    let first = scene.models.first().map_or(scene.triangles.len(), |model| model.triangles.start as usize);
    let triangles =
        scene.triangles[..first].iter().zip(&scene.triangle_material).map(|(corners, &material)| {
            let corners = corners.map(|i| scene.positions[i as usize]);
            let [a, b, c] = corners.map(|p| p.as_dvec3());
            OutlierPart { bounds: bounds_of(&corners), area: 0.5 * (b - a).cross(c - a).length(), material }
        });
    let copies = scene.models.iter().flat_map(|model| {
        let material = scene.triangle_material[model.triangles.start as usize];
        model.boxes().map(move |bounds| {
            // An instance has the area of its box.
            let size = (bounds.1 - bounds.0).as_dvec3();
            let area = 2.0 * (size.x * size.y + size.y * size.z + size.z * size.x);
            OutlierPart { bounds, area, material }
        })
    });
    let every = (first + scene.instances()).div_ceil(LOOKED_AT).max(1);
    triangles.step_by(every).chain(copies.step_by(every)).collect()
}

fn bounds_of_all(parts: &[OutlierPart]) -> Option<(Vec3, Vec3)> {
    parts.iter().map(|part| part.bounds).reduce(union)
}

/// Removes the side of smaller area at every far gap.
fn without_far(mut parts: Vec<OutlierPart>) -> Vec<OutlierPart> {
    'gaps: loop {
        for axis in 0..3 {
            parts.sort_by(|a, b| a.bounds.0[axis].total_cmp(&b.bounds.0[axis]));
            let mut end = f32::NEG_INFINITY;
            let gap = |(i, part): (usize, &OutlierPart)| {
                let gap = part.bounds.0[axis] - end;
                end = end.max(part.bounds.1[axis]);
                (i, gap)
            };
            let gaps = parts.iter().enumerate().map(gap).filter(|(i, _)| *i > 0);
            let Some((at, gap)) = gaps.collect::<Vec<_>>().into_iter().max_by(|a, b| a.1.total_cmp(&b.1))
            else {
                return parts;
            };
            let area = |parts: &[OutlierPart]| parts.iter().map(|part| part.area).sum::<f64>();
            let mut beyond = parts.split_off(at);
            if area(&beyond) > area(&parts) {
                std::mem::swap(&mut parts, &mut beyond);
            }
            let across = bounds_of_all(&parts).map_or(0.0, |(low, high)| (high - low).length());
            if gap > FAR * across {
                continue 'gaps;
            }
            parts.extend(beyond);
        }
        return parts;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Surfaces;
    use crate::geometry::mesh::TriangleSurfaces;
    use crate::io::load;
    use crate::scene::world_mesh::WorldMesh;
    use glam::dvec3;
    use rebounce_shared::rbn::meta::Material;

    /// A room of this size, and a stray of `quads` quads of one unit along x and z, at the distance `away`.
    fn with_stray(size: DVec3, quads: usize, away: f64) -> Scene {
        let mut mesh = WorldMesh::default();
        mesh.room(DVec3::ZERO, size, [0; 6]);
        for i in 0..quads {
            let low = dvec3(away + (i % 8) as f64, 0.1 * i as f64, (i / 8) as f64);
            mesh.quad([DVec3::ZERO, DVec3::Z, dvec3(1.0, 0.0, 1.0), DVec3::X].map(|p| low + p), 1);
        }
        let material = |name: &str| Material { name: name.into(), ..Material::default() };
        let mut scene = Scene { materials: vec![material("wall"), material("Layer0")], ..Scene::default() };
        mesh.finish(&mut scene);
        scene
    }

    fn epsilon(scene: &Scene, at: DVec3) -> f32 {
        TriangleSurfaces::from_scene(scene).epsilon_at((at - DVec3::from(scene.origin)).as_vec3())
    }

    #[test]
    fn what_costs_nothing_is_no_matter() {
        for name in ["cornell-box", "apartment", "gallery", "library", "theatre", "two-rooms", "furnace"] {
            assert_eq!(far_away(&load(&format!("builtin:{name}")).unwrap()), None, "{name}");
        }
        // A corridor, and a lawn with a house.
        assert_eq!(far_away(&with_stray(dvec3(1.5, 2.4, 300.0), 0, 0.0)), None);
        assert_eq!(far_away(&with_stray(dvec3(10_000.0, 3.0, 10_000.0), 8, 5_000.0)), None);
    }

    #[test]
    fn a_small_stray_costs_nothing_and_a_rich_one_is_named() {
        let room = dvec3(4.0, 3.0, 4.0);
        let alone = epsilon(&with_stray(room, 0, 0.0), 0.5 * room);
        let scene = with_stray(room, 1, 8e4);
        assert!(epsilon(&scene, 0.5 * room) < COSTS * alone);
        assert_eq!(far_away(&scene), None);
        // The stray has more detail than the room, but less surface: the local origin is in the stray.
        let scene = with_stray(room, 64, 8e6);
        assert!(epsilon(&scene, 0.5 * room) > COSTS * alone);
        let said = far_away(&scene).unwrap();
        assert!(said.contains("Layer0") && said.contains("8000"), "{said}");
        assert_eq!(said.matches("e-").count(), 1, "{said}");
    }
}
