//! Interface between light transport and geometry (paper, section 5.1).
//!
//! Points, basis, operator and renderers access surfaces through [`Surfaces`] only: a ray cast, with position, normal
//! and reflectance at the hit. A new kind of surface implements [`Surfaces`]. It may also implement [`Primitives`], so
//! that data at hits is precomputed instead of evaluated per hit, and [`Tessellate`], so that it can be drawn.
//! [`Emitters`] lets a path tracer sample what shines. `examples/implicit.rs` bakes metaballs and a quadric.

#[cfg(feature = "exact-faces")]
pub mod brep;
#[cfg(not(feature = "exact-faces"))]
#[path = "no_brep.rs"]
mod brep;
mod bvh8;
mod emitters;
pub mod mesh;
pub(crate) mod nearest;
mod scene_surfaces;
pub mod simplify;
mod tessellate;
pub mod with_lights;

pub use emitters::{EmissiveTriangle, Emitters, HitEmitter};
pub use scene_surfaces::SceneSurfaces;
pub use tessellate::Tessellate;

use glam::{Vec2, Vec3};

/// A ray in local space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Origin. Casting ignores nothing near the origin: offset it by [`Hit::offset_origin`].
    pub origin: Vec3,
    /// Unit direction.
    pub direction: Vec3,
    /// Maximum distance of a hit, scene units; may be infinite.
    pub max_distance: f32,
    /// Width of the beam represented by the ray, per unit of distance: reflectance is averaged over a footprint of
    /// about this width. 0 for a line; [`Ray::VISIBILITY`] if reflectance is not used.
    pub spread: f32,
}

impl Ray {
    /// [`Self::spread`] of visibility rays, cast for the positions of surfaces, not for reflectance: reads a texture's
    /// mean instead of texels.
    pub const VISIBILITY: f32 = f32::INFINITY;
    /// Number of classes of [`Self::octant_and_axis`].
    pub const OCTANTS_AND_AXES: usize = 24;

    /// Returns a visibility ray of unlimited length.
    pub fn visibility(origin: Vec3, direction: Vec3) -> Self {
        Self { origin, direction, max_distance: f32::INFINITY, spread: Self::VISIBILITY }
    }

    /// Returns the axis of the direction's largest component by magnitude: 0, 1 or 2.
    #[inline]
    pub fn major_axis(direction: Vec3) -> usize {
        let size = direction.abs();
        if size.x > size.y && size.x > size.z {
            0
        } else if size.y > size.z {
            1
        } else {
            2
        }
    }

    /// Returns the class of a direction, by octant and major axis; less than [`Self::OCTANTS_AND_AXES`]. The three
    /// lowest bits are the sign bits of x, y and z (1: negative); the bits above are the [`Self::major_axis`].
    #[inline]
    pub fn octant_and_axis(direction: Vec3) -> u8 {
        (Self::major_axis(direction) << 3) as u8 | direction.is_negative_bitmask() as u8
    }
}

/// Intersection of a ray with a surface.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// Distance from the ray's origin, scene units.
    pub distance: f32,
    /// Local space.
    pub position: Vec3,
    /// Unit normal of the true surface, on the side the ray came from.
    pub geometric_normal: Vec3,
    /// Unit shading normal. Of a two-sided surface, on the side the ray came from.
    pub normal: Vec3,
    /// Linear RGB reflectance towards the ray's origin; zero on the back of a one-sided surface (`normal` points away
    /// from the ray's origin).
    pub albedo: Vec3,
    /// Linear RGB radiance emitted by the surface towards the ray's origin.
    pub emission: Vec3,
    /// What emits it, if it can be sampled: its density is known.
    pub emitter: Option<HitEmitter>,
    /// Whether pictures show the emission in place of reflected light (unlit material).
    pub is_unlit: bool,
    /// [Reconstruction group](rebounce_shared::rbn::groups) of the surface.
    pub group: u32,
    /// Place in the [lightmap](rebounce_shared::rbn::lightmap), texels; `None` where the surface has no chart.
    pub lightmap: Option<Vec2>,
    /// How the surface shines.
    pub gloss: Gloss,
}

