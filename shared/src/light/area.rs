//! Unoccluded irradiance from area lights in closed form. Twin: area.wgsl.
//!
//! * Rectangle and disk: Lambert's sum over the edges of a polygon whose part below the horizon is cut off (Baum, Rushmeier,
//!   Winget: *Improving Radiosity Solutions Through the Use of Analytically Determined Form-Factors*, SIGGRAPH 1989). A
//!   disk is a regular polygon of the same area.
//! * Sphere: its cone of directions, with the part below the horizon cut off (Snyder: *Area Light Sources for Real-Time
//!   Graphics*, Microsoft Research 1996).

use super::{LightKind, LightSource};
use crate::elementary::Elementary;
use glam::Vec3;
use std::f32::consts::{PI, TAU};

/// Corners of the polygon that stands for a disk. Irradiance is within 0.3% of the disk's from a radius away on.
const DISK_CORNERS: u32 = 16;

/// Greatest number of corners of a polygon.
pub const MOST_CORNERS: usize = DISK_CORNERS as usize;

/// Most parts of a rectangle.
const MOST_PARTS: f32 = 4.0;

impl LightSource {
    /// Returns the area of the light's surface that faces a distant place, square scene units; 0 without a surface.
    pub fn facing_area(&self) -> f32 {
        match self.kind {
            LightKind::Rectangle => self.extent[0] * self.extent[1],
            LightKind::Disk | LightKind::Sphere => PI * self.size * self.size,
            _ => 0.0,
        }
    }

    /// Returns the light in parts, each with one shadow map: a long rectangle in up to four nearly square ones, other
    /// lights whole. Of a part with a surface, `size` is the radius of a disk of its area, and `up` and `extent` are those
    /// of the rectangle or the disk's square.
    pub fn parts(self) -> impl Iterator<Item = Self> {
        let (mut along, mut count, mut part) = (Vec3::ZERO, 1.0, self);
        match self.kind {
            LightKind::Rectangle => {
                let [width, height] = self.extent;
                let is_wide = width > height;
                let aspect = if is_wide { width / height } else { height / width };
                count = aspect.round().clamp(1.0, MOST_PARTS);
                let side = usize::from(!is_wide);
                along = if is_wide { self.up.cross(self.direction) } else { self.up } * self.extent[side];
                part.extent[side] /= count;
                part.size = (part.facing_area() / PI).sqrt();
            }
            LightKind::Disk => {
                part.up = self.direction.any_orthonormal_vector();
                part.extent = [2.0 * self.size; 2];
            }
            _ => {}
        }
        (0..count as u32).map(move |i| {
            let position = self.position + along * ((i as f32 + 0.5) / count - 0.5);
            Self { position, ..part }
        })
    }

    /// Returns the unoccluded irradiance of a [part](Self::parts) of an area light on a surface, as a share of its radiance:
    /// the projected solid angle that it fills over the surface's horizon, 0 to π. `position` is in local space, `normal` a
    /// unit vector. 0 for other lights.
    pub fn projected_solid_angle(&self, position: Vec3, normal: Vec3) -> f32 {
        let offset = self.position - position;
        match self.kind {
            LightKind::Sphere => sphere(offset, self.size, normal),
            LightKind::Rectangle | LightKind::Disk if offset.dot(self.direction) < 0.0 => {
                self.polygon(offset, normal)
            }
            _ => 0.0,
        }
    }

    /// The corner `i` of the light's polygon, relative to its middle.
    fn corner(&self, i: u32) -> Vec3 {
        let right = self.up.cross(self.direction);
        let half = 0.5 * (right * self.extent[0] + self.up * self.extent[1]);
        if self.kind == LightKind::Rectangle {
            let other = 0.5 * (right * self.extent[0] - self.up * self.extent[1]);
            return [half, -other, -half, other][(i % 4) as usize];
        }
        let step = TAU / DISK_CORNERS as f32;
        let (sin, cos) = (i as f32 * step).sine_cosine();
        let reach = self.size * (step / step.sine()).sqrt();
        reach * (right * cos + self.up * sin)
    }

