//! Properties of the blended surfaces, computed on the CPU: blended materials, number of layers, scale of radiance
//! in 16-bit floats.

use super::draw_batch::{DrawBatch, instances};
use glam::{Vec3, Vec4};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::lighting::Lighting;
use rebounce_shared::rbn::meta::{Alpha, Material, Meta};

/// Maximum number of layers. Blended surfaces behind the last layer are not drawn; opaque surfaces behind are.
pub const MOST_LAYERS: usize = 8;
/// Greatest distance of a vertex from its plane, as a share of the scene's diagonal. The two faces of thin glass
/// must stay separate planes; a plane counted twice only costs passes.
const FLATNESS: f32 = 1e-6;
/// Maximum number of triangles examined for planes, with every instance counted. A larger scene draws all layers.
const MOST_LOOKED_AT: usize = 1 << 22;
/// The typical radiance is scaled to between `MIDDLE` and twice `MIDDLE`: 16-bit floats then hold values from a
/// millionth to a few thousand times the typical radiance.
const MIDDLE: f32 = 16.0;

/// Whether a material is drawn by blending: glass, or `alphaMode` BLEND with real transparency. Many exporters mark
/// opaque materials as BLEND: a material counts as opaque if its alpha is 1 and its base color texture is a JPEG
/// (without alpha channel) or absent.
pub fn is_blended(meta: &Meta, material: &Material) -> bool {
    let clear = |texture: u32| {
        meta.textures.get(texture as usize).is_some_and(|texture| texture.mime != "image/jpeg")
    };
    material.is_glass()
        || material.alpha == Alpha::Blend
            && (material.base_color[3] < 1.0 || material.base_color_texture.is_some_and(clear))
}

/// Whether layers need colours for transmitted light and for unlit radiance: true if any run is glass or unlit.
pub fn are_tinted(meta: &Meta, runs: &[DrawBatch]) -> bool {
    let material = |run: &DrawBatch| &meta.materials[run.material as usize];
    runs.iter().map(material).any(|m| m.is_glass() || m.extras.unlit)
}

/// Returns the number of layers for these runs, at most [`MOST_LAYERS`]: the number of distinct planes of the
/// triangles, as a ray crosses a plane only once.
pub fn layers(scene: &BakedScene, runs: &[DrawBatch]) -> u32 {
    let [low, high] = [scene.meta.bounds_min, scene.meta.bounds_max].map(Vec3::from);
    // Lengths in diagonals, to avoid overflow in any unit of length.
    let diagonal = (high - low).length().max(f32::MIN_POSITIVE);
    // Normal, and distance from the origin.
    let mut planes: Vec<Vec4> = Vec::new();
    let mut looked_at = 0;
    for run in runs {
        let indices = &scene.indices[run.indices.start as usize..run.indices.end as usize];
        for triangle in indices.as_chunks::<3>().0 {
            for place in instances(scene, run) {
                let place = place.local_from_model();
                looked_at += 1;
                if planes.len() == MOST_LAYERS || looked_at > MOST_LOOKED_AT {
                    return MOST_LAYERS as u32;
                }
                let corner = |i: u32| place.transform_point3(scene.vertices[i as usize].position.into());
                let [a, b, c] = triangle.map(|i| corner(i) / diagonal);
                let normal = (b - a).cross(c - a).normalize_or_zero();
                let holds = |plane: &Vec4| {
                    [a, b, c].iter().all(|place| plane.dot(place.extend(-1.0)).abs() <= FLATNESS)
                };
                if normal != Vec3::ZERO && !planes.iter().any(holds) {
                    planes.push(normal.extend(normal.dot(a)));
                }
            }
        }
    }
    planes.len() as u32
}

/// Returns the factor for the radiance of blended surfaces in 16-bit floats. The factor is a power of two (no
/// rounding) and brings the typical radiance to one to two times [`MIDDLE`]. Typical radiance: the sum of the
/// lamps at a quarter of the scene's diagonal and of the sky, or the emission of these surfaces if greater.
pub fn unit(meta: &Meta, lighting: &Lighting, [low, high]: [Vec3; 2]) -> f32 {
    let distance_squared = (high - low).length_squared() / 16.0;
    let mut typical = 0.0f32;
    for source in &lighting.lamps {
        let area = if source.is_far() { 1.0 } else { distance_squared };
        let facing = if source.kind.is_area() { source.facing_area() } else { 1.0 };
        typical += source.intensity.max_element() * facing / (area * std::f32::consts::PI);
    }
    if let Some(sky) = &lighting.sky {
        typical += sky.iter().sum::<Vec3>().max_element() / sky.len() as f32;
    }
    for material in meta.materials.iter().filter(|m| is_blended(meta, m)) {
        typical = typical.max(Vec3::from(material.emission).max_element());
    }
    if typical > 0.0 { MIDDLE / power_of_two(typical.clamp(1e-30, 1e30)) } else { 1.0 }
}

