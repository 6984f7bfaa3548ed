//! The lights' handles in the view: positions in the picture, and picking with a pointer.
//!
//! A light with a position has a handle there. With a direction besides, as of a spot, the light has a second handle on
//! the lit surface, or on the way there, inside the picture. A light with a direction alone has a handle on a map of
//! all directions around the picture's middle.

use super::Stage;
use super::shape::{Shape, radius};
use glam::{DVec3, Vec3};
use rebounce_shared::camera::CameraFrame;
use rebounce_shared::light::Light;
use std::f32::consts::PI;

/// Share of the scene's diagonal: distance of a spot's second handle from the first if the spot meets no surface.
const AIM: f64 = 0.12;
/// Shares of the picture around its middle for second handles; the first possible share is used.
const MIDDLE: [f32; 2] = [0.9, 0.99];
/// Share of the picture's shorter side: radius of the map of directions.
const MAP: f32 = 0.42;
/// Colour of selected handles.
const ACCENT: [f32; 4] = [1.0, 0.7, 0.33, 0.95];

/// A handle of a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Handle {
    /// Index of the light.
    pub light: usize,
    /// The second handle of a spot.
    pub aim: bool,
}

/// Highlighted handles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Marks {
    /// The handle under the pointer, or the dragged handle.
    pub hovered: Option<Handle>,
    /// The selected light.
    pub selected: Option<usize>,
    /// The node's handle under the pointer, or the dragged one.
    #[cfg(feature = "radiosity")]
    pub node: Option<super::node_gizmo::NodeHandle>,
}

/// A light's direction at unit length.
fn unit(direction: &[f64; 3]) -> Vec3 {
    DVec3::from(*direction).try_normalize().unwrap_or(DVec3::NEG_Y).as_vec3()
}

/// A vector in view space: right, up, ahead.
fn seen(frame: &CameraFrame, v: Vec3) -> Vec3 {
    Vec3::new(v.dot(frame.right), v.dot(frame.up), v.dot(frame.forward))
}

/// Distance of a second handle along a ray (origin and direction in view space): `wanted`, clamped to the part of
/// the ray inside the picture, away from its edge if possible.
fn visible(frame: &CameraFrame, size: [f32; 2], place: Vec3, direction: Vec3, wanted: f32) -> f32 {
    for share in MIDDLE {
        let high = share * frame.tan_half_yfov;
        let wide = high * size[0] / size[1];
        let [mut near, mut far] = [0.0f32, f32::INFINITY];
        for side in [(1.0, 0.0, wide), (-1.0, 0.0, wide), (0.0, 1.0, high), (0.0, -1.0, high)] {
            let (at, by) = (Vec3::from(side).dot(place), Vec3::from(side).dot(direction));
            if by > 0.0 {
                near = near.max(-at / by);
            } else {
                far = far.min(at / (-by).max(1e-9));
            }
        }
        if near <= far {
            return wanted.max(near).min(far);
        }
    }
    wanted
}

/// Radius of the map of directions, pixels.
pub(super) fn map_radius(size: [f32; 2]) -> f32 {
    MAP * size[0].min(size[1])
}

