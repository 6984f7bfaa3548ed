//! Relit cube maps: what a cube of texels sees from a place near metals, and light in it. The file has the
//! [surfaces that texels see](crate::rbn::cube_maps), pictures light them.
//!
//! * `cube` – texels of a cube and their directions;
//! * `levels` – radiance at several widths;
//! * `march` – a ray through the distances of a map: correction of parallax by depth.

pub mod cube;
pub mod levels;
pub mod march;

use crate::elementary::Elementary;
use crate::footprint;
use crate::ggx::alpha;
use crate::gloss::Arriving;
use crate::harmonics::zonal::of_mean_length;
use crate::harmonics::{band, evaluate};
use crate::octahedral::pack_snorm16;
use crate::rbn::bulk::Point;
use crate::rbn::cube_maps::{CubeMaps, CubeTexel};
use cube::Cube;
use glam::{Vec3, Vec4};
use march::Distances;

impl CubeMaps {
    /// The texels of a map.
    pub fn cube(&self) -> Cube {
        Cube { side: self.layout.side as usize }
    }

    /// Place of a map, local space.
    pub fn place(&self, map: usize) -> Vec3 {
        Vec3::from(self.layout.places[map])
    }

    /// Texel `i` of all as a point that direct light is sampled at: a footprint as wide as the texel, with a single sample.
    /// `None` where nothing is seen.
    pub fn point(&self, i: usize) -> Option<Point> {
        let cube = self.cube();
        let texel = self.texels[i];
        let distance = texel.distance(&self.layout);
        let way = cube.direction(i % cube.texels());
        distance.is_finite().then(|| Point {
            position: (self.place(i / cube.texels()) + distance * way).to_array(),
            radius: distance * cube.angle() / footprint::RADIUS,
            normal: pack_snorm16(texel.normal()),
            cuts: Point::pack_cuts(0, 0, 1),
            tint: 0,
        })
    }

    /// What a map sees: distances by texel.
    pub fn distances(&self, map: usize) -> Distances {
        let cube = self.cube();
        let texels = &self.texels[map * cube.texels()..(map + 1) * cube.texels()];
        let distance = |texel: &CubeTexel| texel.distance(&self.layout);
        Distances { cube, texels: texels.iter().map(distance).collect() }
    }
}

/// Angles between texels that the lobe of the smoothest metal is wide, as its α.
const LOBE_TEXELS: f32 = 1.25;

/// Least roughness of metals that reflect maps of these texels. Mirrors would show the texels, and ragged edges where the ray
/// in the middle of the lobe passes an edge: they reflect by the transfer, which is smooth.
pub fn least_roughness(cube: Cube) -> f32 {
    (LOBE_TEXELS * cube.angle()).sqrt()
}

/// Radiance that a white metal, seen in a map along a ray in direction `way`, reflects of what arrives by the
/// [glossy transfer](crate::gloss), `arriving`: its lobe is a von Mises-Fisher lobe about the mirrored direction, as wide as GGX's
/// where it is seen head on (Wang et al., *All-Frequency Rendering of Dynamic, Spatially-Varying Reflectance*, 2009: the
/// sharpness of the normals, 2 / α², over 4 cosines). `sky` is the environment's radiance from a direction over a solid angle.
pub fn metal_in_map(
    arriving: &Arriving,
    way: Vec3,
    normal: Vec3,
    roughness: f32,
    sky: impl FnOnce(Vec3, f32) -> Vec3,
) -> Vec3 {
    let mirrored = way.reflect(normal);
    let a = alpha(roughness);
    let sharpness = 0.5 / (a * a);
    // coth κ − 1/κ, and 2π ∫ exp(κ (t − 1)) dt.
    let twice = (-2.0 * sharpness * std::f32::consts::LOG2_E).exponential2();
    let length = ((1.0 + twice) / (1.0 - twice) - 1.0 / sharpness).clamp(0.0, 1.0);
    let solid_angle = std::f32::consts::TAU * (1.0 - twice) / sharpness;
    let lobe = of_mean_length(length);
    let terms = arriving.iter().zip(evaluate(mirrored)).enumerate();
    let sum: Vec4 = terms.map(|(i, (c, y))| *c * (y * lobe[band(i)])).sum();
    let seen = sum.w.clamp(0.0, 1.0);
    (sum.truncate() + seen * sky(mirrored, solid_angle)).max(Vec3::ZERO)
}
