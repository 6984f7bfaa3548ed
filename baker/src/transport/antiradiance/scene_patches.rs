//! The triangles of a scene as patches: halved at their longest edges until there are as many as wanted.

use crate::geometry::Gloss;
use crate::geometry::mesh::geometry::Surface;
use crate::scene::Scene;
use glam::{Affine3A, Vec2, Vec3};
use rebounce_shared::antiradiance::Patch;

/// Times that the area of patches is tried.
const TRIES: usize = 40;

/// Patches of a scene, about `wanted` of them: areas are the surfaces', and a two-sided surface has patches on both sides.
/// There are as many as the scene has triangles at least. With `gloss`, metals have a lobe; all is matt without.
pub fn patches_of(scene: &Scene, wanted: usize, gloss: bool) -> Vec<Patch> {
    let texture = |t: u32| scene.textures[t as usize].sampler();
    let surfaces: Vec<Surface> = scene.materials.iter().map(|m| Surface::new(m, texture)).collect();
    let triangles = triangles(scene, &surfaces);
    let areas: Vec<f32> = triangles.iter().map(|triangle| triangle.patch.area()).collect();
    let count = |most: f32| areas.iter().map(|area| pieces(*area, most)).sum::<usize>();
    // The area of a patch, between 0 and all.
    let (mut low, mut high) = (0.0, areas.iter().fold(0.0, |most: f32, area| most.max(*area)));
    for _ in 0..TRIES {
        let middle = 0.5 * (low + high);
        if count(middle) > wanted { low = middle } else { high = middle }
    }
    let mut out = Vec::with_capacity(count(high));
    for triangle in &triangles {
        let begin = out.len();
        divide(triangle.patch, high, &mut out);
        let pieces = (out.len() - begin) as f32;
        for patch in &mut out[begin..] {
            let (albedo, own) = triangle.look(scene, patch.position(), pieces);
            patch.albedo = albedo;
            patch.roughness = (gloss && own.is_metal()).then_some(own.roughness);
        }
    }
    out
}

/// Number of patches of at most this area that halving makes.
fn pieces(area: f32, most: f32) -> usize {
    let (mut area, mut count) = (area, 1);
    while area > most && count < 1 << 24 {
        area *= 0.5;
        count *= 2;
    }
    count
}

fn divide(patch: Patch, most: f32, out: &mut Vec<Patch>) {
    let mut pieces = pieces(patch.area(), most);
    let mut all = vec![patch];
    while pieces > 1 {
        all = all.iter().flat_map(Patch::halves).collect();
        pieces /= 2;
    }
    out.extend(all);
}

/// One side of a triangle of a scene.
struct SidedTriangle<'a> {
    patch: Patch,
    surface: &'a Surface,
    uvs: [Vec2; 3],
    colors: [Vec3; 3],
    /// Area that the texture coordinates span.
    share: f32,
}

impl SidedTriangle<'_> {
    /// Reflectance around a place, of one of so many pieces, and how it shines there.
    fn look(&self, scene: &Scene, place: Vec3, pieces: f32) -> (Vec3, Gloss) {
        let [a, b, c] = self.patch.corners;
        let normal = (b - a).cross(c - a);
        let whole = normal.length_squared().max(f32::MIN_POSITIVE);
        let at_b = (place - a).cross(c - a).dot(normal) / whole;
        let at_c = (b - a).cross(place - a).dot(normal) / whole;
        let weights = [1.0 - at_b - at_c, at_b, at_c];
        let uv = (0..3).map(|i| weights[i] * self.uvs[i]).sum();
        let color = if scene.corner_colors.is_empty() {
            self.surface.color
        } else {
            (0..3).map(|i| weights[i] * self.colors[i]).sum()
        };
        let albedo = self.surface.albedo(color, uv, self.share / pieces);
        (albedo.clamp(Vec3::ZERO, Vec3::ONE), self.surface.gloss(uv))
    }
}

