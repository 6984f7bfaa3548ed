//! All that shines on a scene: lamps, area lights, shining surfaces, an environment.
//!
//! What a ray can hit by chance is sampled besides, and the two estimates are combined by multiple importance sampling
//! (Veach, Guibas: *Optimally Combining Sampling Techniques for Monte Carlo Rendering*, SIGGRAPH 1995) with the balance
//! heuristic: weights are the shares of the densities, per steradian.

use super::area;
use super::bsdf::Bsdf;
use super::direct::{arriving, beyond, toward_hit_with};
use super::environment_map::EnvironmentMap;
use super::far::{Environment, UniformEnvironment};
use crate::geometry::{Emitters, Hit, HitEmitter, Surfaces};
use crate::random::Stream;
use glam::Vec3;
use rebounce_shared::colour::luminance;
use rebounce_shared::environment;
use rebounce_shared::light::{Light, LightSource};
use rebounce_shared::lighting::emission_factors;
use rebounce_shared::rbn::sources::{EmissiveGroup, Sources};
use std::sync::Arc;

/// Shining triangles, to choose from by power.
struct EmitterTable {
    /// Sums of the powers up to and including a triangle.
    sums: Vec<f64>,
    /// Density of samples on a triangle, per area.
    densities: Vec<f32>,
    /// Factor of each triangle's emission, linear RGB.
    factors: Vec<Vec3>,
}

impl EmitterTable {
    /// Prepares a table; `factor` returns the factor of a material's emission.
    fn new(emitters: &dyn Emitters, factor: impl Fn(u32) -> Vec3) -> Self {
        let all = 0..emitters.emitter_count() as u32;
        let factors: Vec<Vec3> = all.map(|number| factor(emitters.emitter(number).material)).collect();
        let power = |number: u32| {
            let triangle = emitters.emitter(number);
            let area = 0.5 * f64::from(triangle.front().length());
            let mean = factors[number as usize] * triangle.mean;
            let luminous = f64::from(luminance(mean.max(Vec3::ZERO)));
            (area * if triangle.is_two_sided { 2.0 } else { 1.0 } * luminous, area)
        };
        let powers: Vec<(f64, f64)> = (0..emitters.emitter_count() as u32).map(power).collect();
        let mut total = 0.0;
        let sum = |(power, _): &(f64, f64)| {
            total += power;
            total
        };
        let sums: Vec<f64> = powers.iter().map(sum).collect();
        let density =
            |(power, area): &(f64, f64)| if *power > 0.0 { (power / (area * total)) as f32 } else { 0.0 };
        Self { densities: powers.iter().map(density).collect(), sums, factors }
    }

    /// Returns the triangle at a place from 0 to 1 of the sums; `None` without light.
    fn choose(&self, share: f64) -> Option<u32> {
        let total = *self.sums.last().filter(|total| **total > 0.0)?;
        let number = self.sums.partition_point(|sum| *sum <= share * total);
        Some(number.min(self.sums.len() - 1) as u32)
    }
}

/// All that shines on a scene. Positions are in local space.
pub struct Illumination {
    lamps: Vec<LightSource>,
    areas: Vec<LightSource>,
    environment: Option<Box<dyn Environment>>,
    /// Factor of the surfaces' emission, linear RGB.
    emission: Vec3,
    /// `None` if the surfaces' emitters are unknown.
    emitters: Option<EmitterTable>,
}

impl Illumination {
    /// The lamps and area lights of a list, and the emission of `surfaces`; no environment.
    pub fn new(surfaces: &(impl Surfaces + ?Sized), lights: &[LightSource]) -> Self {
        let (areas, lamps) = lights.iter().partition(|light| light.kind.is_area());
        Self {
            lamps,
            areas,
            environment: None,
            emission: Vec3::ONE,
            emitters: surfaces.emitters().map(|emitters| EmitterTable::new(emitters, |_| Vec3::ONE)),
        }
    }

