//! Reflections of metals: the light from each direction of a lobe, under the lobe of each hit. Several ways find it, to be
//! compared ([`Way`]).
//!
//! * here: the ways, and the lobe;
//! * `seen` – the light of a surface that is seen in a reflection;
//! * `cube_maps` – cube maps of the surroundings, lit anew for a picture;
//! * `screen` – rays in the picture;
//! * `cost` – how much work the ways do.

pub mod cost;
pub mod cube_maps;
mod screen;
mod seen;

use super::Relit;
use crate::basis::Leveled;
use crate::geometry::{Hit, Surfaces};
use crate::random::Stream;
use crate::sampling::cube_maps::{CubeMapSettings, cube_maps};
use cost::{Cost, CostSums};
use cube_maps::{CubeMapLookup, CubeMaps};
use glam::{Vec2, Vec3};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::camera::CameraFrame;
use rebounce_shared::environment::reflection::{ReflectedSky, of_skies};
use rebounce_shared::gloss::{Arriving, Fresnel, GlossyField, over_lobe};
use rebounce_shared::lighting::Lighting;
use screen::Screen;

/// Where the light of a lobe's directions comes from.
#[derive(Clone, Copy, Debug, Default)]
pub enum Way {
    /// As pages do: the [cube maps](mod@cube_maps) of the file, or the transfer in files without.
    #[default]
    Baked,
    /// What arrives at the points by [glossy transfer](rebounce_shared::gloss): harmonics, and the environment through its
    /// visibility.
    Transfer,
    /// A ray cast for each sample of the lobe: the least error that other ways can have.
    Rays,
    /// [Cube maps](mod@cube_maps) made for the picture.
    CubeMaps(CubeMapSettings, CubeMapLookup),
    /// Rays in the picture. What they do not find comes from cube maps, or from the transfer.
    Screen(ReflectionView, Option<CubeMapSettings>),
}

/// The picture that rays in the picture look at.
#[derive(Clone, Copy, Debug)]
pub struct ReflectionView {
    /// The camera.
    pub frame: CameraFrame,
    /// Width and height, pixels.
    pub size: [u32; 2],
}

/// Light that metals reflect.
pub(super) struct Reflections {
    field: GlossyField,
    source: ReflectionSource,
    tally: CostSums,
}

/// A way with its data.
enum ReflectionSource {
    Transfer,
    Rays,
    CubeMaps(CubeMaps),
    Screen(Screen, Option<CubeMaps>),
}

/// The environments of a lighting as surfaces reflect them.
fn skies(lighting: &Lighting) -> Vec<ReflectedSky<'_>> {
    lighting.background.iter().map(|background| background.reflected()).collect()
}

impl Reflections {
    /// Applies the glossy transfer of a file to what its senders send; `None` if it has none.
    pub fn new(scene: &BakedScene, lighting: &Lighting, sent: &[Vec3]) -> Option<Self> {
        let field = GlossyField::new(scene, lighting, sent);
        (!field.is_empty()).then(|| Self {
            field,
            source: ReflectionSource::Transfer,
            tally: CostSums::default(),
        })
    }

    /// With the light of lobes from elsewhere. `relit` is the scene under the same lighting, without reflections.
    pub fn by(self, way: &Way, relit: &Relit, scene: &BakedScene, surfaces: &impl Surfaces) -> Self {
        let lit = |maps: &_, lookup| CubeMaps::new(maps, lookup, &self, relit, scene, surfaces);
        let made = |settings, lookup| lit(&cube_maps(surfaces, scene, settings), lookup);
        let source = match way {
            Way::Baked if !scene.cube_maps.is_empty() => {
                ReflectionSource::CubeMaps(lit(&scene.cube_maps, CubeMapLookup::PAGE))
            }
            Way::Baked | Way::Transfer => ReflectionSource::Transfer,
            Way::Rays => ReflectionSource::Rays,
            Way::CubeMaps(settings, lookup) => ReflectionSource::CubeMaps(made(settings, *lookup)),
            Way::Screen(view, behind) => {
                let seen =
                    |hit: &Hit, direction, stream: &mut _| self.seen(relit, surfaces, hit, direction, stream);
                let maps = behind.as_ref().map(|settings| made(settings, CubeMapLookup::default()));
                ReflectionSource::Screen(Screen::new(view, surfaces, &seen), maps)
            }
        };
        Self { source, ..self }
    }

    /// Work done so far.
    pub fn cost(&self) -> Cost {
        self.tally.cost()
    }

    /// The cube maps, where they are used.
    pub fn cube_maps(&self) -> Option<&CubeMaps> {
        match &self.source {
            ReflectionSource::CubeMaps(maps) | ReflectionSource::Screen(_, Some(maps)) => Some(maps),
            _ => None,
        }
    }

    /// What arrives at a place of a reconstruction group; `None` where the transfer does not reach.
    fn arriving(&self, basis: &Leveled, position: Vec3, normal: Vec3, group: u32) -> Option<Arriving> {
        let mut weights = Vec::with_capacity(64);
        basis.interpolate(position, normal, group, &mut weights);
        self.field.mean(&weights)
    }