/// Position of a handle in the picture, pixels, and its distance along the view, world units. `None` behind the
/// eye.
pub(super) fn projected(stage: &Stage, handle: Handle) -> Option<([f32; 2], f32)> {
    let size = stage.size.map(|side| side as f32);
    let frame = stage.frame();
    let from_eye =
        |p: &[f64; 3]| seen(&frame, (DVec3::from(*p) - DVec3::from(stage.camera.position)).as_vec3());
    let light = stage.lights.get(handle.light)?;
    let place = match (light.position(), light.direction(), handle.aim) {
        (Some(position), _, false) => from_eye(&position),
        (Some(position), Some(direction), true) => {
            let (place, along) = (from_eye(&position), seen(&frame, unit(&direction)));
            let hit = stage.triangles.cast(stage.local(position), unit(&direction), f32::INFINITY);
            let wanted = hit.map_or((AIM * stage.extent) as f32, |hit| hit.distance);
            place + along * visible(&frame, size, place, along, wanted)
        }
        (None, Some(direction), false) => {
            // The middle is straight ahead, the map's edge straight behind.
            let to_light = seen(&frame, -unit(&direction));
            let across = to_light.truncate();
            let far = map_radius(size) * across.length().atan2(to_light.z) / PI;
            let [x, y] = (across.normalize_or(glam::Vec2::Y) * far).to_array();
            return Some(([0.5 * size[0] + x, 0.5 * size[1] - y], 1.0));
        }
        _ => return None,
    };
    if place.z <= 1e-6 * place.length() {
        return None;
    }
    let scale = 0.5 * size[1] / (frame.tan_half_yfov * place.z);
    Some(([0.5 * size[0] + place.x * scale, 0.5 * size[1] - place.y * scale], place.z))
}

fn handles(stage: &Stage) -> impl Iterator<Item = Handle> + '_ {
    (0..stage.lights.len()).flat_map(|light| [Handle { light, aim: true }, Handle { light, aim: false }])
}

/// Shapes of all lights' handles.
pub fn shapes(stage: &Stage, marks: Marks) -> Vec<Shape> {
    let r = radius(stage.size);
    let mut out = Vec::new();
    for handle in handles(stage) {
        let Some((at, _)) = projected(stage, handle) else { continue };
        let lit = if marks.hovered == Some(handle) { 1.35 } else { 1.0 };
        let disc = |radius: f32, hole: f32, color: [f32; 4]| Shape {
            centre: at,
            radius: radius * lit,
            hole: hole * lit,
            length: 0.0,
            angle: 0.0,
            color,
        };
        if handle.aim {
            if let Some((from, _)) = projected(stage, Handle { aim: false, ..handle }) {
                let (dx, dy) = (at[0] - from[0], at[1] - from[1]);
                for (width, color) in [(0.16, [0.0, 0.0, 0.0, 0.35]), (0.08, [1.0, 1.0, 1.0, 0.8])] {
                    out.push(Shape {
                        centre: [from[0] + 0.5 * dx, from[1] + 0.5 * dy],
                        radius: width * r,
                        hole: 0.0,
                        length: dx.hypot(dy),
                        angle: dy.atan2(dx),
                        color,
                    });
                }
            }
            out.push(disc(0.6 * r, 0.0, [0.0, 0.0, 0.0, 0.5]));
            out.push(disc(0.45 * r, 0.0, [1.0, 1.0, 1.0, 0.95]));
        } else {
            let [red, green, blue] = color(&stage.lights[handle.light]);
            out.push(disc(1.1 * r, 0.0, [0.0, 0.0, 0.0, 0.45]));
            if marks.selected == Some(handle.light) {
                out.push(disc(1.6 * r, 1.2 * r, ACCENT));
            }
            out.push(disc(r, 0.72 * r, [1.0, 1.0, 1.0, 0.95]));
            out.push(disc(0.6 * r, 0.0, [red, green, blue, 1.0]));
        }
    }
    out
}

/// Colour of a light's handle: the light's colour at the highest displayable brightness.
fn color(light: &Light) -> [f32; 3] {
    let color = light.color();
    let brightest = color.iter().fold(1e-12f64, |m, c| m.max(*c));
    color.map(|c| (c / brightest).max(0.0).powf(1.0 / 2.2) as f32)
}

