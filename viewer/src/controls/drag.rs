//! Dragging of the lights' handles.
//!
//! A light follows the pointer in a plane that faces the camera, but stays in front of the first surface visible
//! there: the light slides along closer surfaces. A spot's second handle aims the spot at the surface under the
//! pointer; a sun's handle turns the sun.

use super::Stage;
use super::gizmo::{self, Handle};
use glam::{DVec3, Vec2};
use rebounce_shared::light::{DIRECTION, Light, POSITION};
use std::f32::consts::PI;

/// A grabbed handle.
#[derive(Clone, Debug)]
pub struct Grip {
    /// The handle.
    pub handle: Handle,
    /// The light before the drag.
    pub before: Light,
    /// Offset from the handle to the pointer, pixels.
    offset: [f64; 2],
    /// Distance of the plane along the view, world units.
    depth: f32,
    /// Whether surfaces are ignored.
    free: bool,
}

impl Grip {
    /// Grabs a handle at the pointer's position.
    pub fn new(stage: &Stage, handle: Handle, at: [f64; 2]) -> Option<Self> {
        let ([x, y], depth) = gizmo::projected(stage, handle)?;
        let before = stage.lights.get(handle.light)?.clone();
        Some(Self { handle, before, offset: [at[0] - x as f64, at[1] - y as f64], depth, free: false })
    }

    /// Moves the pointer. `free`: passes through surfaces. `depth`: up moves the handle farther away and down
    /// closer, at the same place in the picture.
    pub fn drag(&mut self, stage: &mut Stage, [from, to]: [[f64; 2]; 2], free: bool, depth: bool) {
        self.free = free;
        let mut factor = 1.0;
        if depth {
            self.offset = [0, 1].map(|i| self.offset[i] + to[i] - from[i]);
            factor = (3.0 * (from[1] - to[1]) / stage.size[1].max(1) as f64).exp();
        }
        self.put(stage, to, factor);
    }

    /// Puts the handle under the pointer, in the plane at `factor` times the distance.
    pub fn put(&mut self, stage: &mut Stage, at: [f64; 2], factor: f64) {
        let [width, height] = stage.size;
        let [x, y] = [0, 1].map(|i| (at[i] - self.offset[i]) as f32);
        let frame = stage.frame();
        let ray = frame.direction(x, y, width, height);
        let ahead = ray.dot(frame.forward);
        let mut distance = self.depth * factor as f32 / ahead;
        let is_light = !self.handle.aim;
        if !self.free {
            // A spot is aimed at the visible surface at any distance.
            let gap = if is_light { 0.5 * stage.clearance } else { 0.0 };
            let hit = stage.seen_along(ray, if is_light { distance + gap } else { f32::INFINITY });
            distance = hit.map_or(distance, |hit| (hit.distance - gap).max(0.5 * hit.distance));
        }
        if factor != 1.0 {
            // Distances limited by a surface do not accumulate.
            self.depth = (distance * ahead).max(1e-3 * stage.extent as f32).min(4.0 * stage.extent as f32);
        }
        let place = stage.along(ray, distance);
        let Some(light) = stage.lights.get(self.handle.light) else { return };
        let moved = match (light.position(), light.direction()) {
            (Some(_), _) if is_light => light.with(POSITION.at, &place),
            (Some(position), Some(_)) => {
                let to = DVec3::from(place) - DVec3::from(position);
                let Some(direction) = to.try_normalize() else { return };
                light.with(DIRECTION.at, &direction.to_array())
            }
            (None, Some(_)) => {
                let size = stage.size.map(|side| side as f32);
                let across = Vec2::new(x - 0.5 * size[0], 0.5 * size[1] - y);
                let (sin, cos) = (PI * (across.length() / gizmo::map_radius(size)).min(1.0)).sin_cos();
                let across = across.normalize_or(Vec2::Y) * sin;
                let to_light = frame.right * across.x + frame.up * across.y + frame.forward * cos;
                light.with(DIRECTION.at, &(-to_light).as_dvec3().to_array())
            }
            (_, None) => return,
        };
        stage.lights[self.handle.light] = moved;
    }
}

#[cfg(test)]
mod tests {
    use super::super::gizmo::tests::lit;
    use super::*;
    use crate::scene::triangles::tests::two_sided;
    use glam::Vec3;

    const SPOT: Handle = Handle { light: 0, aim: false };

    fn place(stage: &Stage) -> DVec3 {
        let Light::Spot { position, .. } = &stage.lights[0] else { panic!() };
        DVec3::from(*position)
    }

    /// Drags a handle by this offset, in steps of about a pixel.
    fn dragged(stage: &mut Stage, handle: Handle, by: [f64; 2], free: bool, depth: bool) -> Grip {
        let ([x, y], _) = gizmo::projected(stage, handle).unwrap();
        let start = [x as f64 + 2.0, y as f64 - 1.0];
        let mut grip = Grip::new(stage, handle, start).unwrap();
        let at = |i: i32| [start[0] + by[0] * i as f64 / 50.0, start[1] + by[1] * i as f64 / 50.0];
        for i in 0..50 {
            grip.drag(stage, [at(i), at(i + 1)], free, depth);
        }
        grip
    }