    fn polygon(&self, offset: Vec3, normal: Vec3) -> f32 {
        let count = if self.kind == LightKind::Rectangle { 4 } else { DISK_CORNERS };
        let mut corners = [Vec3::ZERO; DISK_CORNERS as usize];
        (0..).zip(&mut corners).for_each(|(i, corner)| *corner = offset + self.corner(i));
        polygon_projected_solid_angle(&corners[..count as usize], normal)
    }
}

/// Returns the projected solid angle of a convex polygon over the horizon of a unit `normal` (Lambert's formula): half the
/// sum, over the edges of the part above the horizon, of the edge's angle times the cosine of its plane's normal. `corners`
/// are relative to the place, at most [`MOST_CORNERS`].
pub fn polygon_projected_solid_angle(corners: &[Vec3], normal: Vec3) -> f32 {
    let mut above = [Vec3::ZERO; MOST_CORNERS + 1];
    let mut count = 0;
    let mut push = |corner| {
        above[count] = corner;
        count += 1;
    };
    for (i, corner) in corners.iter().enumerate() {
        let next = corners[(i + 1) % corners.len()];
        let [height, after] = [*corner, next].map(|corner| normal.dot(corner));
        if height > 0.0 {
            push(*corner);
        }
        if (height > 0.0) != (after > 0.0) {
            push(corner.lerp(next, height / (height - after)));
        }
    }
    let edge = |i: usize| {
        let (a, b) = (above[i], above[(i + 1) % count]);
        let cross = a.cross(b);
        let length = cross.length();
        if length > 0.0 { length.arc_tangent2(a.dot(b)) * normal.dot(cross) / length } else { 0.0 }
    };
    0.5 * (0..count).map(edge).sum::<f32>().abs()
}

