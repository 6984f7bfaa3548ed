//! CPU reference renderer of a baked file: the expected output of the viewer.
//!
//! Direct light is sampled, of lamps as points, at the file's points with ray-cast visibility, the operator is
//! applied ([`rebounce_shared::relight`]), and at every visible point the display basis is
//! evaluated exactly: `E(x, n) = max(0, n · Σ w_j V_j / Σ w_j)` (paper, Eq. 6 and 8), reflected
//! with albedo / π.

pub mod backdrop;
pub mod posed;
pub mod reflections;
pub mod shown;
pub mod unlit;

use crate::basis::Leveled;
use crate::geometry::mesh::geometry::WITH_LIGHTMAPS;
use crate::geometry::with_lights::WithLights;
use crate::geometry::{Hit, HitEmitter, Ray, Surfaces};
use crate::io::picture::{Only, Picture};
use crate::light::bsdf::Bsdf;
use crate::light::direct;
use crate::random::Stream;
use crate::sampling::open_share;
use crate::verify::expose::{Exposure, expose};
use glam::Vec3;
use posed::PosedScene;
use rayon::prelude::*;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::camera::Camera;
use rebounce_shared::diffuse_transfer::{DistantLight, Received, TransferField};
use rebounce_shared::environment::{Environment, PackedEnvironment};
use rebounce_shared::light::{Light, LightSource};
use rebounce_shared::lighting::Lighting;
use rebounce_shared::lightmap::MixedLightmap;
use rebounce_shared::motion::Motions;
use rebounce_shared::openness::{REACH, gain, received};
use rebounce_shared::radiosity::solver::Scene;
use rebounce_shared::radiosity::{Accelerator, ClippedFunctions, RadiositySettings, solve};
use rebounce_shared::rbn::bulk::Point;
use rebounce_shared::relight::{self, GroupIrradiance};
use reflections::Reflections;
use std::f32::consts::FRAC_1_PI;
use std::sync::Arc;

/// Contents of a rendering.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Content {
    /// Components of light.
    pub only: Only,
    /// Whether bounced light is modulated by the openness of the visible surface.
    pub detail: bool,
}

impl From<Only> for Content {
    /// With detail.
    fn from(only: Only) -> Self {
        Self { only, detail: true }
    }
}

/// A baked scene, relit by given lights.
pub struct Relit {
    lighting: Lighting,
    /// Light of every point along the point's normal: irradiance of the bounced light, and of the light straight from
    /// the sky and emissive surfaces.
    irradiance: Vec<PointLight>,
    /// What the [senders send](relight::sent_after_bounces); empty where light is not the operator's.
    sent: Vec<Vec3>,
    /// Whether the light of the points is radiosity's.
    by_radiosity: bool,
    /// The same light at the texels of the file's lightmap; empty without one.
    lightmap: MixedLightmap,
    /// Group of emissive surfaces of each material.
    group_of: Vec<Option<u32>>,
    basis: Leveled,
    /// Radius of a pixel's openness, scene units; `None` without detail.
    reach: Option<f32>,
    /// Where the groups are; functions are where the file has them.
    motions: Motions,
    /// The pose of what deforms; `None` at rest.
    posed: Option<Arc<PosedScene>>,
    /// What metals reflect; `None` where they are Lambertian.
    reflections: Option<Reflections>,
}

/// Irradiance, linear RGB.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PointLight {
    /// Of light that bounced at least once.
    pub bounced: Vec3,
    /// Straight from the sky and emissive surfaces.
    pub from_sources: Vec3,
}

impl PointLight {
    fn scaled(self, factor: f32) -> Self {
        Self { bounced: self.bounced * factor, from_sources: self.from_sources * factor }
    }

    fn plus(self, other: Self) -> Self {
        Self { bounced: self.bounced + other.bounced, from_sources: self.from_sources + other.from_sources }
    }
}

/// Rows and columns of the openness rays of a sample.
const OPENNESS_SIDE: u32 = 2;