    #[test]
    fn a_dragged_handle_stays_under_the_pointer() {
        let sun = Handle { light: 1, aim: false };
        for handle in [SPOT, Handle { light: 0, aim: true }, sun] {
            let mut s = lit();
            let ([x, y], _) = gizmo::projected(&s, handle).unwrap();
            dragged(&mut s, handle, [12.0, 9.0], false, false);
            let ([u, v], _) = gizmo::projected(&s, handle).unwrap();
            // The second handle keeps its distance, so it follows the pointer's direction only.
            let least = if handle.aim { 5.0 } else { 11.9 };
            assert!(u - x >= least && u - x < 12.1, "{}", u - x);
            if !handle.aim {
                assert!((v - y - 9.0).abs() < 0.1);
            }
        }
    }

    #[test]
    fn a_light_keeps_its_distance_where_nothing_is_in_the_way() {
        let mut s = lit();
        dragged(&mut s, SPOT, [60.0, 40.0], false, false);
        assert!((place(&s).z - lit().camera.target[2]).abs() < 1e-4);
    }

    #[test]
    fn it_never_passes_a_surface_that_the_eye_sees_and_with_shift_it_does() {
        // A wall that is closer to the camera on the right.
        let wall = [Vec3::new(-9.0, -50.0, -4.0), Vec3::new(9.0, -50.0, 6.0), Vec3::new(0.0, 90.0, 1.0)];
        let solid = std::rc::Rc::new(two_sided(&[wall]));
        let mut s = Stage { triangles: solid.clone(), ..lit() };
        let Light::Spot { position, .. } = &mut s.lights[0] else { panic!() };
        *position = [-3.0, 0.0, 0.0];
        let start = s.clone();
        let mut stopped = 0;
        for pixels in 0..200 {
            s.lights = start.lights.clone();
            dragged(&mut s, SPOT, [pixels as f64, 0.0], false, false);
            let eye = s.local(s.camera.position);
            let way = place(&s).as_vec3() - eye;
            assert!(solid.cast(eye, way.normalize(), way.length()).is_none(), "behind the wall at {pixels}");
            stopped += (place(&s).z > 0.1) as i32;
        }
        assert!((50..199).contains(&stopped), "{stopped}");
        dragged(&mut s, SPOT, [-120.0, 0.0], true, false);
        s.lights = start.lights.clone();
        dragged(&mut s, SPOT, [190.0, 0.0], true, false);
        assert!(place(&s).z.abs() < 1e-4, "with Shift: {}", place(&s));
    }

    #[test]
    fn back_from_a_surface_it_is_where_it_was() {
        let wall = [Vec3::new(0.0, -50.0, 3.0), Vec3::new(40.0, -50.0, 3.0), Vec3::new(2.0, 90.0, 3.0)];
        let mut s = Stage { triangles: two_sided(&[wall]).into(), ..lit() };
        let Light::Spot { position, .. } = &mut s.lights[0] else { panic!() };
        *position = [-2.0, 0.0, 0.0];
        let mut grip = dragged(&mut s, SPOT, [200.0, 0.0], false, false);
        assert!(place(&s).z > 2.0);
        let ([x, y], _) = gizmo::projected(&s, SPOT).unwrap();
        let at = [x as f64 + 2.0, y as f64 - 1.0];
        grip.drag(&mut s, [at, [at[0] - 200.0, at[1]]], false, false);
        assert!(place(&s).distance(DVec3::new(-2.0, 0.0, 0.0)) < 0.02, "{}", place(&s));
    }

    #[test]
    fn nearer_and_farther_it_keeps_its_place_in_the_picture() {
        let mut s = lit();
        let ([x, y], depth) = gizmo::projected(&s, SPOT).unwrap();
        dragged(&mut s, SPOT, [30.0, -50.0], false, true);
        let ([u, v], farther) = gizmo::projected(&s, SPOT).unwrap();
        assert!((u - x).hypot(v - y) < 0.1 && farther > 1.2 * depth, "{u} {v} {farther}");
    }

    #[test]
    fn a_spot_is_aimed_at_the_surface_under_the_pointer() {
        let wall = [Vec3::new(-90.0, -50.0, -4.0), Vec3::new(90.0, -50.0, -1.0), Vec3::new(0.0, 90.0, -6.0)];
        let aim = Handle { light: 0, aim: true };
        for [x, y] in [[60.0, 40.0], [-90.0, 30.0], [-150.0, 120.0], [30.0, -170.0]] {
            let mut s = Stage { triangles: two_sided(&[wall]).into(), ..lit() };
            let ([u, v], _) = gizmo::projected(&s, aim).unwrap();
            dragged(&mut s, aim, [x, y], false, false);
            let there = DVec3::from(s.surface_at([u as f64 + x, v as f64 + y]).unwrap());
            let Light::Spot { position, direction, .. } = s.lights[0] else { panic!() };
            let to = (there - DVec3::from(position)).normalize();
            assert!(DVec3::from(direction).normalize().dot(to) > 0.99999, "{direction:?} and {to}");
            // The handle stays there, on the lit surface.
            let ([p, q], _) = gizmo::projected(&s, aim).unwrap();
            assert!((p as f64 - u as f64 - x).hypot(q as f64 - v as f64 - y) < 0.5, "{p} {q}");
        }
    }

    #[test]
    fn a_sun_turns_around_the_scene() {
        let up = |y: f64| {
            let mut s = lit();
            dragged(&mut s, Handle { light: 1, aim: false }, [0.0, y], false, false);
            let Light::Directional { direction, .. } = s.lights[1] else { panic!() };
            DVec3::from(direction)
        };
        assert!(up(-60.0).y < -0.1, "dragged up, it shines down");
        assert!(up(60.0).y > 0.1 && (up(500.0).length() - 1.0).abs() < 1e-6);
    }
}
