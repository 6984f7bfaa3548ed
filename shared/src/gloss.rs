//! Glossy reflection on the CPU, the reference for the GPU: what arrives at points from each direction, and what a glossy
//! surface makes of it.
//!
//! [`GlossyField`] is the light of one frame. At each point of the [glossy transfer](crate::rbn::gloss) it has the
//! coefficients of arriving radiance, T l with the point's matrix T and the environment's coefficients l, and those of
//! visibility (Lehtinen et al. 2007, 6.4). Between points they are interpolated as irradiance is.
//!
//! [`GlossyField::reflected`] is the light that a lobe sends to the eye. Harmonics are smooth; an environment is not. So matrices hold what
//! bounced, and the environment itself is seen through the visibility:
//!
//! ```text
//! L(ω) = (T l)(ω) + V(ω) L_env(ω)
//! ```
//!
//! Where matrices hold light that did not bounce, too, the environment adds what harmonics leave out of it, L_env − l.
//!
//! In files with [links](crate::rbn::gloss_links) T l is their sum in place of the matrices': for each link the light of its
//! sender times its amount, as a lobe about its direction, and once more about the direction mirrored at the tangent plane.

use crate::baked::BakedScene;
use crate::environment::reflection::{ReflectedSky, of_skies};
use crate::footprint::tangents;
use crate::ggx::{LOBE_SAMPLES, alpha, multiple_scattering, shifted_lobe};
use crate::harmonics::zonal::of_mean_length;
use crate::harmonics::{COUNT, Coefficients, band, evaluate, value};
use crate::lighting::Lighting;
use crate::rbn::gloss::{Gloss, GlossLayout, NO_MATRIX};
use crate::rbn::gloss_links::GlossLink;
use glam::{Vec2, Vec3, Vec4};

/// Coefficients of arriving radiance, RGB, and of visibility.
pub type Arriving = [Vec4; COUNT];

/// Nothing arrives.
pub const DARK: Arriving = [Vec4::ZERO; COUNT];

/// Returns the coefficients of the distant radiance that matrices take: with suns and other directional lamps where matrices
/// hold bounced light alone, since lamps are reflected by themselves.
pub fn distant_light(layout: &GlossLayout, lighting: &Lighting) -> Coefficients {
    if layout.has_direct { lighting.sky_coefficients() } else { lighting.distant_coefficients() }
}

/// Light that arrives at points of glossy surfaces.
#[derive(Clone, Debug, Default)]
pub struct GlossyField {
    /// By point of the file, its place among those of the transfer; `u32::MAX` where it has none.
    places: Vec<u32>,
    arriving: Vec<Arriving>,
    /// Coefficients of the environment, as far as matrices hold it without a bounce.
    smooth: Option<Box<Coefficients>>,
}

impl GlossyField {
    /// Applies the transfer of a file to distant light and to what the senders [send](crate::relight::sent_after_bounces),
    /// `sent`; senders beyond its end are dark. Lamps are reflected by themselves: only bounced light has their share.
    pub fn new(scene: &BakedScene, lighting: &Lighting, sent: &[Vec3]) -> Self {
        let gloss = &scene.gloss;
        if gloss.is_empty() {
            return Self::default();
        }
        let sky = &distant_light(&gloss.layout, lighting);
        let packed = gloss.packed();
        let lit = packed.map(|vector| lit_vector(vector, sky));
        let mut places = vec![u32::MAX; scene.points.len()];
        let mut arriving: Vec<Arriving> = Vec::with_capacity(gloss.points.len());
        let light = SenderLight::new(scene, lighting, sent);
        let mut matrix = 0;
        for (place, (point, cluster)) in (0..).zip(gloss.points.iter().zip(&gloss.clusters)) {
            let mut own = parents_mean(scene, *point as usize, &places, &arriving);
            if let Some(row) = light.row(place as usize) {
                let linked = light.arriving(row, scene.points[*point as usize].normal());
                own.iter_mut().zip(linked).for_each(|(own, linked)| *own = linked.extend(own.w));
            }
            if *cluster != NO_MATRIX {
                for (vector, weight) in packed.terms(matrix, usize::from(*cluster), &lit) {
                    own.iter_mut().zip(vector).for_each(|(sum, c)| *sum += *c * weight);
                }
                matrix += 1;
            }
            places[*point as usize] = place;
            arriving.push(own);
        }
        let smooth = gloss.layout.has_direct.then(|| Box::new(*sky));
        Self { places, arriving, smooth }
    }