/// Returns the nearest handle within `reach` pixels of a pointer, or nearly under the pointer.
pub fn pick(stage: &Stage, at: [f64; 2], reach: f64) -> Option<Handle> {
    let reach = reach.max(1.8 * radius(stage.size) as f64);
    handles(stage)
        .filter_map(|handle| {
            let ([x, y], _) = projected(stage, handle)?;
            let distance = (x as f64 - at[0]).hypot(y as f64 - at[1]);
            (distance <= reach).then_some((distance, handle))
        })
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, handle)| handle)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use rebounce_shared::camera::Camera;

    /// A spot, a sun and a point light behind the eye.
    pub fn lit() -> Stage {
        let color = [1.0; 3];
        let spot = Light::Spot {
            position: [1.0, 2.0, 0.0],
            direction: [0.0, -1.0, 0.0],
            outer_cone_deg: 30.0,
            inner_cone_deg: None,
            intensity: 1.0,
            color,
            radius: 0.0,
        };
        Stage {
            camera: Camera { position: [0.0, 0.0, 10.0], ..super::super::tests::stage().camera },
            lights: vec![
                spot,
                Light::Directional { direction: [1.0, 0.0, 0.0], intensity: 1.0, color, radius_deg: 0.0 },
                Light::Point { position: [0.0, 0.0, 20.0], intensity: 1.0, color, radius: 0.0 },
            ],
            ..super::super::tests::stage()
        }
    }

    #[test]
    fn lights_behind_the_eye_have_no_handle() {
        let s = lit();
        assert!(projected(&s, Handle { light: 2, aim: false }).is_none());
        let shapes = shapes(&s, Marks::default());
        assert!(!shapes.is_empty() && shapes.iter().all(|shape| shape.centre.iter().all(|c| c.is_finite())));
    }

    #[test]
    fn second_handles_and_suns_lie_in_the_picture() {
        let mut s = lit();
        for size in [[640, 480], [390, 844], [200, 100]] {
            s.size = size;
            let in_picture = |s: &Stage, handle| {
                let ([x, y], _) = projected(s, handle).unwrap();
                assert!(
                    x > 0.0 && y > 0.0 && x < size[0] as f32 && y < size[1] as f32,
                    "{handle:?}: {x} {y}"
                );
            };
            for i in 0..200 {
                let (sin, cos) = (i as f64).sin_cos();
                let to = [sin * (0.3 * i as f64).cos(), cos, sin * (0.3 * i as f64).sin()];
                let Light::Directional { direction, .. } = &mut s.lights[1] else { panic!() };
                *direction = to;
                in_picture(&s, Handle { light: 1, aim: false });
                // The spot itself at the picture's edge, with any direction; and above the picture, looking down.
                let Light::Spot { direction, position, .. } = &mut s.lights[0] else { panic!() };
                (*position, *direction) = ([0.0, -5.0, 0.5], to);
                in_picture(&s, Handle { light: 0, aim: true });
                let Light::Spot { direction, position, .. } = &mut s.lights[0] else { panic!() };
                (*position, *direction) = ([0.0, 9.0, 0.0], [0.1 * to[0], -1.0, 0.1 * to[2]]);
                in_picture(&s, Handle { light: 0, aim: true });
            }
        }
    }

    #[test]
    fn fingers_reach_farther_than_a_mouse() {
        let s = lit();
        let handle = Handle { light: 0, aim: false };
        let ([x, y], _) = projected(&s, handle).unwrap();
        let beside = [x as f64 + 40.0, y as f64];
        assert_eq!((pick(&s, beside, 0.0), pick(&s, beside, 44.0)), (None, Some(handle)));
    }

    #[test]
    fn what_is_chosen_has_a_ring_and_what_is_under_the_pointer_grows() {
        let s = lit();
        let largest = |marks| shapes(&s, marks).iter().map(|shape| shape.radius).fold(0.0, f32::max);
        let plain = largest(Marks::default());
        let hovered = Some(Handle { light: 0, aim: false });
        assert!(largest(Marks { hovered, ..Marks::default() }) > 1.3 * plain);
        assert!(largest(Marks { selected: Some(1), ..Marks::default() }) > 1.3 * plain);
        assert_eq!(largest(Marks { selected: Some(9), ..Marks::default() }), plain);
    }
}
