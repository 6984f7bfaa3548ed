//! Vertex colours (glTF's COLOR_0), which multiply the base colour.
//!
//! The bake and the path tracer interpolate vertex colours at every hit. A .rbn file has a base colour per material and
//! no vertex colours. Therefore materials are split by colour, and pictures made from the file show the mean colour of
//! similar triangles.

use super::Scene;
use glam::{Vec3, Vec4};

/// Maximum number of parts of a material, and maximum number of materials in total: a material is a draw call in the
/// viewer.
const MOST_PARTS: usize = 24;
const MOST_ALL: usize = 512;
/// Maximum difference of colours that count as equal, in the square root of every channel.
const ALIKE: f32 = 1.0 / 32.0;

/// Triangles of one material, to be split by colour.
struct ColourGroup {
    triangles: Vec<u32>,
    low: Vec4,
    high: Vec4,
}

impl ColourGroup {
    fn new(triangles: Vec<u32>, shades: &[Vec4]) -> Self {
        let of = |t: &u32| shades[*t as usize];
        let low = triangles.iter().map(of).fold(Vec4::INFINITY, Vec4::min);
        let high = triangles.iter().map(of).fold(Vec4::NEG_INFINITY, Vec4::max);
        Self { triangles, low, high }
    }

    fn spread(&self) -> f32 {
        (self.high - self.low).max_element()
    }

    /// Cuts the group in the middle of the longest axis; both halves have triangles if the spread is not zero.
    fn cut(self, shades: &[Vec4]) -> [Self; 2] {
        let axis = (self.high - self.low).max_position();
        let middle = (0.5 * (self.low + self.high))[axis];
        let (a, b) = self.triangles.into_iter().partition(|&t| shades[t as usize][axis] <= middle);
        [Self::new(a, shades), Self::new(b, shades)]
    }
}

/// Applies the vertices' linear colours (empty: all white): exact corner colours for light, split materials for
/// pictures.
pub(super) fn apply(scene: &mut Scene, colors: &[Vec4]) {
    let corners = |t: usize| scene.triangles[t].map(|i| colors[i as usize]);
    let count = scene.triangles.len();
    if colors.is_empty() {
        return;
    }
    let means: Vec<Vec4> = (0..count).map(|t| corners(t).into_iter().sum::<Vec4>() / 3.0).collect();
    // The square root is about as fine in the dark as eyes are. Alpha of an opaque surface has no meaning.
    let shades: Vec<Vec4> = (means.iter().zip(&scene.triangle_material))
        .map(|(mean, m)| {
            let opaque = scene.materials[*m as usize].alpha == rebounce_shared::rbn::meta::Alpha::Opaque;
            let root = Vec4::from_array(mean.to_array().map(f32::sqrt));
            if opaque { root.with_w(1.0) } else { root }
        })
        .collect();
    scene.corner_colors = (0..count)
        .map(|t| {
            let base = Vec4::from_array(scene.materials[scene.triangle_material[t] as usize].base_color);
            corners(t).map(|c| (base * c).truncate())
        })
        .collect();

    let mut groups = vec![Vec::new(); scene.materials.len()];
    for (t, material) in scene.triangle_material.iter().enumerate() {
        groups[*material as usize].push(t as u32);
    }
    let weight = |t: u32| {
        let [a, b, c] = scene.triangles[t as usize].map(|i| scene.positions[i as usize]);
        (b - a).cross(c - a).length()
    };
    let mut split = 0;
    let mut inexact = 0;
    let (mut materials, mut triangle_material) = (scene.materials.clone(), scene.triangle_material.clone());
    for (material, triangles) in groups.into_iter().enumerate() {
        if triangles.iter().all(|&t| corners(t as usize) == [Vec4::ONE; 3]) {
            continue;
        }
        let mut parts = vec![ColourGroup::new(triangles, &shades)];
        while parts.len() < MOST_PARTS && materials.len() + parts.len() <= MOST_ALL {
            let widest = (0..parts.len()).max_by(|&a, &b| parts[a].spread().total_cmp(&parts[b].spread()));
            let Some(widest) = widest.filter(|&w| parts[w].spread() > ALIKE) else { break };
            let cut = parts.swap_remove(widest).cut(&shades);
            parts.extend(cut);
        }
        for (p, part) in parts.into_iter().enumerate() {
            let (mut sum, mut total) = (Vec4::ZERO, f32::MIN_POSITIVE);
            for &t in &part.triangles {
                sum += weight(t) * means[t as usize];
                total += weight(t);
            }
            let mean = sum / total;
            let mut shown = scene.materials[material].clone();
            shown.base_color =
                (Vec4::from_array(shown.base_color) * mean).clamp(Vec4::ZERO, Vec4::ONE).to_array();
            inexact += (part.triangles.iter())
                .filter(|&&t| corners(t as usize).iter().any(|c| differ(c.truncate(), mean.truncate())))
                .count();
            if p == 0 {
                materials[material] = shown;
                continue;
            }
            for &t in &part.triangles {
                triangle_material[t as usize] = materials.len() as u32;
            }
            materials.push(shown);
            split += 1;
        }
    }
    (scene.materials, scene.triangle_material) = (materials, triangle_material);
    if inexact > 0 {
        scene.left_out.push(format!(
            "vertex colours of {inexact} triangles, in pictures only: the light has them exactly, pictures show mean \
             colours, for which materials were split into {split} more"
        ));
    }
}

/// True if two linear colours differ to the eye.
fn differ(a: Vec3, b: Vec3) -> bool {
    let root = |c: Vec3| Vec3::from_array(c.to_array().map(f32::sqrt));
    (root(a) - root(b)).abs().max_element() > ALIKE
}
