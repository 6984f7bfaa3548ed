//! The one interface between light transport and geometry (paper, section 5.1).
//!
//! Points, basis, operator and renderers know surfaces through [`Surfaces`] alone: cast a ray;
//! position, normal and reflectance at the hit. A new kind of surface implements this trait, and may tell its
//! [`Primitives`], so that what rays find need not be worked out hit by hit.

pub mod mesh;
pub mod simplify;

use glam::{Vec2, Vec3};

/// A ray in local space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts. Casting ignores nothing near the origin: offset it by [`Hit::offset_origin`].
    pub origin: Vec3,
    /// Unit direction.
    pub direction: Vec3,
    /// Only hits nearer than this count, scene units; may be infinite.
    pub max_distance: f32,
    /// What the ray stands for is this wide, per unit of distance: reflectance is averaged over about so much. 0 for a line;
    /// [`Ray::VISIBILITY`] where nobody asks for it.
    pub spread: f32,
}

impl Ray {
    /// [`Self::spread`] of rays that ask where surfaces are, not what they reflect: that costs no texels.
    pub const VISIBILITY: f32 = f32::INFINITY;
    /// Numbers of [`Self::octant_and_axis`].
    pub const OCTANTS_AND_AXES: usize = 24;

    /// A ray without end that asks where surfaces are.
    pub fn visibility(origin: Vec3, direction: Vec3) -> Self {
        Self { origin, direction, max_distance: f32::INFINITY, spread: Self::VISIBILITY }
    }

    /// The axis that a direction goes along most: 0, 1 or 2.
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

    /// A number under [`Self::OCTANTS_AND_AXES`], the same for directions that go up and down the same axes and most along the
    /// same one. In its three lowest bits is whether they go down x, y and z; above them, the [`Self::major_axis`].
    #[inline]
    pub fn octant_and_axis(direction: Vec3) -> u8 {
        (Self::major_axis(direction) << 3) as u8 | direction.is_negative_bitmask() as u8
    }
}

/// Where a ray met a surface.
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
    /// Linear RGB reflectance towards the ray's origin; zero on the back of a one-sided surface,
    /// which is where `normal` points away from the ray's origin.
    pub albedo: Vec3,
    /// Linear RGB radiance sent by the surface itself towards the ray's origin.
    pub emission: Vec3,
    /// Whether pictures show the emission in place of all that the surface reflects.
    pub is_unlit: bool,
}

impl Hit {
    /// True where light is reflected towards the ray's origin: not the back of a one-sided surface.
    #[inline]
    pub fn faces(&self, ray_direction: Vec3) -> bool {
        self.normal.dot(ray_direction) < 0.0
    }

    /// An origin for a ray that leaves this hit in `direction`: moved off the surface by `epsilon`
    /// scene units, to the side that `direction` points to.
    #[inline]
    pub fn offset_origin(&self, direction: Vec3, epsilon: f32) -> Vec3 {
        self.position + self.geometric_normal * epsilon.copysign(self.geometric_normal.dot(direction))
    }
}

/// Something that rays can be cast at. All space is local (world − the scene's origin).
pub trait Surfaces: Sync {
    /// The nearest hit. Partly transparent surfaces let a ray through with the mean over the channels of what they let
    /// through as probability, decided by `seed` alone: the same ray and seed give the same hit.
    fn cast(&self, ray: &Ray, seed: u32) -> Option<Hit>;

    /// What a camera sees along a ray: the nearest hit where the backs of one-sided surfaces are not there, as glTF culls
    /// them. They stop all light, so that only rays from an eye, or from a viewpoint, ask this. Where no back is nearer
    /// it is what [`Self::cast`] finds.
    fn see(&self, ray: &Ray, seed: u32) -> Option<Hit>;

    /// The share of light that gets from `from` to `to`, linear RGB, 0 to 1: the product of what all surfaces in between
    /// let through. `to` may be far outside the scene.
    fn transmittance(&self, from: Vec3, to: Vec3) -> Vec3;

    /// The colour of the light that a ray let through on its way to a hit this far away brings, linear RGB: the product of
    /// what each surface in between lets through over the probability of [`Self::cast`]. White where none is coloured.
    /// `from_eye` where [`Self::see`] found the hit: then backs of one-sided surfaces are not there.
    fn tint(&self, _ray: &Ray, _distance: f32, _from_eye: bool) -> Vec3 {
        Vec3::ONE
    }

    /// Least and greatest corner of everything that can be hit.
    fn bounds(&self) -> (Vec3, Vec3);

    /// The same of the part that has the detail, where that is far smaller than all.
    fn main_part(&self) -> (Vec3, Vec3) {
        self.bounds()
    }

    /// Safe distance to move ray origins off surfaces in the [main part](Self::main_part), scene units.
    fn epsilon(&self) -> f32;

    /// The same anywhere: more where numbers are less exact.
    #[inline]
    fn epsilon_at(&self, _position: Vec3) -> f32 {
        self.epsilon()
    }

    /// The primitives that the surfaces are made of; none where they do not tell.
    fn primitives(&self) -> Option<&dyn Primitives> {
        None
    }
}

/// A place on a primitive of surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceCoordinates {
    /// Number of the primitive.
    pub primitive: u32,
    /// How far along its first and its second side, from the corner between them; 0 to 1 each and together.
    pub at: Vec2,
    /// Whether it is the primitive's back.
    pub is_back: bool,
}

/// A triangle, flat or curved, that the surfaces are made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Primitive {
    /// Lengths of the two sides that [`SurfaceCoordinates::at`] counts along, scene units; best where the third side is the longest.
    pub sides: [f32; 2],
    /// Whether its back reflects too.
    pub has_back: bool,
    /// Its middle, local space.
    pub middle: Vec3,
    /// Unit normal there, on its front, or zero.
    pub normal: Vec3,
    /// Primitives of one kind look alike where they meet: of one material.
    pub kind: u32,
}

/// What a surface is at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceSample {
    /// Local space.
    pub position: Vec3,
    /// Unit shading normal, on the side that the place is on.
    pub normal: Vec3,
    /// Linear RGB reflectance.
    pub albedo: Vec3,
    /// The share of rays that it stops.
    pub opacity: f32,
}

/// Surfaces made of numbered primitives: what a ray finds on them can be worked out before it is cast. Best where primitives of
/// neighbouring numbers are neighbours.
pub trait Primitives: Sync {
    /// How many there are.
    fn count(&self) -> usize;

    /// A primitive, by number.
    fn primitive(&self, primitive: u32) -> Primitive;

    /// What is at a place; its reflectance is the mean over about this `area`, square scene units.
    fn spot(&self, place: SurfaceCoordinates, area: f32) -> SurfaceSample;

    /// Where the nearest hit is, and how far away, where light is reflected at all: [`Surfaces::cast`] without looking at
    /// what is there. Its side is that of the true surface.
    fn find(&self, ray: &Ray, seed: u32) -> Option<(SurfaceCoordinates, f32)>;

    /// The same for a ray from a camera: [`Surfaces::see`] without looking at what is there.
    fn find_seen(&self, ray: &Ray, seed: u32) -> Option<(SurfaceCoordinates, f32)>;

    /// The same for the rays of these numbers, in their order; quickest where neighbours are of one [class](Ray::octant_and_axis) and
    /// go alike. Origins and directions are finite, and no [`Ray::max_distance`] is NaN.
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
