//! The lights' handles in the view: where they lie, which one is under a pointer, and what dragging does.
//!
//! Point and spot lights have a handle at their place; spots a second one along their direction;
//! directional lights one from which they seem to come.

use super::Stage;
use glam::{DVec3, Vec3};
use rebounce_shared::camera::CameraFrame;
use rebounce_shared::light::Light;

/// Share of the scene's diagonal: how far a spot's second handle is from the first.
const AIM: f64 = 0.12;
/// Share of the scene's diagonal: how far a directional light's handle is from the scene's centre.
const SUN: f64 = 0.3;

/// A shape to draw, canvas pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// Its centre.
    pub centre: [f32; 2],
    /// Radius; half the width of a line.
    pub radius: f32,
    /// Radius of the hole; 0 for none.
    pub hole: f32,
    /// Length of a line; 0 for a disc.
    pub length: f32,
    /// Direction of a line, radians.
    pub angle: f32,
    /// Display RGB and alpha.
    pub color: [f32; 4],
}

/// Which handle of which light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Handle {
    /// Index of the light.
    pub light: usize,
    /// The second handle of a spot.
    pub aim: bool,
}

/// Where a handle lies, world space.
fn place(stage: &Stage, handle: Handle) -> Option<DVec3> {
    let unit = |d: &[f64; 3]| DVec3::from(*d).try_normalize().unwrap_or(DVec3::NEG_Y);
    match (stage.lights.get(handle.light)?, handle.aim) {
        (Light::Point { position, .. } | Light::Spot { position, .. }, false) => Some(DVec3::from(*position)),
        (Light::Spot { position, direction, .. }, true) => {
            Some(DVec3::from(*position) + unit(direction) * (AIM * stage.extent))
        }
        (Light::Directional { direction, .. }, false) => {
            Some(DVec3::from(stage.centre) - unit(direction) * (SUN * stage.extent))
        }
        _ => None,
    }
}

fn handles(stage: &Stage) -> impl Iterator<Item = Handle> + '_ {
    (0..stage.lights.len()).flat_map(|light| [Handle { light, aim: true }, Handle { light, aim: false }])
}

/// A world position in the picture: pixels, and the distance along the view. `None` behind the eye.
fn project(frame: &CameraFrame, place: DVec3, eye: DVec3, size: [u32; 2]) -> Option<([f32; 2], f32)> {
    let offset: Vec3 = (place - eye).as_vec3();
    let depth = offset.dot(frame.forward);
    if depth <= 1e-6 * offset.length() {
        return None;
    }
    let scale = 0.5 * size[1] as f32 / (frame.tan_half_yfov * depth);
    let x = 0.5 * size[0] as f32 + offset.dot(frame.right) * scale;
    let y = 0.5 * size[1] as f32 - offset.dot(frame.up) * scale;
    Some(([x, y], depth))
}

/// Radius of a handle, pixels, in a picture this high.
fn radius(size: [u32; 2]) -> f32 {
    (size[1] as f32 / 75.0).clamp(5.0, 18.0)
}

fn projected(stage: &Stage, handle: Handle, size: [u32; 2]) -> Option<([f32; 2], f32)> {
    let frame = stage.camera.frame([0.0; 3]);
    project(&frame, place(stage, handle)?, DVec3::from(stage.camera.position), size)
}

/// What to draw for all lights.
pub fn shapes(stage: &Stage, size: [u32; 2], active: Option<Handle>) -> Vec<Shape> {
    let r = radius(size);
    let mut out = Vec::new();
    for handle in handles(stage) {
        let Some((at, _)) = projected(stage, handle, size) else { continue };
        let lit = if active == Some(handle) { 1.35 } else { 1.0 };
        let disc = |radius: f32, hole: f32, color: [f32; 4]| Shape {
            centre: at,
            radius: radius * lit,
            hole: hole * lit,
            length: 0.0,
            angle: 0.0,
            color,
        };
        if handle.aim {
            if let Some((from, _)) = projected(stage, Handle { aim: false, ..handle }, size) {
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
            out.push(disc(r, 0.72 * r, [1.0, 1.0, 1.0, 0.95]));
            out.push(disc(0.6 * r, 0.0, [red, green, blue, 1.0]));
        }
    }
    out
}

/// A light's colour for its handle: as bright as a screen can show it.
fn color(light: &Light) -> [f32; 3] {
    let (Light::Point { color, .. } | Light::Spot { color, .. } | Light::Directional { color, .. }) = light;
    let brightest = color.iter().fold(1e-12f64, |m, c| m.max(*c));
    color.map(|c| (c / brightest).max(0.0).powf(1.0 / 2.2) as f32)
}

/// The handle under a pointer, nearest first.
pub fn pick(stage: &Stage, at: [f64; 2], size: [u32; 2]) -> Option<Handle> {
    let reach = 1.8 * radius(size) as f64;
    handles(stage)
        .filter_map(|handle| {
            let ([x, y], _) = projected(stage, handle, size)?;
            let distance = (x as f64 - at[0]).hypot(y as f64 - at[1]);
            (distance <= reach).then_some((distance, handle))
        })
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, handle)| handle)
}

