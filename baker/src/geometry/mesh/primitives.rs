//! Triangles as numbered [`Primitives`], for a [hit cache](crate::transport::direct_to_indirect) over the triangles.

use super::blas::{FIRST, TWO_SIDED};
use super::packet::MOST;
use super::triangle::TriangleHit;
use super::{LocatedTriangle, TriangleSurfaces};
use crate::geometry::{Primitive, Primitives, Ray, SurfaceCoordinates, SurfaceSample};
use glam::{Vec2, Vec3};

/// Minimum number of rays for a packet: fewer rays are faster one by one.
const WORTH_IT: usize = 3;

impl Primitives for TriangleSurfaces {
    fn count(&self) -> usize {
        self.primitives as usize
    }

    fn primitive(&self, primitive: u32) -> Primitive {
        let found = self.found(primitive);
        let LocatedTriangle { blas, triangle, .. } = found;
        let first = (blas.marks[triangle] & FIRST) as usize;
        let [a, b, c] = blas.corners[triangle].positions().map(|corner| found.place(corner));
        let (at, next, last) = [(a, b, c), (b, c, a), (c, a, b)][first];
        Primitive {
            sides: [at.distance(next), at.distance(last)],
            has_back: blas.marks[triangle] & TWO_SIDED != 0,
            middle: (a + b + c) / 3.0,
            normal: found.normal([1.0; 3]),
            kind: blas.attributes[triangle].material,
        }
    }

    fn spot(&self, place: SurfaceCoordinates, area: f32) -> SurfaceSample {
        let found = self.found(place.primitive);
        let LocatedTriangle { blas, triangle, .. } = found;
        let (look, corners) = (&blas.attributes[triangle], &blas.corners[triangle]);
        let [u, v, w] = [1.0 - place.at.x - place.at.y, place.at.x, place.at.y];
        let shares = match blas.marks[triangle] & FIRST {
            0 => [u, v, w],
            1 => [w, u, v],
            _ => [v, w, u],
        };
        let surface = &self.surfaces[look.material as usize];
        let spanned = found.front();
        let normal = match found.normal(shares) {
            Vec3::ZERO => spanned.normalize_or_zero(),
            normal => normal,
        };
        let (uv, [a, b, c]) = (look.uv(shares), corners.positions());
        let color = blas.color(&self.surfaces, triangle, shares);
        SurfaceSample {
            position: found.place(a * shares[0] + b * shares[1] + c * shares[2]),
            normal: if place.is_back { -normal } else { normal },
            albedo: surface.albedo(color, uv, look.share(spanned) * area),
            opacity: surface.opacity(color, uv),
            group: surface.group,
        }
    }

    fn find(&self, ray: &Ray, seed: u32) -> Option<(SurfaceCoordinates, f32)> {
        let (found, meeting) = self.nearest(ray, seed)?;
        self.place_of(ray, found, meeting)
    }

    fn find_seen(&self, ray: &Ray, seed: u32) -> Option<(SurfaceCoordinates, f32)> {
        let (found, meeting) = self.nearest_seen(ray, seed)?;
        self.place_of(ray, found, meeting)
    }

    fn intersect_packet(
        &self,
        rays: &[(Ray, u32)],
        numbers: &[u32],
        found: &mut Vec<Option<(SurfaceCoordinates, f32)>>,
    ) {
        found.clear();
        let of = |number: &u32| &rays[*number as usize];
        let class = |number: &u32| Ray::octant_and_axis(of(number).0.direction);
        let mut rest = numbers;
        while let Some(first) = rest.first() {
            let first = class(first);
            let alike = rest.iter().take(MOST).take_while(|number| class(number) == first);
            let (some, others) = rest.split_at(alike.count());
            rest = others;
            if some.len() < WORTH_IT {
                found.extend(some.iter().map(|number| self.find(&of(number).0, of(number).1)));
                continue;
            }
            let alone = self.static_blas.nearest_together(&self.surfaces, some.iter().map(of), first);
            found.extend(some.iter().zip(alone).map(|(number, alone)| {
                let (ray, seed) = of(number);
                let (found, meeting) = self.with_all(ray, *seed, alone)?;
                self.place_of(ray, found, meeting)
            }));
        }
    }
}

impl TriangleSurfaces {
    /// Returns location and distance of a hit; `None` if the surface reflects no light at the hit.
    #[inline]
    fn place_of(
        &self,
        ray: &Ray,
        found: LocatedTriangle,
        meeting: TriangleHit,
    ) -> Option<(SurfaceCoordinates, f32)> {
        let is_back = found.front().dot(ray.direction) > 0.0;
        let marks = found.blas.marks[found.triangle];
        if is_back && marks & TWO_SIDED == 0 {
            return None;
        }
        let [u, v, w] = meeting.shares();
        let at = match marks & FIRST {
            0 => Vec2::new(v, w),
            1 => Vec2::new(w, u),
            _ => Vec2::new(u, v),
        };
        let first = found.copy.map_or(0, |copy| copy.first_primitive);
        Some((SurfaceCoordinates { primitive: first + found.triangle as u32, at, is_back }, meeting.distance))
    }
}
