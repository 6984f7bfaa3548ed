//! Area lights: sampling of rectangles, disks and spheres toward a place, by the solid angle that they fill.
//!
//! * A sphere is sampled by its cone of directions.
//! * A rectangle is sampled by its spherical rectangle (Ureña, Fajardo, King: *An Area-Preserving Parametrization for
//!   Spherical Rectangles*, EGSR 2013).
//! * A disk is sampled in polar coordinates about the place's foot on the disk's plane: the angle by a simple density,
//!   the distance by solid angle. A sample stands for at most about a hemisphere however near the disk is; samples by
//!   area have a variance without bound there. The disk's own solid angle has no closed inverse.
//!
//! So far away that rounding counts, a rectangle and a disk are sampled by area, which is the same there.

use glam::{DVec2, DVec3, Vec2, Vec3};
use rebounce_shared::elementary::Elementary;
use rebounce_shared::light::{LightKind, LightSource};
use std::f64::consts::{PI, TAU};

/// Area over squared distance below which a light is sampled by area.
const FAR: f64 = 1e-6;

/// A sampled place of an area light.
#[derive(Clone, Copy, Debug)]
pub struct AreaSample {
    /// Local space.
    pub position: Vec3,
    /// Unit vector to the place.
    pub to_light: Vec3,
    /// Density of the direction, per steradian.
    pub density: f32,
}

/// Samples the side of a light that shines toward the local position `from` with a random `square`, 0 to 1 each; `None`
/// if no part does, or the light is no area light.
pub fn sample(light: &LightSource, from: Vec3, square: Vec2) -> Option<AreaSample> {
    let square = square.as_dvec2();
    let position = match light.kind {
        LightKind::Sphere => {
            let cone = Cone::new(light, from)?;
            cone.sample(light, square)
        }
        LightKind::Rectangle | LightKind::Disk => {
            let seen = Flat::new(light, from)?;
            let [x, y] = match seen.shape()? {
                FlatShape::Far(_) => seen.by_area(square),
                FlatShape::Rectangle(rectangle) => rectangle.sample(square),
                FlatShape::Disk(disk) => disk.sample(square),
            }
            .to_array();
            seen.from + seen.right * x + seen.up * y - seen.normal * seen.height
        }
        _ => return None,
    };
    let to_light = (position - from.as_dvec3()).try_normalize()?.as_vec3();
    let position = position.as_vec3();
    let density = density(light, from, position);
    (density > 0.0).then_some(AreaSample { position, to_light, density })
}

/// Returns the density of [`sample`] at the direction from `from` to a place on the light, per steradian; 0 where no
/// sample is.
pub fn density(light: &LightSource, from: Vec3, place: Vec3) -> f32 {
    let found = match light.kind {
        LightKind::Sphere => Cone::new(light, from).map(|cone| 1.0 / (TAU * cone.off)),
        LightKind::Rectangle | LightKind::Disk => Flat::new(light, from).and_then(|seen| {
            let way = place.as_dvec3() - seen.from;
            let at = DVec2::new(way.dot(seen.right), way.dot(seen.up));
            Some(match seen.shape()? {
                FlatShape::Far(area) => {
                    (at.length_squared() + seen.height.powi(2)).power(1.5) / (area * seen.height)
                }
                FlatShape::Rectangle(rectangle) => 1.0 / rectangle.solid_angle,
                FlatShape::Disk(disk) => disk.density(at),
            })
        }),
        _ => None,
    };
    found.filter(|density| density.is_finite()).unwrap_or(0.0) as f32
}

/// The sphere as seen from a place outside.
struct Cone {
    from: DVec3,
    axis: DVec3,
    /// 1 − cosine of the half angle.
    off: f64,
}

impl Cone {
    fn new(light: &LightSource, from: Vec3) -> Option<Self> {
        let from = from.as_dvec3();
        let offset = light.position.as_dvec3() - from;
        let sine_squared = f64::from(light.size).powi(2) / offset.length_squared();
        (sine_squared < 1.0).then(|| Self {
            from,
            axis: offset.normalize(),
            off: sine_squared / (1.0 + (1.0 - sine_squared).sqrt()),
        })
    }

    fn sample(&self, light: &LightSource, square: DVec2) -> DVec3 {
        let off = square.x * self.off;
        let (sin, cos) = (TAU * square.y).sine_cosine();
        let (right, up) = self.axis.any_orthonormal_pair();
        let direction = self.axis * (1.0 - off) + (right * cos + up * sin) * (off * (2.0 - off)).sqrt();
        let offset = light.position.as_dvec3() - self.from;
        let along = offset.dot(direction);
        let aside = (offset - along * direction).length_squared();
        let half = (f64::from(light.size).powi(2) - aside).max(0.0).sqrt();
        self.from + direction * (along - half)
    }
}

