//! Triangles as [`Pieces`].

use super::body::{FIRST, TWO_SIDED};
#[cfg(target_arch = "x86_64")]
use super::packet::MOST;
use super::triangle::Meeting;
use super::{Found, TriangleSurfaces};
use crate::surface::{Piece, Pieces, Place, Ray, Spot};
use glam::{Vec2, Vec3};

/// Fewer rays are quicker one by one.
#[cfg(target_arch = "x86_64")]
const WORTH_IT: usize = 3;

impl Pieces for TriangleSurfaces {
    fn count(&self) -> usize {
        self.pieces as usize
    }

    fn piece(&self, piece: u32) -> Piece {
        let found = self.found(piece);
        let Found { body, triangle, .. } = found;
        let first = (body.marks[triangle] & FIRST) as usize;
        let [a, b, c] = body.corners[triangle].positions().map(|corner| found.place(corner));
        let (at, next, last) = [(a, b, c), (b, c, a), (c, a, b)][first];
        Piece {
            sides: [at.distance(next), at.distance(last)],
            has_back: body.marks[triangle] & TWO_SIDED != 0,
            middle: (a + b + c) / 3.0,
            normal: found.normal([1.0; 3]),
            kind: body.looks[triangle].material,
        }
    }

    fn spot(&self, place: Place, area: f32) -> Spot {
        let found = self.found(place.piece);
        let Found { body, triangle, .. } = found;
        let (look, corners) = (&body.looks[triangle], &body.corners[triangle]);
        let [u, v, w] = [1.0 - place.at.x - place.at.y, place.at.x, place.at.y];
        let shares = match body.marks[triangle] & FIRST {
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
        let color = body.color(&self.surfaces, triangle, shares);
        Spot {
            position: found.place(a * shares[0] + b * shares[1] + c * shares[2]),
            normal: if place.is_back { -normal } else { normal },
            albedo: surface.albedo(color, uv, look.share(spanned) * area),
            opacity: surface.opacity(color, uv),
        }
    }

    fn find(&self, ray: &Ray, seed: u32) -> Option<(Place, f32)> {
        let (found, meeting) = self.nearest(ray, seed)?;
        self.place_of(ray, found, meeting)
    }

    fn find_seen(&self, ray: &Ray, seed: u32) -> Option<(Place, f32)> {
        let (found, meeting) = self.nearest_seen(ray, seed)?;
        self.place_of(ray, found, meeting)
    }

    #[cfg(target_arch = "x86_64")]
    fn find_all(&self, rays: &[(Ray, u32)], numbers: &[u32], found: &mut Vec<Option<(Place, f32)>>) {
        found.clear();
        let of = |number: &u32| &rays[*number as usize];
        let class = |number: &u32| Ray::class(of(number).0.direction);
        let mut rest = numbers;
        while let Some(first) = rest.first() {
            let first = class(first);
            let alike = rest.iter().take(MOST).take_while(|number| class(number) == first);
            let (some, others) = rest.split_at(alike.count());
            rest = others;
            if some.len() < WORTH_IT || !crate::processor::has_avx2() {
                found.extend(some.iter().map(|number| self.find(&of(number).0, of(number).1)));
                continue;
            }
            // SAFETY: the processor has all that the function asks for.
            #[expect(unsafe_code, reason = "what a processor has is known when the program runs")]
            let alone = unsafe { self.alone.nearest_together(&self.surfaces, some.iter().map(of), first) };
            found.extend(some.iter().zip(alone).map(|(number, alone)| {
                let (ray, seed) = of(number);
                let (found, meeting) = self.with_all(ray, *seed, alone)?;
                self.place_of(ray, found, meeting)
            }));
        }
    }
}

impl TriangleSurfaces {
    /// The place where a ray ends, where light is reflected, and how far away it is.
    #[inline]
    fn place_of(&self, ray: &Ray, found: Found, meeting: Meeting) -> Option<(Place, f32)> {
        let is_back = found.front().dot(ray.direction) > 0.0;
        let marks = found.body.marks[found.triangle];
        if is_back && marks & TWO_SIDED == 0 {
            return None;
        }
        let [u, v, w] = meeting.shares();
        let at = match marks & FIRST {
            0 => Vec2::new(v, w),
            1 => Vec2::new(w, u),
            _ => Vec2::new(u, v),
        };
        let first = found.copy.map_or(0, |copy| copy.first_piece);
        Some((Place { piece: first + found.triangle as u32, at, is_back }, meeting.distance))
    }
}
