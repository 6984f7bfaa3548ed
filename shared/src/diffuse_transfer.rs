//! Light of files that are for an environment: irradiance of every point from precomputed radiance transfer (Sloan, Kautz
//! and Snyder, *Precomputed Radiance Transfer for Real-Time Rendering in Dynamic, Low-Frequency Lighting Environments*, 2002),
//! in the hierarchical basis (Lehtinen et al. 2007, 5.2). Baker and viewer run the same code.
//!
//! With the [coefficients](crate::harmonics) l of the environment without its suns, and d with suns and other directional
//! lamps, the irradiance of a point with unit normal n is
//!
//! ```text
//! without a bounce   Σ_j (A_band(j) y_j(n) + δ_j) l_j     A: the cosine lobe; δ: what the surroundings hide
//! bounced            Σ_j t_j d_j                          t: by channel
//! ```
//!
//! and δ and t of a point are its vector plus the mean of its parents' ([`DiffuseTransfer`]). Suns give their direct light as
//! lamps do, with shadow maps. All of a vector is applied to the light at once: a cluster's mean and components become
//! irradiances, and a point adds those up.

use crate::baked::BakedScene;
use crate::harmonics::zonal::{COSINE, convolved};
use crate::harmonics::{COUNT, Coefficients, band, evaluate, value};
use crate::interpolation::{Entry, Rows, mean};
use crate::lighting::Lighting;
use crate::rbn::diffuse_transfer::{DiffuseTransfer, FROM_GROUP, FROM_SKY, has_own};
use glam::Vec3;

/// The light of a picture as diffuse transfer takes it.
#[derive(Clone, Debug, PartialEq)]
pub struct DistantLight {
    /// Coefficients of the environment without suns, linear RGB.
    pub sky: Coefficients,
    /// The same with suns and other directional lamps.
    pub all: Coefficients,
    /// Strength of each group of emissive surfaces.
    pub emission: Vec<Vec3>,
}

impl DistantLight {
    /// Projects the light of a picture.
    pub fn new(lighting: &Lighting) -> Self {
        let sky = lighting.sky_coefficients();
        Self { all: lighting.with_directional_lamps(sky), sky, emission: lighting.emission.clone() }
    }

    /// Whether nothing shines.
    pub fn is_dark(&self) -> bool {
        let mut all = self.all.iter().chain(&self.emission);
        all.all(|c| *c == Vec3::ZERO)
    }
}

/// Irradiance of a point, linear RGB.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Received {
    /// Straight from the environment and from emissive surfaces.
    pub direct: Vec3,
    /// Of light that bounced.
    pub bounced: Vec3,
}

impl std::ops::Add for Received {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { direct: self.direct + other.direct, bounced: self.bounced + other.bounced }
    }
}

impl std::ops::Mul<f32> for Received {
    type Output = Self;

    fn mul(self, factor: f32) -> Self {
        Self { direct: self.direct * factor, bounced: self.bounced * factor }
    }
}

/// Returns the coefficients of the irradiance of an open point by an environment, by its unit normal.
pub fn open(normal: Vec3) -> [f32; COUNT] {
    let mut out = evaluate(normal);
    for (i, y) in (0..COUNT).zip(&mut out) {
        *y *= COSINE[band(i)];
    }
    out
}

/// Diffuse transfer of a file, ready for light.
#[derive(Clone, Debug)]
pub struct TransferField {
    transfer: DiffuseTransfer,
    /// By point.
    normals: Vec<Vec3>,
    /// Parents of the points, and their weights.
    offsets: Vec<u32>,
    parents: Vec<Entry>,
}

impl TransferField {
    /// Takes over what light needs of a file.
    pub fn new(scene: &BakedScene) -> Self {
        let push = scene.push();
        Self {
            transfer: scene.diffuse_transfer.clone(),
            normals: scene.points.iter().map(|point| point.normal()).collect(),
            offsets: push.offsets.to_vec(),
            parents: push.entries.to_vec(),
        }
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.normals.len()
    }