/// How a surface shines: glTF's metallic-roughness model. Transport between points and pictures without gloss take every
/// surface for Lambertian.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gloss {
    /// Metalness, 0 to 1.
    pub metallic: f32,
    /// Roughness, 0 to 1.
    pub roughness: f32,
    /// Specular strength of what is not metal, 0 to 1.
    pub specular: f32,
}

impl Gloss {
    /// A surface without any.
    pub const MATT: Self = Self { metallic: 0.0, roughness: 1.0, specular: 0.0 };

    /// Whether the surface counts as a metal.
    #[inline]
    pub fn is_metal(self) -> bool {
        self.metallic > 0.5
    }
}

impl Hit {
    /// Returns whether the surface reflects light towards the ray's origin: false on the back of a one-sided surface.
    #[inline]
    pub fn faces(&self, ray_direction: Vec3) -> bool {
        self.normal.dot(ray_direction) < 0.0
    }

    /// Returns the origin for a ray that leaves the hit in `direction`: `position`, moved off the surface by `epsilon`
    /// scene units to the side of `direction`.
    #[inline]
    pub fn offset_origin(&self, direction: Vec3, epsilon: f32) -> Vec3 {
        self.position + self.geometric_normal * epsilon.copysign(self.geometric_normal.dot(direction))
    }
}

/// Geometry for ray casts. Coordinates are in local space (world − the scene's origin).
pub trait Surfaces: Sync {
    /// Returns the nearest hit. A partly transparent surface lets a ray through with its transmittance, averaged over
    /// the colour channels, as probability. Only `seed` decides: an equal ray and seed give an equal hit.
    fn cast(&self, ray: &Ray, seed: u32) -> Option<Hit>;

    /// Returns the nearest hit with a surface of a reconstruction group. `None` past more than `most` surfaces of others.
    fn cast_group(&self, mut ray: Ray, group: u32, most: u32, seed: u32) -> Option<Hit> {
        for _ in 0..=most {
            let hit = self.cast(&ray, seed)?;
            if hit.group == group {
                return Some(hit);
            }
            let passed = hit.distance + self.epsilon_at(hit.position);
            ray.origin += passed * ray.direction;
            ray.max_distance -= passed;
            if ray.max_distance <= 0.0 {
                break;
            }
        }
        None
    }

    /// Returns the nearest hit of a camera ray: backs of one-sided surfaces are culled, as in glTF. For light, backs
    /// are opaque, so only rays from an eye or a viewpoint use this function. Without a nearer back, the hit equals
    /// the hit of [`Self::cast`].
    fn see(&self, ray: &Ray, seed: u32) -> Option<Hit>;

    /// Returns the transmittance between `from` and `to`, linear RGB, 0 to 1: the product of the transmittances of the
    /// surfaces in between. `to` may be far outside the scene.
    fn transmittance(&self, from: Vec3, to: Vec3) -> Vec3;

    /// Returns the tint of light along a ray up to a hit at this distance, linear RGB: the product, over the surfaces
    /// passed, of transmittance over the pass-through probability of [`Self::cast`]. White without coloured surfaces.
    /// `from_eye`: the hit is a hit of [`Self::see`], and backs of one-sided surfaces are culled.
    fn tint(&self, _ray: &Ray, _distance: f32, _from_eye: bool) -> Vec3 {
        Vec3::ONE
    }

    /// Returns the minimum and maximum corner of the geometry.
    fn bounds(&self) -> (Vec3, Vec3);

    /// Returns the minimum and maximum corner of the main part: the part with the detail, if far smaller than
    /// [`Self::bounds`].
    fn main_part(&self) -> (Vec3, Vec3) {
        self.bounds()
    }