    /// Radiance that a metal sends along a ray by the transfer, without the light of lamps: a GGX conductor whose reflectance
    /// is the albedo at every angle. `None` where the transfer does not reach.
    fn by_transfer(&self, lighting: &Lighting, basis: &Leveled, hit: &Hit, direction: Vec3) -> Option<Vec3> {
        let arriving = self.arriving(basis, hit.position, hit.normal, hit.group)?;
        let skies = skies(lighting);
        Some(conducted(hit, direction, Vec2::ZERO, |to_light, solid_angle| {
            self.field.radiance(&arriving, &skies, to_light, solid_angle)
        }))
    }

    /// Radiance that a metal sends along a ray, without the light of lamps. `None` where the transfer does not reach.
    pub fn of_metal(
        &self,
        relit: &Relit,
        surfaces: &impl Surfaces,
        hit: &Hit,
        direction: Vec3,
        stream: &mut Stream,
    ) -> Option<Vec3> {
        let (lighting, basis) = (&relit.lighting, &relit.basis);
        let is_smooth = match &self.source {
            ReflectionSource::Transfer => true,
            ReflectionSource::CubeMaps(maps) => !maps.reflects(hit.gloss.roughness),
            ReflectionSource::Rays | ReflectionSource::Screen(..) => false,
        };
        if is_smooth {
            return self.by_transfer(lighting, basis, hit, direction);
        }
        let maps = self.cube_maps();
        let arriving = match maps.is_none_or(CubeMaps::needs_transfer) {
            true => Some(self.arriving(basis, hit.position, hit.normal, hit.group)?),
            false => None,
        };
        let skies = skies(lighting);
        let sky = |to_light, solid_angle| of_skies(&skies, to_light, solid_angle);
        let by_transfer = |to_light, solid_angle| match &arriving {
            Some(arriving) => self.field.radiance(arriving, &skies, to_light, solid_angle),
            None => Vec3::ZERO,
        };
        let mut cost = Cost { lobes: 1, ..Cost::default() };
        // What is not blurred as wide as a sample is averaged over the samples of a pixel.
        let shift = match self.source {
            ReflectionSource::Rays | ReflectionSource::Screen(..) => stream.square(),
            ReflectionSource::Transfer | ReflectionSource::CubeMaps(_) => Vec2::ZERO,
        };
        let maps = maps.map(|maps| maps.around(hit, direction, &mut cost));
        let radiance = conducted(hit, direction, shift, |to_light, solid_angle| {
            cost.samples += 1;
            // As path tracers have it: nothing arrives from within.
            if hit.geometric_normal.dot(to_light) <= 0.0 {
                return Vec3::ZERO;
            }
            let far = |cost: &mut Cost| match &maps {
                None => by_transfer(to_light, solid_angle),
                Some(maps) => {
                    let found = maps.radiance(to_light, solid_angle, || sky(to_light, solid_angle), cost);
                    found.unwrap_or_else(|| by_transfer(to_light, solid_angle))
                }
            };
            match &self.source {
                ReflectionSource::Rays => {
                    let sky = || sky(to_light, solid_angle);
                    self.along_ray(relit, surfaces, hit, to_light, sky, stream)
                }
                ReflectionSource::Screen(screen, _) => {
                    let found = screen.radiance(hit, to_light, surfaces.epsilon_at(hit.position), &mut cost);
                    found.unwrap_or_else(|| {
                        cost.fallbacks += 1;
                        far(&mut cost)
                    })
                }
                ReflectionSource::Transfer | ReflectionSource::CubeMaps(_) => far(&mut cost),
            }
        });
        self.tally.add(cost);
        Some(radiance)
    }
}

impl Relit {
    /// With metals as GGX conductors in pictures of all light, as pages have them. `scene` and `surfaces` are those of
    /// [`Self::new`].
    pub fn with_gloss(self, scene: &BakedScene, surfaces: &impl Surfaces) -> Self {
        self.with_reflections(scene, surfaces, &Way::Baked)
    }

    /// As [`Self::with_gloss`], with the light of lobes from elsewhere.
    pub fn with_reflections(mut self, scene: &BakedScene, surfaces: &impl Surfaces, way: &Way) -> Self {
        self = self.with_transfer(scene);
        let reflections = self.reflections.take();
        self.reflections = reflections.map(|of| of.by(way, &self, scene, surfaces));
        self
    }

    /// Work of the reflections so far.
    pub fn reflection_cost(&self) -> Cost {
        self.reflections.as_ref().map(Reflections::cost).unwrap_or_default()
    }

    /// The cube maps that metals reflect; `None` where reflections come from elsewhere.
    pub fn cube_maps(&self) -> Option<&CubeMaps> {
        self.reflections.as_ref()?.cube_maps()
    }
}

/// Radiance that a metal sends along a ray in `direction`, of light from the directions of its lobe.
fn conducted(hit: &Hit, direction: Vec3, shift: Vec2, radiance: impl FnMut(Vec3, f32) -> Vec3) -> Vec3 {
    let lobe = over_lobe(hit.gloss.roughness, hit.normal, -direction, shift, radiance);
    lobe.reflected(&Fresnel { head_on: hit.albedo, grazing: hit.albedo })
}