/// All sides of all triangles that have an area, in order; instances of a model each have theirs.
fn triangles<'a>(scene: &'a Scene, surfaces: &'a [Surface]) -> Vec<SidedTriangle<'a>> {
    let mut out = Vec::new();
    let end = scene.models.first().map_or(scene.triangles.len(), |model| model.triangles.start as usize);
    let mut add = |triangle: usize, local_from_model: &Affine3A| {
        let Some(front) = sided(scene, surfaces, triangle, local_from_model) else { return };
        if front.surface.double_sided {
            let SidedTriangle { patch, uvs, colors, .. } = front;
            let [a, b, c] = patch.corners;
            let patch = Patch { corners: [a, c, b], normal: -patch.normal, ..patch };
            let (uvs, colors) = ([uvs[0], uvs[2], uvs[1]], [colors[0], colors[2], colors[1]]);
            out.push(SidedTriangle { patch, uvs, colors, ..front });
        }
        out.push(front);
    };
    (0..end).for_each(|triangle| add(triangle, &Affine3A::IDENTITY));
    for model in &scene.models {
        for place in &model.local_from_model {
            model.triangles.clone().for_each(|triangle| add(triangle as usize, place));
        }
    }
    out
}

/// The front of a triangle, counter-clockwise seen from the side of its shading normals; `None` without an area.
fn sided<'a>(
    scene: &Scene,
    surfaces: &'a [Surface],
    triangle: usize,
    local_from_model: &Affine3A,
) -> Option<SidedTriangle<'a>> {
    let [i, j, k] = scene.triangles[triangle].map(|i| i as usize);
    let cross = |i: usize, j: usize, k: usize| {
        let [a, b, c] = [i, j, k].map(|i| scene.positions[i]);
        (b - a).cross(c - a)
    };
    let shading: Vec3 = [i, j, k].map(|i| scene.normals[i]).iter().sum();
    let is_turned = cross(i, j, k).dot(shading) < 0.0;
    let order = if is_turned { [0, 2, 1] } else { [0, 1, 2] };
    let vertices = order.map(|at| [i, j, k][at]);
    let corners = vertices.map(|i| local_from_model.transform_point3(scene.positions[i]));
    let [a, b, c] = corners;
    let normal = (b - a).cross(c - a).try_normalize()?;
    let uvs = vertices.map(|i| scene.uvs[i]);
    let share = 0.5 * (uvs[1] - uvs[0]).perp_dot(uvs[2] - uvs[0]).abs();
    let colors = scene.corner_colors.get(triangle).map_or([Vec3::ONE; 3], |own| order.map(|at| own[at]));
    let surface = &surfaces[scene.triangle_material[triangle] as usize];
    Some(SidedTriangle { patch: Patch { corners, normal, ..Patch::default() }, surface, uvs, colors, share })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_add_up_and_there_are_as_many_patches_as_wanted() {
        let scene = crate::demo::load("office").unwrap();
        let whole: f32 = patches_of(&scene, 1, false).iter().map(Patch::area).sum();
        for wanted in [6_000, 20_000] {
            let patches = patches_of(&scene, wanted, false);
            assert!(patches.len() <= wanted && patches.len() > wanted / 2, "{} of {wanted}", patches.len());
            let area: f32 = patches.iter().map(Patch::area).sum();
            assert!((area / whole - 1.0).abs() < 1e-4);
            for patch in &patches {
                let [a, b, c] = patch.corners;
                assert!((b - a).cross(c - a).normalize().dot(patch.normal) > 0.999);
            }
        }
        assert_eq!(patches_of(&scene, 1, false).len(), scene.triangles.len());
    }

    #[test]
    fn patches_have_the_colour_of_their_surface_and_two_sides_where_it_has() {
        let mut scene = crate::demo::load("furnace").unwrap();
        assert!(patches_of(&scene, 100, false).iter().all(|patch| patch.albedo == Vec3::splat(0.5)));
        let one = patches_of(&scene, 100, false).len();
        scene.materials[0].double_sided = true;
        let two = patches_of(&scene, 200, false);
        assert_eq!(two.len(), 2 * one);
        assert!(two.iter().map(|patch| patch.area() * patch.normal).sum::<Vec3>().length() < 1e-4);
    }

    #[test]
    fn metals_have_a_lobe_where_it_is_wanted() {
        let scene = crate::demo::load("trophy").unwrap();
        let glossy =
            |gloss| patches_of(&scene, 1, gloss).iter().filter(|own| own.roughness.is_some()).count();
        assert_eq!(glossy(false), 0);
        assert!(glossy(true) > 0 && glossy(true) < patches_of(&scene, 1, true).len());
    }
}