    /// The lights of a list, world space; `origin` becomes zero. An environment without a picture is uniform; the
    /// caller adds one with a picture. Emission has the factor `emission`, and that of the emissive lights together, if
    /// there are any.
    pub fn of(
        surfaces: &(impl Surfaces + ?Sized),
        lights: &[Light],
        origin: [f64; 3],
        emission: f64,
    ) -> Self {
        let sources: Vec<LightSource> = lights.iter().map(|light| light.source(origin)).collect();
        let mut out = Self::new(surfaces, &sources);
        let emissive = lights.iter().filter(|light| matches!(light, Light::Emissive { .. }));
        let emissive = emissive.map(Light::strength);
        out.emission = emission as f32 * emissive.reduce(|a, b| a + b).unwrap_or(Vec3::ONE);
        let uniform = lights.iter().find(|light| matches!(light, Light::Environment { file: None, .. }));
        match uniform {
            Some(light) => out.with_environment(UniformEnvironment(light.strength())),
            None => out,
        }
    }

    /// All light of a picture of a scene with groups of emissive surfaces: a group without a light is dark, and
    /// environments have the radiance of `picture`.
    pub fn of_scene(
        surfaces: &(impl Surfaces + ?Sized),
        lights: &[Light],
        origin: [f64; 3],
        groups: &[EmissiveGroup],
        picture: Option<&Arc<environment::Environment>>,
    ) -> Self {
        let lamps = lights.iter().filter(|light| light.kind().is_lamp());
        let lamps: Vec<LightSource> = lamps.map(|light| light.source(origin)).collect();
        let strengths = emission_factors(lights, groups.len());
        let group_of = Sources { groups: groups.to_vec(), ..Sources::default() }.group_of_materials();
        let out = Self::new(surfaces, &lamps).with_groups(surfaces, &group_of, &strengths);
        let even = Arc::new(environment::Environment::constant(Vec3::ONE));
        let sky = lights.iter().find_map(|light| match light {
            Light::Environment { rotation_deg, .. } => {
                let picture = picture.unwrap_or(&even).clone();
                Some(EnvironmentMap::new(picture, *rotation_deg as f32, light.strength()))
            }
            _ => None,
        });
        match sky {
            Some(sky) => out.with_environment(sky),
            None => out,
        }
    }

    /// With an environment in place of the present one.
    pub fn with_environment(mut self, environment: impl Environment + 'static) -> Self {
        self.environment = Some(Box::new(environment));
        self
    }

    /// With another factor of the surfaces' emission, linear RGB.
    pub fn with_emission(self, emission: Vec3) -> Self {
        Self { emission, ..self }
    }

    /// With a factor for each group of emissive surfaces; `group_of` has the group of each material.
    pub fn with_groups(
        mut self,
        surfaces: &(impl Surfaces + ?Sized),
        group_of: &[Option<u32>],
        strengths: &[Vec3],
    ) -> Self {
        let factor = |material: u32| {
            let group = group_of.get(material as usize).copied().flatten();
            group.and_then(|group| strengths.get(group as usize).copied()).unwrap_or(Vec3::ZERO)
        };
        self.emission = Vec3::ONE;
        self.emitters = surfaces.emitters().map(|emitters| EmitterTable::new(emitters, factor));
        self
    }

    /// The area lights, in the order of [`HitEmitter::Light`].
    pub fn areas(&self) -> &[LightSource] {
        &self.areas
    }

    /// Returns whether a ray may find light by chance.
    pub fn is_met_by_chance(&self) -> bool {
        let shines = self.emitters.as_ref().is_none_or(|table| !table.sums.is_empty());
        !self.areas.is_empty() || self.environment.is_some() || (shines && self.emission != Vec3::ZERO)
    }

    /// Returns the linear RGB radiance that a hit emits, and the density of samples of [`Self::estimate`] at `from` in
    /// its direction, per steradian: 0 for what is found by chance alone.
    pub fn emitted(&self, hit: &Hit, from: Vec3) -> (Vec3, f32) {
        match hit.emitter {
            Some(HitEmitter::Light(number)) => {
                let light = self.areas.get(number as usize);
                (hit.emission, light.map_or(0.0, |light| area::density(light, from, hit.position)))
            }
            Some(HitEmitter::Surface(number)) => {
                let table = self.emitters.as_ref().and_then(|table| table.densities.get(number as usize));
                let way = hit.position - from;
                let cosine = hit.geometric_normal.dot(way.normalize_or_zero()).abs();
                let solid = table.map_or(0.0, |density| density * way.length_squared() / cosine);
                let factor = self.emitters.as_ref().and_then(|table| table.factors.get(number as usize));
                let factor = self.emission * factor.copied().unwrap_or(Vec3::ONE);
                (factor * hit.emission, if solid.is_finite() { solid } else { 0.0 })
            }
            None => (self.emission * hit.emission, 0.0),
        }
    }