    /// Returns a safe offset of ray origins from surfaces in the [main part](Self::main_part), scene units.
    fn epsilon(&self) -> f32;

    /// Returns a safe offset at any position, scene units: larger at positions with less exact coordinates.
    #[inline]
    fn epsilon_at(&self, _position: Vec3) -> f32 {
        self.epsilon()
    }

    /// Returns whether some of the surfaces are unlit ([`Hit::is_unlit`]).
    fn has_unlit(&self) -> bool {
        false
    }

    /// Returns the primitives of the surfaces; `None` if unavailable.
    fn primitives(&self) -> Option<&dyn Primitives> {
        None
    }

    /// Returns the triangles that shine; `None` if unavailable: what shines is then found by chance alone.
    fn emitters(&self) -> Option<&dyn Emitters> {
        None
    }
}

/// Location on a primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceCoordinates {
    /// Number of the primitive.
    pub primitive: u32,
    /// Coordinates along the first and the second side, from the corner between the two sides; each coordinate and the
    /// sum are 0 to 1.
    pub at: Vec2,
    /// Whether the location is on the primitive's back.
    pub is_back: bool,
}

/// Triangle, flat or curved, of the surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Primitive {
    /// Lengths of the two sides of [`SurfaceCoordinates::at`], scene units; best if the third side is the longest.
    pub sides: [f32; 2],
    /// Whether the back reflects too.
    pub has_back: bool,
    /// Centre, local space.
    pub middle: Vec3,
    /// Unit normal at the centre, on the front, or zero.
    pub normal: Vec3,
    /// Number of the material: primitives of equal kind look alike at a common edge, and are of one reconstruction group.
    pub kind: u32,
}

/// Surface properties at a location.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceSample {
    /// Local space.
    pub position: Vec3,
    /// Unit shading normal, on the location's side.
    pub normal: Vec3,
    /// Linear RGB reflectance.
    pub albedo: Vec3,
    /// Fraction of rays stopped by the surface.
    pub opacity: f32,
    /// [Reconstruction group](rebounce_shared::rbn::groups) of the surface.
    pub group: u32,
}

/// Surfaces made of numbered primitives, so that data at hits is precomputed before rays are cast. Best if primitives
/// with neighbouring numbers are neighbours.
pub trait Primitives: Sync {
    /// Returns the number of primitives.
    fn count(&self) -> usize;

    /// Returns a primitive, by number.
    fn primitive(&self, primitive: u32) -> Primitive;

    /// Returns the surface properties at a location; reflectance is averaged over about this `area`, square scene
    /// units.
    fn spot(&self, place: SurfaceCoordinates, area: f32) -> SurfaceSample;

    /// Returns location and distance of the nearest hit; `None` also if the surface reflects no light at the hit:
    /// [`Surfaces::cast`] without shading. The location's side is the side of the true surface.
    fn find(&self, ray: &Ray, seed: u32) -> Option<(SurfaceCoordinates, f32)>;

    /// As [`Self::find`] for a camera ray: [`Surfaces::see`] without shading.
    fn find_seen(&self, ray: &Ray, seed: u32) -> Option<(SurfaceCoordinates, f32)>;

    /// As [`Self::find`] for the rays with these numbers, in the order of `numbers`; writes to `found`. Fastest if
    /// neighbouring rays have a common [class](Ray::octant_and_axis) and similar directions. Origins and directions
    /// are finite, and [`Ray::max_distance`] is never NaN.
    fn intersect_packet(
        &self,
        rays: &[(Ray, u32)],
        numbers: &[u32],
        found: &mut Vec<Option<(SurfaceCoordinates, f32)>>,
    ) {
        found.clear();
        found.extend(numbers.iter().map(|&number| {
            let (ray, seed) = &rays[number as usize];
            self.find(ray, *seed)
        }));
    }
}