impl Relit {
    /// Relights `scene`; an environment among the lights is the file's own. `surfaces` must be the surfaces of the same file,
    /// with the area lights among them: here and in every query ([`WithLights`]). With `detail`, light between the points
    /// follows the [openness](rebounce_shared::openness) of visible surfaces, if the file has the openness of the
    /// points.
    pub fn new(scene: &BakedScene, surfaces: &impl Surfaces, lights: &[Light], detail: bool) -> Self {
        Self::lit(scene, surfaces, own_lighting(scene, lights), detail)
    }

    /// As [`Self::new`], with all lighting.
    pub fn lit(scene: &BakedScene, surfaces: &impl Surfaces, lighting: Lighting, detail: bool) -> Self {
        Self::moved(scene, surfaces, lighting, detail, &Motions::default())
    }

    /// As [`Self::moved`], with a rig in a pose; `surfaces` are those of [`PosedScene::scene`].
    pub fn posed(
        scene: &BakedScene,
        surfaces: &impl Surfaces,
        lighting: Lighting,
        detail: bool,
        (motions, posed): (&Motions, Arc<PosedScene>),
    ) -> Self {
        let placed = Some(&posed.points[..]);
        Self {
            posed: Some(posed.clone()),
            ..Self::placed(scene, surfaces, lighting, detail, (motions, placed))
        }
    }

    /// As [`Self::lit`], with groups where `motions` have them; `surfaces` are [there](BakedScene::moved_instances), too.
    pub fn moved(
        scene: &BakedScene,
        surfaces: &impl Surfaces,
        lighting: Lighting,
        detail: bool,
        motions: &Motions,
    ) -> Self {
        Self::placed(scene, surfaces, lighting, detail, (motions, None))
    }

    /// `placed` has the points where direct light reaches them, where a pose has taken them elsewhere.
    fn placed(
        scene: &BakedScene,
        surfaces: &impl Surfaces,
        lighting: Lighting,
        detail: bool,
        (motions, placed): (&Motions, Option<&[Point]>),
    ) -> Self {
        let by_radiosity = !scene.is_precomputed() && (scene.is_unlinked() || !motions.is_empty());
        let accelerator = if by_radiosity { Accelerator::new(scene) } else { Accelerator::default() };
        let clipped;
        let scene = match by_radiosity && !motions.is_empty() {
            false => scene,
            true => {
                let placed = accelerator.placed(scene, motions);
                clipped = ClippedFunctions::new(scene, &accelerator, &placed, motions).of(scene);
                &clipped
            }
        };
        let (mut irradiance, sent) = match () {
            () if by_radiosity => {
                (gathered(scene, surfaces, &lighting, (&accelerator, motions, placed)), Vec::new())
            }
            () if scene.is_solved() => (mixed(scene, &lighting), Vec::new()),
            () if scene.is_for_environment() => (transferred(scene, &lighting), Vec::new()),
            () => relit(scene, surfaces, &lighting, placed.unwrap_or(&scene.points)),
        };
        let finest = scene.meta.levels.last().map_or(0.0, |level| level.support_radius);
        let reach = (detail && !scene.openness.is_empty()).then_some(REACH * finest);
        if reach.is_some() {
            irradiance.iter_mut().zip(&scene.openness).for_each(|(e, open)| *e = e.scaled(gain(*open)));
        }
        let basis = Leveled::of_baked(scene);
        let motions = motions.clone();
        let lightmap = match WITH_LIGHTMAPS {
            true => MixedLightmap::new(scene, &lighting.groups),
            false => MixedLightmap::default(),
        };
        let group_of = scene.sources.group_of_materials();
        Self {
            lighting,
            irradiance,
            sent,
            by_radiosity,
            lightmap,
            group_of,
            basis,
            reach,
            motions,
            posed: None,
            reflections: None,
        }
    }

    /// With metals as GGX conductors in pictures of all light, by the file's glossy transfer. What is lit by radiosity
    /// reflects nothing.
    fn with_transfer(self, scene: &BakedScene) -> Self {
        let reflections = match self.by_radiosity {
            true => None,
            false => Reflections::new(scene, &self.lighting, &self.sent),
        };
        Self { reflections, ..self }
    }

