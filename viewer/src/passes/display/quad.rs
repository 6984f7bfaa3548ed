//! The pixels that a function may reach, as a quad, computed on the CPU: the twin of quads.wgsl.

use crate::scene::view::Frame;
use glam::{Mat4, Vec2, Vec3, Vec4};
use rebounce_shared::kernel::SQUASH;
use rebounce_shared::rbn::bulk::Point;

/// A bounding rectangle of the projection of a function's support.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quad {
    /// Left and lower corner, -1 to 1.
    pub low: Vec2,
    /// Right and upper corner.
    pub high: Vec2,
    /// Greatest value of the depth buffer in the support.
    pub depth: f32,
}

/// cos and sin of 30°, as in the shader.
const AWAY: Vec2 = Vec2::new(0.866_025_4, 0.5);

/// Gradient of a linear form in coordinates that map the support to the unit ball.
fn gradient(form: Vec3, normal: Vec3, radius: f32) -> Vec3 {
    radius * (form - SQUASH / (1.0 + SQUASH) * form.dot(normal) * normal)
}

/// Minimum and maximum of x / w over the support.
fn extent(x: Vec4, w: Vec4, centre: Vec4, normal: Vec3, radius: f32) -> [f32; 2] {
    let w_centre = w.dot(centre);
    let middle = x.dot(centre) / w_centre;
    let gradient_w = gradient(w.truncate(), normal, radius);
    let gradient_x = gradient(x.truncate() - middle * w.truncate(), normal, radius);
    let a = w_centre * w_centre - gradient_w.length_squared();
    let b = gradient_x.dot(gradient_w);
    let root = (b * b + a * gradient_x.length_squared()).sqrt();
    [middle + (-b - root) / a, middle + (-b + root) / a]
}

impl Quad {
    /// The quad of a function for a camera; `None` if the function reaches no pixel.
    pub fn of(frame: &Frame, point: &Point) -> Option<Self> {
        let rows = Mat4::from_cols_array_2d(&frame.clip_from_local).transpose();
        let (normal, radius) = (point.normal(), point.radius);
        let place = point.position().extend(1.0);
        let w = rows.w_axis;
        for plane in [w + rows.x_axis, w + rows.y_axis, w - rows.x_axis, w - rows.y_axis] {
            if plane.dot(place) + gradient(plane.truncate(), normal, radius).length() <= 0.0 {
                return None;
            }
        }
        let ahead = w.dot(place);
        let reach = gradient(w.truncate(), normal, radius).length();
        let to_eye = Vec3::from(frame.eye) - point.position();
        let distance = to_eye.length();
        let sine = radius / distance;
        let faces_away = sine < 0.5
            && normal.dot(to_eye)
                < -distance * (AWAY.dot(Vec2::new((1.0 - sine * sine).sqrt(), sine)) + 0.01);
        if ahead + reach <= frame.near || faces_away {
            return None;
        }
        let front = ahead - reach;
        let (mut low, mut high) = (Vec2::NEG_ONE, Vec2::ONE);
        if front > 0.01 * reach {
            let [x, y] = [rows.x_axis, rows.y_axis].map(|row| extent(row, w, place, normal, radius));
            let more = 1e-3 * Vec2::new(x[1] - x[0], y[1] - y[0]) + 1e-5;
            low = low.max(Vec2::new(x[0], y[0]) - more);
            high = high.min(Vec2::new(x[1], y[1]) + more);
        }
        let depth = if front > frame.near { (1.001 * frame.near / front).min(1.0) } else { 1.0 };
        Some(Self { low, high, depth })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::view::Sample;
    use rebounce_shared::camera::Camera;
    use rebounce_shared::kernel::weight;
    use rebounce_shared::octahedral::pack_snorm16;

    fn number(seed: &mut u32) -> f32 {
        *seed = seed.wrapping_mul(0x2c92_77b5).wrapping_add(0xac56_4b05);
        (*seed >> 8) as f32 / (1 << 24) as f32
    }

    fn direction(seed: &mut u32) -> Vec3 {
        Vec3::from([(); 3].map(|_| number(seed) - 0.5)).normalize()
    }

    /// A place on the support's surface.
    fn rim(point: &Point, direction: Vec3) -> Vec3 {
        let normal = point.normal();
        let along = direction.dot(normal) * normal;
        point.position() + point.radius * (direction - along + along / (1.0 + SQUASH))
    }

    #[test]
    fn a_quad_holds_all_that_its_function_reaches_and_little_else() {
        let camera = Camera {
            position: [0.2, 0.1, 0.9],
            target: [-0.3, 0.2, -1.0],
            up: [0.1, 1.0, 0.0],
            yfov_deg: 70.0,
        };
        let eye = Vec3::from(camera.position.map(|x| x as f32));
        let frame = Frame::new(&camera.frame([0.0; 3]), 0.01, [64, 48], Sample::default());
        let clip = Mat4::from_cols_array_2d(&frame.clip_from_local);
        let (mut seed, mut seen, mut unseen, mut whole, mut wasted) = (7, 0, 0, 0, 0.0);
        for _ in 0..4000 {
            let position = Vec3::from([(); 3].map(|_| 2.0 * number(&mut seed) - 1.0));
            let point = Point {
                position: position.to_array(),
                radius: 0.4 * number(&mut seed).powi(2) + 1e-3,
                normal: pack_snorm16(direction(&mut seed)),
                ..Point::default()
            };
            let quad = Quad::of(&frame, &point);
            let (mut low, mut high) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
            let mut behind = false;
            for _ in 0..200 {
                let way = direction(&mut seed);
                let place = rim(&point, way);
                // Just inside the support, with a positive weight for a surface that faces the eye.
                let inside = position.lerp(place, 0.999);
                let to_eye = (eye - inside).normalize();
                let normal = (point.normal() - 0.4 * way).normalize();
                let w = weight(inside - position, normal, point.normal(), point.radius);
                let at = clip.mul_vec4(place.extend(1.0));
                behind |= at.w <= 0.01;
                let on_picture = |p: Vec2| p.abs().max_element() <= 1.0;
                let Some(quad) = quad else {
                    let at = clip.mul_vec4(inside.extend(1.0));
                    let visible = at.w > 0.01 && on_picture(Vec2::new(at.x, at.y) / at.w);
                    assert!(!visible || w == 0.0 || normal.dot(to_eye) < 0.0, "{point:?} is seen");
                    continue;
                };
                if at.w > 0.01 {
                    let p = Vec2::new(at.x, at.y) / at.w;
                    low = low.min(p);
                    high = high.max(p);
                    let holds = p.cmpge(quad.low).all() && p.cmple(quad.high).all();
                    assert!(holds || !on_picture(p), "{point:?}: {p} is not in {quad:?}");
                    assert!(at.z / at.w <= quad.depth, "{point:?} is nearer");
                }
            }
            let Some(quad) = quad else {
                unseen += 1;
                continue;
            };
            seen += 1;
            if !behind && low.min_element() > -1.0 && high.max_element() < 1.0 {
                let (size, least) = (quad.high - quad.low, high - low);
                whole += 1;
                wasted += (size.x * size.y) / (least.x * least.y) - 1.0;
            }
        }
        assert!(unseen > 500 && whole > 500, "{unseen} of none, {whole} of {seen} whole");
        // Two hundred places on a support's rim underestimate the extent.
        let wasted = wasted / whole as f32;
        assert!(wasted < 0.1, "{wasted}");
    }
}