/// A rectangle or disk as seen from a place before it: coordinates are along `right` and `up`, from the place's foot on
/// the plane.
struct Flat<'a> {
    light: &'a LightSource,
    from: DVec3,
    right: DVec3,
    up: DVec3,
    normal: DVec3,
    /// Distance of the place from the plane.
    height: f64,
    middle: DVec2,
}

enum FlatShape {
    /// The area.
    Far(f64),
    Rectangle(SphericalRectangle),
    Disk(SphericalDisk),
}

impl<'a> Flat<'a> {
    fn new(light: &'a LightSource, from: Vec3) -> Option<Self> {
        let normal = light.direction.as_dvec3().normalize();
        let from = from.as_dvec3();
        let offset = light.position.as_dvec3() - from;
        let height = -offset.dot(normal);
        if height <= 0.0 {
            return None;
        }
        let (right, up) = match light.kind {
            LightKind::Rectangle => {
                let right = light.up.as_dvec3().cross(normal).normalize();
                (right, normal.cross(right))
            }
            _ => normal.any_orthonormal_pair(),
        };
        let middle = DVec2::new(offset.dot(right), offset.dot(up));
        Some(Self { light, from, right, up, normal, height, middle })
    }

    fn half(&self) -> DVec2 {
        let [width, height] = self.light.extent.map(f64::from);
        0.5 * DVec2::new(width, height)
    }

    fn shape(&self) -> Option<FlatShape> {
        let radius = f64::from(self.light.size);
        let is_disk = self.light.kind == LightKind::Disk;
        let area = if is_disk { PI * radius * radius } else { 4.0 * self.half().element_product() };
        if area < FAR * (self.middle.length_squared() + self.height * self.height) {
            return Some(FlatShape::Far(area));
        }
        if is_disk {
            return Some(FlatShape::Disk(SphericalDisk { middle: self.middle, radius, height: self.height }));
        }
        let corners = [self.middle - self.half(), self.middle + self.half()];
        SphericalRectangle::new(corners, self.height).map(FlatShape::Rectangle)
    }

    fn by_area(&self, square: DVec2) -> DVec2 {
        match self.light.kind {
            LightKind::Disk => self.middle + f64::from(self.light.size) * in_disk(square),
            _ => self.middle + self.half() * (2.0 * square - 1.0),
        }
    }
}

/// Maps the unit square to the unit disk, keeping shares of area (Shirley, Chiu: *A Low Distortion Map Between Disk and
/// Square*, 1997).
fn in_disk(square: DVec2) -> DVec2 {
    let [a, b] = (2.0 * square - 1.0).to_array();
    let (radius, angle) = if a == 0.0 && b == 0.0 {
        (0.0, 0.0)
    } else if a.abs() > b.abs() {
        (a, 0.25 * PI * (b / a))
    } else {
        (b, 0.5 * PI - 0.25 * PI * (a / b))
    };
    let (sin, cos) = angle.sine_cosine();
    radius * DVec2::new(cos, sin)
}

/// A rectangle's directions, after Ureña et al. 2013; names as there.
struct SphericalRectangle {
    corners: [DVec2; 2],
    z0: f64,
    b0: f64,
    b1: f64,
    k: f64,
    solid_angle: f64,
}

impl SphericalRectangle {
    fn new(corners: [DVec2; 2], height: f64) -> Option<Self> {
        let [DVec2 { x: x0, y: y0 }, DVec2 { x: x1, y: y1 }] = corners;
        let z0 = -height;
        let corner = |x, y| DVec3::new(x, y, z0);
        let (v00, v01, v10, v11) = (corner(x0, y0), corner(x0, y1), corner(x1, y0), corner(x1, y1));
        let n = [v00.cross(v10), v10.cross(v11), v11.cross(v01), v01.cross(v00)].map(DVec3::normalize);
        let g = |i: usize| (-n[i].dot(n[(i + 1) % 4])).clamp(-1.0, 1.0).arc_cosine();
        let k = TAU - g(2) - g(3);
        let solid_angle = g(0) + g(1) - k;
        (solid_angle > 0.0).then(|| Self { corners, z0, b0: n[0].z, b1: n[2].z, k, solid_angle })
    }