    /// Interpolates the points' light at a surface element of a reconstruction group, RGB, local space: without detail,
    /// the irradiance of the bounced light. Zero where no function of any level covers the position.
    pub fn interpolated(&self, position: Vec3, normal: Vec3, group: u32) -> Vec3 {
        self.light_at(position, normal, group).bounced
    }

    /// As [`Self::interpolated`], with the light straight from the sky and emissive surfaces.
    pub fn light_at(&self, position: Vec3, normal: Vec3, group: u32) -> PointLight {
        let mut weights = Vec::with_capacity(64);
        let posed = self.posed.as_ref().and_then(|posed| posed.at_rest(position, normal, group));
        let (position, normal) = posed.unwrap_or_else(|| self.motions.at_rest(position, normal, group));
        self.basis.interpolate(position, normal, group, &mut weights);
        let weighted = |(index, weight): &(u32, f32)| self.irradiance[*index as usize].scaled(*weight);
        let sum = weights.iter().map(weighted).fold(PointLight::default(), PointLight::plus);
        PointLight { bounced: sum.bounced.max(Vec3::ZERO), from_sources: sum.from_sources.max(Vec3::ZERO) }
    }

    /// RGB irradiance of the bounced light at a ray hit.
    pub fn indirect(&self, surfaces: &impl Surfaces, hit: &Hit, stream: &mut Stream) -> Vec3 {
        self.light_at_hit(surfaces, hit, stream).bounced
    }

    /// The light of the lightmap where the file has one, else of the points.
    fn light_at_hit(&self, surfaces: &impl Surfaces, hit: &Hit, stream: &mut Stream) -> PointLight {
        if let Some(texels) = hit.lightmap {
            let [bounced, from_sources] = self.lightmap.at(texels);
            return PointLight { bounced, from_sources };
        }
        let normals = [hit.normal, hit.geometric_normal];
        self.light_with_detail(surfaces, hit.position, normals, hit.group, stream)
    }

    /// As [`Self::light_at`], by the openness of the place where the picture has detail. `normals` are the shading normal and
    /// the true surface's.
    fn light_with_detail(
        &self,
        surfaces: &impl Surfaces,
        position: Vec3,
        normals: [Vec3; 2],
        group: u32,
        stream: &mut Stream,
    ) -> PointLight {
        let open = |reach| received(open_share(surfaces, position, normals, reach, OPENNESS_SIDE, stream));
        self.light_at(position, normals[0], group).scaled(self.reach.map_or(1.0, open))
    }

    /// The lamps of the picture, local space, suns of environments included.
    pub fn lamps(&self) -> &[LightSource] {
        &self.lighting.lamps
    }

    /// Renders a picture of the scene. `row_done` is called after each row, from any thread.
    pub fn picture(
        &self,
        scene: &BakedScene,
        surfaces: &impl Surfaces,
        camera: &Camera,
        exposure: Exposure,
        only: Only,
        row_done: impl Fn() + Sync,
    ) -> Picture {
        let radiance = |ray: &Ray, stream: &mut Stream| self.radiance(surfaces, ray, only, stream);
        expose(&camera.frame(scene.meta.origin), exposure, radiance, row_done)
    }

    /// Radiance emitted at a hit, by the strength of its group.
    fn emission(&self, surfaces: &impl Surfaces, hit: &Hit) -> Vec3 {
        let Some(HitEmitter::Surface(number)) = hit.emitter else { return hit.emission };
        let material = surfaces.emitters().map(|emitters| emitters.emitter(number).material);
        hit.emission * material.map_or(Vec3::ONE, |material| self.emission_strength(material))
    }

    /// Factor of the emission of a material, linear RGB.
    pub fn emission_strength(&self, material: u32) -> Vec3 {
        let group = self.group_of.get(material as usize).copied().flatten();
        let strength = group.and_then(|group| self.lighting.emission.get(group as usize));
        strength.copied().unwrap_or(Vec3::ONE)
    }