    /// Whether there is no point.
    pub fn is_empty(&self) -> bool {
        self.normals.is_empty()
    }

    /// Returns the irradiance of every point along its normal.
    pub fn irradiance(&self, light: &DistantLight) -> Vec<Received> {
        let transfer = &self.transfer;
        let packed = transfer.packed();
        let lit = packed.map(|vector| applied(vector, light));
        let open = convolved(&light.sky, &COSINE);
        let push = Rows { offsets: &self.offsets, entries: &self.parents };
        let mut hidden: Vec<Received> = Vec::with_capacity(self.len());
        let mut own = 0;
        for (i, cluster) in transfer.clusters.iter().enumerate() {
            let parents = mean(push.row(i), Received::default(), |parent| hidden[parent]);
            let mut sum = parents.unwrap_or_default();
            if has_own(*cluster) {
                for (lit, weight) in packed.terms(own, usize::from(*cluster), &lit) {
                    sum = sum + *lit * weight;
                }
                own += 1;
            }
            hidden.push(sum);
        }
        for (received, normal) in hidden.iter_mut().zip(&self.normals) {
            received.direct = (received.direct + value(&open, *normal)).max(Vec3::ZERO);
            received.bounced = received.bounced.max(Vec3::ZERO);
        }
        hidden
    }

    /// Returns how the direct light of each point changes with a small turn of its normal: the gradient of the irradiance of
    /// an open point along the surface, relative to the irradiance there, luminance (tilt.wgsl).
    pub fn tilts(&self, light: &DistantLight, received: &[Received]) -> Vec<Vec3> {
        let grey = |c: Vec3| c.element_sum() / 3.0;
        // Of band 1, whose functions are y, z, x by √(3/4π).
        let [y, z, x] = [light.sky[1], light.sky[2], light.sky[3]].map(grey);
        let slope = Vec3::new(x, y, z) * (COSINE[1] * 0.488_602_5);
        let tilt = |(normal, received): (&Vec3, &Received)| {
            let level = grey(received.direct + received.bounced);
            let along = slope - *normal * slope.dot(*normal);
            if level > 0.0 { along / level } else { Vec3::ZERO }
        };
        self.normals.iter().zip(received).map(tilt).collect()
    }
}

/// A vector applied to light: the irradiance that it stands for.
fn applied(vector: &[f32], light: &DistantLight) -> Received {
    let (from_sky, from_groups) = vector.split_at(FROM_SKY.min(vector.len()));
    let (sets, _) = from_sky.as_chunks::<COUNT>();
    let mut out = Received::default();
    if let [direct, red, green, blue] = sets {
        out.direct = direct.iter().zip(&light.sky).map(|(t, l)| *l * *t).sum();
        let channels = red.iter().zip(green).zip(blue).map(|((r, g), b)| Vec3::new(*r, *g, *b));
        out.bounced = channels.zip(&light.all).map(|(t, l)| t * *l).sum();
    }
    let (groups, _) = from_groups.as_chunks::<FROM_GROUP>();
    for ([a, b, c, d, e, f], strength) in groups.iter().zip(&light.emission) {
        out.direct += Vec3::new(*a, *b, *c) * *strength;
        out.bounced += Vec3::new(*d, *e, *f) * *strength;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    #[test]
    fn an_open_point_gets_pi_from_an_even_environment() {
        let mut sky = [Vec3::ZERO; COUNT];
        sky[0] = Vec3::splat((4.0 * std::f32::consts::PI).sqrt());
        let mut stream = Stream::new(3, 3);
        for _ in 0..20 {
            let received: Vec3 = open(stream.sphere()).iter().zip(&sky).map(|(t, l)| *l * *t).sum();
            assert!((received - std::f32::consts::PI).abs().max_element() < 1e-5, "{received}");
        }
    }
}