    /// Whether there is no transfer.
    pub fn is_empty(&self) -> bool {
        self.arriving.is_empty()
    }

    /// What arrives at a point; `None` where the transfer does not reach.
    pub fn at(&self, point: usize) -> Option<&Arriving> {
        self.arriving.get(*self.places.get(point)? as usize)
    }

    /// The mean over points by their weights, without those that the transfer does not reach; `None` if it reaches none.
    pub fn mean(&self, weights: &[(u32, f32)]) -> Option<Arriving> {
        let (mut sum, mut total) = (DARK, 0.0);
        for (point, weight) in weights {
            if let Some(at) = self.at(*point as usize) {
                sum.iter_mut().zip(at).for_each(|(sum, c)| *sum += *c * *weight);
                total += weight;
            }
        }
        (total > 0.0).then(|| sum.map(|c| c / total))
    }
}

/// Light of the senders of glossy links.
#[derive(Clone, Debug)]
pub struct SenderLight<'a> {
    gloss: &'a Gloss,
    sent: &'a [Vec3],
    /// Radiance of the groups of emissive surfaces; their senders are the numbers from `points` on.
    emission: Vec<Vec3>,
    points: usize,
}

impl<'a> SenderLight<'a> {
    /// Prepares the light of a picture; `sent` as in [`GlossyField::new`].
    pub fn new(scene: &'a BakedScene, lighting: &Lighting, sent: &'a [Vec3]) -> Self {
        let groups = scene.gloss.layout.emission.iter().zip(&lighting.emission);
        let emission = groups.map(|(radiance, factor)| Vec3::from(*radiance) * *factor).collect();
        Self { gloss: &scene.gloss, sent, emission, points: scene.points.len() }
    }

    /// The links of a point of the transfer, by its place there; `None` without.
    fn row(&self, place: usize) -> Option<&'a [GlossLink]> {
        let links = &self.gloss.links;
        (place < links.len()).then(|| links.row(place)).filter(|row| !row.is_empty())
    }

    /// Light of a sender, linear RGB.
    fn of(&self, sender: usize) -> Vec3 {
        let light = match sender.checked_sub(self.points) {
            Some(group) => self.emission.get(group),
            None => self.sent.get(sender),
        };
        light.copied().unwrap_or_default()
    }

    /// Coefficients of the radiance that arrives by a row of links at a point with this unit normal.
    fn arriving(&self, row: &[GlossLink], normal: Vec3) -> Coefficients {
        let mut out = [Vec3::ZERO; COUNT];
        for link in row {
            let light = self.of(link.sender as usize) * link.amount();
            let lobe = of_mean_length(link.mean_length());
            let direction = link.direction();
            let (above, below) = (evaluate(direction), evaluate(direction.reflect(normal)));
            for (i, (sum, (above, below))) in out.iter_mut().zip(above.iter().zip(below)).enumerate() {
                *sum += light * ((above + below) * lobe[band(i)]);
            }
        }
        out
    }
}

/// Mean of the parents of a point, of those that the transfer reaches.
fn parents_mean(scene: &BakedScene, point: usize, places: &[u32], arriving: &[Arriving]) -> Arriving {
    let (mut sum, mut total) = (DARK, 0.0);
    for entry in scene.push().row(point) {
        if let Some(parent) = arriving.get(places[entry.point()] as usize) {
            sum.iter_mut().zip(parent).for_each(|(sum, c)| *sum += *c * entry.weight());
            total += entry.weight();
        }
    }
    if total > 0.0 { sum.map(|c| c / total) } else { DARK }
}

/// A vector of a cluster under distant radiance.
fn lit_vector(vector: &[f32], sky: &Coefficients) -> Arriving {
    let (matrices, visibility) = vector.split_at(vector.len() - COUNT);
    let (rows, _) = matrices.as_chunks::<COUNT>();
    std::array::from_fn(|i| {
        // Without matrices there is visibility alone.
        let row = |channel: usize| rows.get(channel * COUNT + i).or(rows.get(i)).unwrap_or(&[0.0; COUNT]);
        let [red, green, blue] = [row(0), row(1), row(2)];
        let sum: Vec3 = (0..COUNT).map(|j| Vec3::new(red[j], green[j], blue[j]) * sky[j]).sum();
        sum.extend(visibility[i])
    })
}

/// Reflectance of a surface by angle (Schlick 1994), linear RGB.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fresnel {
    /// At normal incidence.
    pub head_on: Vec3,
    /// At a grazing angle.
    pub grazing: Vec3,
}