    fn sample(&self, square: DVec2) -> DVec2 {
        let [DVec2 { x: x0, y: y0 }, DVec2 { x: x1, y: y1 }] = self.corners;
        let (sin, cos) = (square.x * self.solid_angle + self.k).sine_cosine();
        let fu = (cos * self.b0 - self.b1) / sin;
        let cu = (fu.signum() / (fu * fu + self.b0 * self.b0).sqrt()).clamp(-1.0, 1.0);
        let xu = (-(cu * self.z0) / (1.0 - cu * cu).max(f64::MIN_POSITIVE).sqrt()).clamp(x0, x1);
        let d = (xu * xu + self.z0 * self.z0).sqrt();
        let h = |y: f64| y / (d * d + y * y).sqrt();
        let hv = h(y0) + square.y * (h(y1) - h(y0));
        let yv = (hv * d / (1.0 - hv * hv).max(f64::MIN_POSITIVE).sqrt()).clamp(y0, y1);
        DVec2::new(xu, yv)
    }
}

/// A disk's directions, in polar coordinates (s, φ) about the foot of the place; φ = 0 is towards the middle. The solid
/// angle of an angle dφ between s₀ and s₁ is (c(s₀) − c(s₁)) dφ, with c(s) = h / √(h² + s²).
struct SphericalDisk {
    middle: DVec2,
    radius: f64,
    height: f64,
}

impl SphericalDisk {
    fn cosine(&self, s: f64) -> f64 {
        self.height / self.height.hypotenuse(s)
    }

    /// Half the angle that the disk spans about the foot; `None` where the foot is on the disk.
    fn widest(&self) -> Option<f64> {
        let away = self.middle.length();
        (away > self.radius).then(|| (self.radius / away).arc_sine())
    }

    /// c(s₀) and c(s₁) at an angle.
    fn cosines(&self, angle: f64) -> [f64; 2] {
        let (sin, cos) = angle.sine_cosine();
        let away = self.middle.length();
        let half = (self.radius.powi(2) - (away * sin).powi(2)).max(0.0).sqrt();
        let nearest = if away > self.radius { away * cos - half } else { 0.0 };
        [nearest, away * cos + half].map(|s| self.cosine(s))
    }

    /// Density of the angles: uniform about a foot on the disk; else a semicircle, which is nearly the disk's width.
    fn angular_density(&self, angle: f64) -> f64 {
        match self.widest() {
            None => 1.0 / TAU,
            Some(widest) => {
                let x = angle / widest;
                2.0 / PI * (1.0 - x * x).max(0.0).sqrt() / widest
            }
        }
    }

    fn density(&self, at: DVec2) -> f64 {
        let angle = if self.middle == DVec2::ZERO { 0.0 } else { self.middle.angle_to(at) };
        let [nearest, farthest] = self.cosines(angle);
        self.angular_density(angle) / (nearest - farthest)
    }

    fn sample(&self, square: DVec2) -> DVec2 {
        // A uniform place of the unit disk: its abscissa has the semicircle's density, and its place between the ends of
        // the ordinates there is uniform.
        let (angle, share) = match self.widest() {
            None => (TAU * (square.y - 0.5), square.x),
            Some(widest) => {
                let place = in_disk(square);
                let end = (1.0 - place.x * place.x).max(f64::MIN_POSITIVE).sqrt();
                (widest * place.x, 0.5 * (place.y / end).clamp(-1.0, 1.0) + 0.5)
            }
        };
        let [nearest, farthest] = self.cosines(angle);
        let cosine = nearest + share * (farthest - nearest);
        let s = self.height * (1.0 / (cosine * cosine) - 1.0).max(0.0).sqrt();
        let ahead = self.middle.try_normalize().unwrap_or(DVec2::X);
        s * ahead.rotate(DVec2::from_angle(angle))
    }
}

/// Number of [`fixed`] samples.
pub const FIXED: u32 = 16;

/// Returns a sample of a fixed set, well spread over the unit square: the first points of Sobol's (0, 2)-sequence, in
/// the middles of their cells.
pub fn fixed(sample: u32) -> Vec2 {
    const SECOND: [u32; 4] = [0b1000, 0b1100, 0b1010, 0b1111];
    let bits = sample % FIXED;
    let x = bits.reverse_bits() >> 28;
    let y = (0..4).filter(|bit| bits >> bit & 1 == 1).fold(0, |y, bit| y ^ SECOND[bit]);
    (Vec2::new(x as f32, y as f32) + 0.5) / FIXED as f32
}

#[cfg(test)]
mod tests;