    /// RGB irradiance at a hit, of the components `only`: a single estimate.
    pub fn irradiance(&self, surfaces: &impl Surfaces, hit: &Hit, only: Only, stream: &mut Stream) -> Vec3 {
        let light = self.light_at_hit(surfaces, hit, stream);
        let mut irradiance = Vec3::ZERO;
        if only != Only::Indirect {
            irradiance += direct::toward_hit(surfaces, &self.lighting.lamps, hit, stream);
            irradiance += light.from_sources;
        }
        if only != Only::Direct {
            irradiance += light.bounced;
        }
        irradiance
    }

    /// Linear RGB radiance along `ray`, toward its origin.
    pub fn radiance(&self, surfaces: &impl Surfaces, ray: &Ray, only: Only, stream: &mut Stream) -> Vec3 {
        let Some(hit) = surfaces.see(ray, stream.bits() as u32) else {
            let is_shown = only != Only::Indirect && !self.lighting.background.is_empty();
            return match is_shown {
                true => self.lighting.behind(ray.direction) * surfaces.tint(ray, f32::INFINITY, true),
                false => Vec3::ZERO,
            };
        };
        let tint = surfaces.tint(ray, hit.distance, true);
        if hit.is_unlit {
            return if only == Only::All { tint * hit.emission } else { Vec3::ZERO };
        }
        if let Some(radiance) = self.of_metal(surfaces, &hit, ray, only, stream) {
            return tint * (radiance + self.emission(surfaces, &hit));
        }
        let irradiance = match hit.albedo {
            Vec3::ZERO => Vec3::ZERO,
            _ => self.irradiance(surfaces, &hit, only, stream),
        };
        let emission = if only == Only::Indirect { Vec3::ZERO } else { self.emission(surfaces, &hit) };
        tint * (hit.albedo * FRAC_1_PI * irradiance + emission)
    }
}

impl Relit {
    /// Radiance that a metal reflects along a ray; `None` for other surfaces, and where pictures have no gloss.
    fn of_metal(
        &self,
        surfaces: &impl Surfaces,
        hit: &Hit,
        ray: &Ray,
        only: Only,
        stream: &mut Stream,
    ) -> Option<Vec3> {
        let reflections = self.reflections.as_ref().filter(|_| only == Only::All && hit.gloss.is_metal())?;
        let around = reflections.of_metal(self, surfaces, hit, ray.direction, stream)?;
        Some(around + self.lamps_on_metal(surfaces, hit, ray.direction, stream))
    }

    /// Radiance of lamps that a metal reflects along a ray in `direction`: a single estimate.
    fn lamps_on_metal(
        &self,
        surfaces: &impl Surfaces,
        hit: &Hit,
        direction: Vec3,
        stream: &mut Stream,
    ) -> Vec3 {
        let bsdf = Bsdf::new(hit, -direction, true);
        let weigh = |irradiance, to_light| irradiance * bsdf.reflectance(to_light);
        direct::toward_hit_with(surfaces, &self.lighting.lamps, hit, stream, weigh)
    }
}

/// Returns the light of the points of a file whose lights move, and what its senders send; `points` are where direct light
/// reaches them.
fn relit(
    scene: &BakedScene,
    surfaces: &impl Surfaces,
    lighting: &Lighting,
    points: &[Point],
) -> (Vec<PointLight>, Vec<Vec3>) {
    let strengths = scene.sources.strengths(lighting.sky.as_deref(), &lighting.emission);
    let from_sources = relight::from_sources(scene, &strengths);
    let source = |i: usize| from_sources.get(i).copied().unwrap_or(Vec3::ZERO);
    let direct: Vec<Vec3> = points[..scene.direct_count()]
        .par_iter()
        .enumerate()
        .map(|(i, point)| direct::at_footprint(surfaces, &lighting.lamps, point) + source(i))
        .collect();
    let sent = relight::sent_after_bounces(scene, direct);
    let bounced = relight::transport(scene, &sent, scene.points.len());
    let light = |(i, bounced)| PointLight { bounced, from_sources: source(i) };
    (bounced.into_iter().enumerate().map(light).collect(), sent)
}