/// Integrals over a lobe: by Schlick's formula a reflectance is linear in these.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LobeLight {
    /// Radiance for a reflectance of 1 at every angle.
    pub radiance: Vec3,
    /// The same with (1 − v·h)⁵ as reflectance.
    pub glancing: Vec3,
    /// Shares of an even light, likewise.
    pub shares: [f32; 2],
}

impl LobeLight {
    /// Radiance that the surface sends to the eye, with the light that it scatters more than once.
    pub fn reflected(&self, fresnel: &Fresnel) -> Vec3 {
        let Fresnel { head_on, grazing } = *fresnel;
        let again = multiple_scattering(head_on, self.shares[0]);
        again * (head_on * (self.radiance - self.glancing) + grazing * self.glancing)
    }

    /// Share of light that is left for what is below the reflecting surface.
    pub fn left(&self, fresnel: &Fresnel) -> f32 {
        let [all, glancing] = self.shares;
        let (radiance, glancing) = (Vec3::splat(all), Vec3::splat(glancing));
        (1.0 - Self { radiance, glancing, ..*self }.reflected(fresnel).max_element()).max(0.0)
    }
}

/// Integrates radiance over the GGX lobe of a surface with this roughness and unit normal, seen from the unit direction
/// `to_eye`: `radiance` takes a unit direction, and the solid angle that its sample stands for. `shift` moves the samples
/// ([`shifted_lobe`]). All in world space.
pub fn over_lobe(
    roughness: f32,
    normal: Vec3,
    to_eye: Vec3,
    shift: Vec2,
    mut radiance: impl FnMut(Vec3, f32) -> Vec3,
) -> LobeLight {
    let alpha = alpha(roughness);
    // A frame that the eye lies in: samples turn evenly over a round surface, without a seam.
    let upright = to_eye.dot(normal);
    let across = to_eye - upright * normal;
    let first = across.try_normalize().unwrap_or(tangents(normal).0);
    let second = normal.cross(first);
    let in_frame = Vec3::new(across.length(), 0.0, upright.max(1e-3)).normalize();
    let mut out = LobeLight::default();
    for i in 0..LOBE_SAMPLES {
        let sample = shifted_lobe(alpha, in_frame, i, shift);
        if sample.weight <= 0.0 {
            continue;
        }
        let l = sample.to_light;
        let direction = first * l.x + second * l.y + normal * l.z;
        let radiance = radiance(direction, 1.0 / (LOBE_SAMPLES as f32 * sample.density));
        out.radiance += radiance * sample.weight;
        let glancing = (1.0 - sample.cosine).max(0.0).powi(5);
        out.glancing += radiance * (sample.weight * glancing);
        out.shares[0] += sample.weight;
        out.shares[1] += sample.weight * glancing;
    }
    let share = 1.0 / LOBE_SAMPLES as f32;
    let LobeLight { radiance, glancing, shares } = out;
    LobeLight {
        radiance: radiance * share,
        glancing: glancing * share,
        shares: shares.map(|sum| sum * share),
    }
}

impl GlossyField {
    /// Integrates arriving light over the GGX lobe of a surface with this roughness and unit normal, seen from the unit
    /// direction `to_eye`, under `skies`. All in world space.
    pub fn reflected(
        &self,
        arriving: &Arriving,
        skies: &[ReflectedSky<'_>],
        roughness: f32,
        normal: Vec3,
        to_eye: Vec3,
    ) -> LobeLight {
        let radiance = |direction, solid_angle| self.radiance(arriving, skies, direction, solid_angle);
        over_lobe(roughness, normal, to_eye, Vec2::ZERO, radiance)
    }

    /// Radiance that arrives from a unit direction of world space, over about this solid angle, sr.
    pub fn radiance(
        &self,
        arriving: &Arriving,
        skies: &[ReflectedSky<'_>],
        direction: Vec3,
        solid_angle: f32,
    ) -> Vec3 {
        let y = evaluate(direction);
        let low: Vec4 = y.iter().zip(arriving).map(|(y, c)| *c * *y).sum();
        let seen = of_skies(skies, direction, solid_angle);
        let smooth = self.smooth.as_ref().map(|sky| value(sky, direction)).unwrap_or_default();
        let visibility = low.w.clamp(0.0, 1.0);
        (low.truncate() + (seen - smooth) * visibility).max(Vec3::ZERO)
    }
}