    /// Returns the radiance of the environment along a ray that leaves the scene, and the density of samples of
    /// [`Self::estimate`] in its direction, per steradian.
    pub fn environment(&self, direction: Vec3) -> (Vec3, f32) {
        self.environment
            .as_ref()
            .map_or((Vec3::ZERO, 0.0), |sky| (sky.radiance(direction), sky.density(direction)))
    }

    /// Single-sample estimate of the RGB irradiance at a hit, light from each direction times [`Bsdf::over_lambertian`]:
    /// times the BSDF's albedo over π, the radiance that the hit reflects. A sample of every lamp, every area light, the
    /// shining triangles and the environment. All but the lamps' have the weight against rays that the [BSDF
    /// samples](Bsdf::sample), which find the same light by chance.
    pub fn estimate(
        &self,
        surfaces: &(impl Surfaces + ?Sized),
        hit: &Hit,
        bsdf: &Bsdf,
        stream: &mut Stream,
    ) -> Vec3 {
        let weigh = |irradiance, to_light| irradiance * bsdf.over_lambertian(to_light);
        let mut total = toward_hit_with(surfaces, &self.lamps, hit, stream, weigh);
        let epsilon = surfaces.epsilon_at(hit.position);
        let origin = |to_light| hit.offset_origin(to_light, epsilon);
        let mut add = |radiance: Vec3, to_light: Vec3, cosine: f32, density: f32| {
            total += weigh(radiance * (cosine / (density + bsdf.density(to_light))), to_light);
        };
        for light in &self.areas {
            let square = stream.square();
            if let Some(at) = arriving(surfaces, light, hit.position, hit.normal, origin, square) {
                add(at.radiance, at.to_light, at.cosine, at.density);
            }
        }
        if let Some(table) = self.emitters.as_ref().filter(|_| self.emission != Vec3::ZERO)
            && let Some(emitters) = surfaces.emitters()
            && let Some(at) = table.sample(emitters, hit, stream)
        {
            let left = surfaces.transmittance(origin(at.to_light), at.position);
            add(self.emission * at.radiance * left, at.to_light, at.cosine, at.density);
        }
        if let Some(environment) = &self.environment {
            let (to_light, density) = environment.sample(stream.square());
            let cosine = hit.normal.dot(to_light);
            if cosine > 0.0 && density > 0.0 {
                let to = beyond(surfaces, hit.position, to_light);
                let left = surfaces.transmittance(origin(to_light), to);
                add(environment.radiance(to_light) * left, to_light, cosine, density);
            }
        }
        total
    }
}

/// A sampled place of a shining triangle, as seen from a surface.
struct EmitterSample {
    position: Vec3,
    to_light: Vec3,
    radiance: Vec3,
    cosine: f32,
    /// Per steradian.
    density: f32,
}

impl EmitterTable {
    /// Samples a triangle toward a surface; `None` for no light.
    fn sample(&self, emitters: &dyn Emitters, hit: &Hit, stream: &mut Stream) -> Option<EmitterSample> {
        // 53 bits: there may be more triangles than 24 bits tell apart.
        let share = (stream.bits() >> 11) as f64 / (1u64 << 53) as f64;
        let square = stream.square();
        let number = self.choose(share)?;
        let triangle = emitters.emitter(number);
        let [a, b, c] = triangle.corners;
        // Uniform over the triangle (Turk 1990).
        let root = square.x.sqrt();
        let weights = [1.0 - root, root * (1.0 - square.y), root * square.y];
        let position = a * weights[0] + b * weights[1] + c * weights[2];
        let way = position - hit.position;
        let to_light = way.try_normalize()?;
        let cosine = hit.normal.dot(to_light);
        let flat = triangle.front().try_normalize()?.dot(to_light).abs();
        if cosine <= 0.0 || flat <= 0.0 {
            return None;
        }
        let radiance = self.factors[number as usize] * emitters.radiance(number, weights, to_light);
        let density = self.densities[number as usize] * way.length_squared() / flat;
        (radiance != Vec3::ZERO && density > 0.0 && density.is_finite()).then_some(EmitterSample {
            position,
            to_light,
            radiance,
            cosine,
            density,
        })
    }
}