fn sphere(offset: Vec3, radius: f32, normal: Vec3) -> f32 {
    let distance = offset.length();
    if distance <= radius {
        return 0.0;
    }
    let cosine = normal.dot(offset) / distance;
    let h = distance / radius;
    if (cosine * h).abs() >= 1.0 {
        return PI * cosine.max(0.0) / (h * h);
    }
    let x = (h * h - 1.0).sqrt();
    let sine = (1.0 - cosine * cosine).sqrt();
    let y = (-x * cosine / sine).clamp(-1.0, 1.0);
    let across = sine * (1.0 - y * y).sqrt();
    ((cosine * y.arc_cosine() - x * across) / (h * h) + (across / x).arc_tangent()).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::Light;

    const COLOR: [f64; 3] = [1.0; 3];

    fn rectangle(width: f64, height: f64) -> LightSource {
        let (position, direction, up) = ([0.3, 2.0, -0.4], [0.2, -1.0, 0.1], [0.0, 0.0, 1.0]);
        Light::Rectangle { position, direction, up, width, height, intensity: 1.0, color: COLOR }
            .source([0.0; 3])
    }

    fn disk(radius: f64) -> LightSource {
        Light::Disk { position: [0.0; 3], direction: [0.0, -1.0, 0.0], radius, intensity: 1.0, color: COLOR }
            .source([0.0; 3])
    }

    fn ball(position: [f64; 3], radius: f64) -> LightSource {
        Light::Sphere { position, radius, intensity: 1.0, color: COLOR }.source([0.0; 3])
    }

    fn all(light: LightSource, position: Vec3, normal: Vec3) -> f32 {
        light.parts().map(|part| part.projected_solid_angle(position, normal)).sum()
    }

    /// The projected solid angle of a flat light, summed over a grid of `count` × `count` places on its square.
    fn summed(light: LightSource, position: Vec3, normal: Vec3, count: u32) -> f32 {
        let right = light.up.cross(light.direction);
        let mut sum = 0.0;
        for k in 0..count * count {
            let [u, v] = [k % count, k / count].map(|i| (i as f32 + 0.5) / count as f32 - 0.5);
            let way =
                light.position + light.extent[0] * u * right + light.extent[1] * v * light.up - position;
            let to_light = way.normalize();
            let cosines = normal.dot(to_light).max(0.0) * (-light.direction.dot(to_light)).max(0.0);
            sum += cosines / way.length_squared();
        }
        sum * light.extent[0] * light.extent[1] / (count * count) as f32
    }

    #[test]
    fn a_rectangle_gives_the_sum_over_its_surface_above_the_horizon() {
        for (width, height) in [(1.0, 1.0), (4.0, 0.5), (0.5, 1.4)] {
            let light = rectangle(width, height);
            for (at, normal) in [
                (Vec3::ZERO, Vec3::Y),
                (Vec3::new(1.0, 0.5, 0.3), Vec3::new(0.6, 0.0, -0.8)),
                // The horizon cuts the light.
                (Vec3::new(0.2, 1.2, 0.0), Vec3::X),
                (Vec3::new(2.0, 1.8, 0.0), Vec3::new(-0.3, -0.5, 0.2).normalize()),
            ] {
                let (exact, sum) = (all(light, at, normal), summed(light, at, normal, 1000));
                assert!((exact - sum).abs() < 2e-3 * sum + 1e-5, "{width} {height} {at}: {exact}, not {sum}");
            }
            // From behind, and with the back turned.
            assert_eq!(all(light, Vec3::new(0.3, 3.0, -0.4), Vec3::NEG_Y), 0.0);
            assert_eq!(all(light, Vec3::ZERO, Vec3::NEG_Y), 0.0);
        }
    }

    #[test]
    fn parts_of_a_rectangle_are_the_rectangle() {
        for (width, height, count) in [(1.0, 1.0, 1), (2.0, 0.5, 4), (0.5, 1.0, 2), (9.0, 0.1, 4)] {
            let light = rectangle(width, height);
            let parts: Vec<LightSource> = light.parts().collect();
            assert_eq!(parts.len(), count, "{width} × {height}");
            let area: f32 = parts.iter().map(LightSource::facing_area).sum();
            assert!((area - light.facing_area()).abs() < 1e-5);
            let middle = parts.iter().map(|part| part.position).sum::<Vec3>() / count as f32;
            assert!((middle - light.position).length() < 1e-5);
        }
    }

    #[test]
    fn a_disk_below_its_middle_is_a_cone() {
        for (radius, height) in [(0.5f32, 0.5), (0.3, 2.0), (1.0, 0.7)] {
            let found = all(disk(radius.into()), Vec3::new(0.0, -height, 0.0), Vec3::Y);
            let exact = PI * radius * radius / (radius * radius + height * height);
            assert!((found - exact).abs() < 3e-3 * exact, "{radius} {height}: {found}, not {exact}");
        }
    }

    #[test]
    fn a_wide_light_close_by_fills_the_hemisphere() {
        let close = Vec3::new(0.0, -1e-3, 0.0);
        assert!((all(disk(10.0), close, Vec3::Y) - PI).abs() < 1e-3);
        // A wall that touches it sees half.
        assert!((all(disk(10.0), close, Vec3::X) - 0.5 * PI).abs() < 2e-3);
    }

    #[test]
    fn a_ball_gives_the_sum_over_its_cone() {
        let light = ball([0.0, 0.0, 0.0], 0.5);
        for (at, normal) in [
            (Vec3::new(0.0, -2.0, 0.0), Vec3::Y),
            (Vec3::new(0.0, -0.6, 0.0), Vec3::new(0.6, 0.8, 0.0)),
            (Vec3::new(0.3, -0.7, 0.1), Vec3::X),
            (Vec3::new(0.0, -1.0, 0.0), Vec3::new(1.0, -0.3, 0.0).normalize()),
            (Vec3::new(0.0, -1.0, 0.0), Vec3::NEG_Y),
        ] {
            let axis = -at.normalize();
            let (right, up) = axis.any_orthonormal_pair();
            let least = (1.0 - 0.25 / at.length_squared()).sqrt();
            let count = 600;
            let mut sum = 0.0;
            for k in 0..count * count {
                let [u, v] = [k % count, k / count].map(|i| (i as f32 + 0.5) / count as f32);
                let z = least + u * (1.0 - least);
                let (sin, cos) = (TAU * v).sin_cos();
                let side = (1.0 - z * z).sqrt();
                sum += normal.dot(axis * z + side * (right * cos + up * sin)).max(0.0);
            }
            sum *= TAU * (1.0 - least) / (count * count) as f32;
            let exact = all(light, at, normal);
            assert!((exact - sum).abs() < 2e-3 * sum + 1e-5, "{at} {normal}: {exact}, not {sum}");
        }
    }
}