/// Returns the light of the points of a file without links, or of one whose groups have moved, by radiosity.
fn gathered(
    scene: &BakedScene,
    surfaces: &impl Surfaces,
    lighting: &Lighting,
    (accelerator, motions, placed): (&Accelerator, &Motions, Option<&[Point]>),
) -> Vec<PointLight> {
    let strengths = scene.sources.strengths(lighting.sky.as_deref(), &lighting.emission);
    let from_sources = relight::from_sources(scene, &strengths);
    let source = |i: usize| from_sources.get(i).copied().unwrap_or(Vec3::ZERO);
    let points = (0..scene.points.len()).into_par_iter();
    // What deforms is in no group that moves.
    let place = |i: usize| match placed.filter(|placed| placed[i] != scene.points[i]) {
        Some(placed) => placed[i],
        None => scene.moved_point(i, motions),
    };
    let mut direct: Vec<Vec3> =
        points.map(|i| direct::at_footprint(surfaces, &lighting.lamps, &place(i)) + source(i)).collect();
    relight::pull(scene, &mut direct);
    let solved = Scene { baked: scene, accelerator, motions };
    let solution = solve(solved, &RadiositySettings::default(), &direct, &|receivers, gather| {
        receivers.par_iter().map(|receiver| gather(*receiver)).collect()
    });
    let light = |(i, bounced)| PointLight { bounced, from_sources: source(i) };
    solution.irradiance.into_iter().enumerate().map(light).collect()
}

/// Returns the light of the points of a fixed solution.
fn mixed(scene: &BakedScene, lighting: &Lighting) -> Vec<PointLight> {
    let GroupIrradiance { bounced, direct } = relight::from_groups(scene, &lighting.groups);
    let pairs = bounced.into_iter().zip(direct);
    pairs.map(|(bounced, from_sources)| PointLight { bounced, from_sources }).collect()
}

/// Returns the light of the points of a file for an environment.
fn transferred(scene: &BakedScene, lighting: &Lighting) -> Vec<PointLight> {
    let received = TransferField::new(scene).irradiance(&DistantLight::new(lighting));
    let light = |Received { direct, bounced }| PointLight { bounced, from_sources: direct };
    received.into_iter().map(light).collect()
}

/// Returns the environment of a file; `None` without one.
pub fn packed_environment(scene: &BakedScene) -> Option<Arc<Environment>> {
    let packed = PackedEnvironment::from_bytes(&scene.sources.environment).ok()?;
    Some(Arc::new(packed.unpack()))
}

/// Prepares lights of a file, with the file's own environment. Lights that are not in their places in a fixed solution
/// ([`MovedLight`](rebounce_shared::light_group::MovedLight)) leave it without bounced light.
fn own_lighting(scene: &BakedScene, lights: &[Light]) -> Lighting {
    let environment = packed_environment(scene);
    let lighting = Lighting::new(lights, environment.as_ref(), scene.meta.origin, scene.sources.groups.len());
    lighting.clone().with_groups(scene.solved_lights(), lights).unwrap_or(lighting)
}

/// Renders a baked scene, and the area lights among its surfaces; an environment among the lights is the file's own.
/// `row_done` is called after each row, from any thread.
pub fn render(
    scene: &BakedScene,
    surfaces: &impl Surfaces,
    camera: &Camera,
    lights: &[Light],
    exposure: Exposure,
    content: impl Into<Content>,
    row_done: impl Fn() + Sync,
) -> Picture {
    let content = content.into();
    let lighting = own_lighting(scene, lights);
    let lamps = lighting.lamps.clone();
    let surfaces = &WithLights::new(surfaces, &lamps);
    let relit = Relit::lit(scene, surfaces, lighting, content.detail);
    relit.picture(scene, surfaces, camera, exposure, content.only, row_done)
}
