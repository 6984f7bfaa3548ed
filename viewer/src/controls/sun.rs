//! Direction of a new sun: through an opening, if the view shows a room with openings.

use super::Stage;
use glam::Vec3;
use std::f32::consts::TAU;

/// Default direction of sunlight.
const USUAL: Vec3 = Vec3::new(-0.4, -1.0, -0.3);
/// Number of further directions: 16 azimuths at elevations of 22, 39 and 58 degrees.
const TRIES: usize = 3 * 16;
/// Rays through the picture, across and up.
const RAYS: [usize; 2] = [10, 6];

/// Returns the direction of sunlight that lights most of the visible surfaces. The default direction is kept unless
/// another direction lights more than twice as much.
pub fn sunlight(stage: &Stage) -> [f64; 3] {
    let frame = stage.frame();
    let eye = stage.local(stage.camera.position);
    let [width, height] = stage.size;
    let gap = 0.05 * stage.clearance;
    let mut light = [0.0; TRIES + 1];
    for i in 0..RAYS[0] * RAYS[1] {
        let x = (i % RAYS[0]) as f32 + 0.5;
        let y = (i / RAYS[0]) as f32 + 0.5;
        let ray = frame.direction(
            x / RAYS[0] as f32 * width as f32,
            y / RAYS[1] as f32 * height as f32,
            width,
            height,
        );
        let Some(hit) = stage.seen_along(ray, f32::INFINITY) else { continue };
        for (i, light) in light.iter_mut().enumerate() {
            let to_sun = -direction(i).normalize();
            let cosine = hit.normal.dot(to_sun);
            if cosine > 0.0 && stage.sees_sky(eye + ray * hit.distance + hit.normal * gap, to_sun, gap) {
                *light += cosine;
            }
        }
    }
    let (mut best, mut most) = (TRIES, 2.0 * light[TRIES]);
    for (i, light) in light.into_iter().enumerate() {
        if light > most && i < TRIES {
            (best, most) = (i, light);
        }
    }
    direction(best).as_dvec3().to_array()
}

/// Returns direction number `i`; the last is the default direction.
#[inline(never)]
fn direction(i: usize) -> Vec3 {
    if i == TRIES {
        return USUAL;
    }
    let (z, x) = (TAU / 16.0 * (i / 3) as f32).sin_cos();
    Vec3::new(x, [-0.4, -0.8, -1.6][i % 3], z)
}

impl Stage {
    /// Whether a ray of unit direction from a place in local space meets only glass or blended surfaces.
    fn sees_sky(&self, mut place: Vec3, ray: Vec3, gap: f32) -> bool {
        while let Some(hit) = self.triangles.cast(place, ray, f32::INFINITY) {
            if !hit.clear {
                return false;
            }
            place += ray * (hit.distance + gap);
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::stage;
    use super::*;
    use crate::scene::triangles::tests::two_sided;

    /// A room, 12 by 3 by 12, with an optional opening in the wall at z = -6 and in the wall at x = 6.
    fn room(open: [bool; 2]) -> Stage {
        let corners = [(-6.0, -6.0), (6.0, -6.0), (6.0, 6.0), (-6.0, 6.0), (-6.0, -6.0)];
        let quad = |a: Vec3, b: Vec3, c: Vec3, d: Vec3| [[a, b, c], [a, c, d]];
        let mut all = Vec::new();
        for (i, pair) in corners.windows(2).enumerate() {
            let at = |s: f32, y: f32| {
                let [a, b] = [pair[0], pair[1]].map(|(x, z)| Vec3::new(x, y, z));
                a.lerp(b, s)
            };
            let part = |s: [f32; 2], y: [f32; 2]| {
                quad(at(s[0], y[0]), at(s[1], y[0]), at(s[1], y[1]), at(s[0], y[1]))
            };
            if open.get(i) == Some(&true) {
                all.extend([part([0.0, 0.3], [-1.5, 1.5]), part([0.7, 1.0], [-1.5, 1.5])].concat());
                all.extend([part([0.3, 0.7], [-1.5, -0.8]), part([0.3, 0.7], [1.2, 1.5])].concat());
            } else {
                all.extend(part([0.0, 1.0], [-1.5, 1.5]));
            }
        }
        for y in [-1.5, 1.5] {
            let at = |x: f32, z: f32| Vec3::new(x, y, z);
            all.extend(quad(at(-6.0, -6.0), at(6.0, -6.0), at(6.0, 6.0), at(-6.0, 6.0)));
        }
        Stage { triangles: two_sided(&all).into(), ..stage() }
    }

    #[test]
    fn a_sun_shines_in_through_an_opening_on_whichever_side_it_is() {
        let ahead = Vec3::from(sunlight(&room([true, false])).map(|x| x as f32));
        assert!(ahead.z > 0.5 && ahead.y < 0.0, "{ahead}");
        let right = Vec3::from(sunlight(&room([false, true])).map(|x| x as f32));
        assert!(right.x < -0.5 && right.y < 0.0, "{right}");
    }

    #[test]
    fn in_a_closed_room_and_in_the_open_it_is_the_usual_one() {
        let usual = USUAL.as_dvec3().to_array();
        assert_eq!(sunlight(&room([false, false])), usual);
        assert_eq!(sunlight(&stage()), usual);
    }
}
