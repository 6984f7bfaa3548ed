//! Surfaces around a point, as the laws of [clip planes](crate::clip_planes) and of
//! [direct-light samples](crate::footprint::samples) see them: the baker casts rays at the scene, radiosity at a file whose
//! nodes have moved.

use glam::Vec3;

/// Hit of a ray that looks around a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurroundingHit {
    /// Distance from the ray's origin, scene units.
    pub distance: f32,
    /// Local space.
    pub position: Vec3,
    /// Unit normal of the true surface, on the side the ray came from.
    pub geometric_normal: Vec3,
    /// Unit shading normal.
    pub normal: Vec3,
    /// Whether the surface reflects light towards the ray's origin.
    pub faces: bool,
}

/// Surfaces for rays that look around a point. Coordinates are in local space.
pub trait Surroundings {
    /// Returns the nearest hit of a ray along a unit direction, up to a distance. Surfaces that let light through stop some
    /// rays; `seed` decides.
    fn cast(&self, origin: Vec3, direction: Vec3, max_distance: f32, seed: u32) -> Option<SurroundingHit>;

    /// Whether at least half of the light goes from one place to another.
    fn is_open(&self, from: Vec3, to: Vec3) -> bool;
}

/// A point and its support.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SupportedPoint {
    /// Local space.
    pub position: Vec3,
    /// Unit shading normal.
    pub normal: Vec3,
    /// Unit normal of the true surface, along which ray origins are moved off.
    pub geometric_normal: Vec3,
    /// Radius of the support, scene units.
    pub radius: f32,
    /// Safe offset of ray origins from surfaces, scene units.
    pub epsilon: f32,
}