/// Returns the greatest power of two that is not above a positive number: the exponent alone.
fn power_of_two(number: f32) -> f32 {
    f32::from_bits(number.to_bits() & 0x7f80_0000)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rebounce_shared::light::Light;
    use rebounce_shared::rbn::bulk::Vertex;
    use rebounce_shared::rbn::meta::Texture;

    #[test]
    fn what_cannot_be_seen_through_is_not_blended() {
        let texture = |mime: &str| Texture { mime: mime.into(), ..Texture::default() };
        let meta = Meta { textures: vec![texture("image/jpeg"), texture("image/png")], ..Meta::default() };
        let blended = |alpha: f32, base_color_texture: Option<u32>| {
            let base_color = [1.0, 1.0, 1.0, alpha];
            let material =
                Material { base_color, base_color_texture, alpha: Alpha::Blend, ..Default::default() };
            is_blended(&meta, &material)
        };
        assert!(blended(0.9, None) && blended(0.9, Some(0)) && blended(1.0, Some(1)));
        assert!(!blended(1.0, None) && !blended(1.0, Some(0)));
        assert!(!is_blended(&meta, &Material { alpha: Alpha::Mask { cutoff: 0.5 }, ..Default::default() }));
    }

    /// A scene of triangles in planes of constant z and x.
    fn panes(count: usize) -> (BakedScene, DrawBatch) {
        let mut scene = BakedScene::default();
        scene.meta.bounds_max = [1.0; 3];
        for pane in 0..count {
            let at = 0.05 * pane as f32;
            let place = |x: f32, y: f32| if pane % 2 == 0 { [x, y, at] } else { [at, y, x] };
            for corner in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
                scene.indices.push(scene.vertices.len() as u32);
                scene.vertices.push(Vertex { position: place(corner.0, corner.1), ..Vertex::default() });
            }
        }
        let indices = 0..scene.indices.len() as u32;
        let run = DrawBatch {
            material: 0,
            indices,
            instances: 0..1,
            cut: true,
            blended: true,
            glass: false,
            one_sided: true,
        };
        (scene, run)
    }

    #[test]
    fn there_are_as_many_layers_as_planes_and_not_too_many() {
        for (count, expected) in [(0, 0), (1, 1), (5, 5), (30, MOST_LAYERS as u32)] {
            for size in [1e-9, 1.0, 1e12] {
                let (mut scene, run) = panes(count);
                scene.meta.bounds_max = [size; 3];
                scene.vertices.iter_mut().for_each(|v| v.position = v.position.map(|x| x * size));
                assert_eq!(layers(&scene, &[run]), expected, "{count} panes of {size}");
            }
        }
        let (scene, _) = panes(3);
        assert_eq!(layers(&scene, &[]), 0, "without blended surfaces no layer");
    }

    #[test]
    fn light_of_any_strength_becomes_numbers_of_one_size() {
        let bounds = [Vec3::ZERO, Vec3::splat(4.0)];
        for strength in [1e-6, 1.0, 3e7] {
            let sun = Light::Directional {
                direction: [0.0, -1.0, 0.0],
                intensity: strength,
                color: [1.0; 3],
                radius_deg: 0.0,
            };
            let lighting = Lighting::new(&[sun], None, [0.0; 3], 0);
            let unit = unit(&Meta::default(), &lighting, bounds);
            let radiance = strength as f32 / std::f32::consts::PI;
            assert!((1.0..2.0).contains(&(unit * radiance / MIDDLE)), "{strength}: {unit}");
            assert_eq!(unit.to_bits() << 9, 0, "a power of two");
        }
        assert_eq!(unit(&Meta::default(), &Lighting::default(), bounds), 1.0);
    }
}