/// Drags a handle by pixels: in the plane that faces the camera, or along the view with `depth`.
pub fn drag(stage: &mut Stage, handle: Handle, delta: [f64; 2], depth: bool, size: [u32; 2]) {
    let (Some(from), Some((_, distance))) = (place(stage, handle), projected(stage, handle, size)) else {
        return;
    };
    let frame = stage.camera.frame([0.0; 3]);
    let pixel = 2.0 * distance as f64 * frame.tan_half_yfov as f64 / size[1].max(1) as f64;
    let (right, up, forward) = (frame.right.as_dvec3(), frame.up.as_dvec3(), frame.forward.as_dvec3());
    let vertical = if depth { forward } else { up };
    let to = from + right * (delta[0] * pixel) - vertical * (delta[1] * pixel);
    let centre = DVec3::from(stage.centre);
    match (&mut stage.lights[handle.light], handle.aim) {
        (Light::Point { position, .. } | Light::Spot { position, .. }, false) => *position = to.to_array(),
        (Light::Spot { position, direction, .. }, true) => {
            if let Some(d) = (to - DVec3::from(*position)).try_normalize() {
                *direction = d.to_array();
            }
        }
        (Light::Directional { direction, .. }, _) => {
            if let Some(d) = (centre - to).try_normalize() {
                *direction = d.to_array();
            }
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rebounce_shared::camera::Camera;

    const SIZE: [u32; 2] = [640, 480];

    fn stage() -> Stage {
        let color = [1.0; 3];
        Stage {
            camera: Camera {
                position: [0.0, 0.0, 10.0],
                target: [0.0; 3],
                up: [0.0, 1.0, 0.0],
                yfov_deg: 60.0,
            },
            lights: vec![
                Light::Spot {
                    position: [1.0, 2.0, 0.0],
                    direction: [0.0, -1.0, 0.0],
                    outer_cone_deg: 30.0,
                    inner_cone_deg: None,
                    intensity: 1.0,
                    color,
                },
                Light::Directional { direction: [1.0, 0.0, 0.0], intensity: 1.0, color },
                Light::Point { position: [0.0, 0.0, 20.0], intensity: 1.0, color },
            ],
            extent: 10.0,
            centre: [0.0; 3],
        }
    }

    #[test]
    fn a_dragged_handle_stays_under_the_pointer() {
        for handle in [Handle { light: 0, aim: false }, Handle { light: 0, aim: true }] {
            let mut s = stage();
            let ([x, y], _) = projected(&s, handle, SIZE).unwrap();
            assert_eq!(pick(&s, [x as f64 + 1.0, y as f64], SIZE), Some(handle));
            drag(&mut s, handle, [12.0, 9.0], false, SIZE);
            let ([u, v], _) = projected(&s, handle, SIZE).unwrap();
            // The second handle keeps its distance, so it follows the pointer's direction only.
            let least = if handle.aim { 5.0 } else { 11.99 };
            assert!(u - x >= least && u - x < 12.01, "{}", u - x);
            if !handle.aim {
                assert!((v - y - 9.0).abs() < 0.01);
            }
        }
    }

    #[test]
    fn depth_drag_keeps_the_view_line_of_sight_side() {
        let mut s = stage();
        drag(&mut s, Handle { light: 0, aim: false }, [0.0, -50.0], true, SIZE);
        let Light::Spot { position, .. } = &s.lights[0] else { panic!() };
        assert!(position[2] < -0.5 && (position[1] - 2.0).abs() < 1e-9);
    }

    #[test]
    fn lights_behind_the_eye_have_no_handle() {
        let s = stage();
        assert!(projected(&s, Handle { light: 2, aim: false }, SIZE).is_none());
        assert!(shapes(&s, SIZE, None).iter().all(|shape| shape.centre.iter().all(|c| c.is_finite())));
    }

    #[test]
    fn a_sun_turns_around_the_scene() {
        let mut s = stage();
        drag(&mut s, Handle { light: 1, aim: false }, [0.0, -100.0], false, SIZE);
        let Light::Directional { direction, .. } = &s.lights[1] else { panic!() };
        assert!(direction[1] < -0.1, "dragged up, it shines down");
    }
}
