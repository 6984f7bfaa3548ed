//! Patches: pieces of surfaces that light comes to and leaves from.

use glam::Vec3;

/// A piece of one side of a surface: a triangle. Light comes to its front alone.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Patch {
    /// Corners, local space.
    pub corners: [Vec3; 3],
    /// Unit normal, on its side.
    pub normal: Vec3,
    /// Reflectance, linear RGB, 0 to 1.
    pub albedo: Vec3,
    /// Roughness of a metal, whose reflectance is a [lobe](super::lobe); `None` of what is matt.
    pub roughness: Option<f32>,
}

impl Patch {
    /// A patch around a point, of this area in square scene units: where a surface has points and no triangles.
    pub fn around(position: Vec3, normal: Vec3, area: f32, albedo: Vec3) -> Self {
        let (u, v) = normal.any_orthonormal_pair();
        Self { normal, albedo, ..Self::along([u, v], position, area) }
    }

    /// A triangle with the proportions of two axes, of this middle and area.
    pub fn along([u, v]: [Vec3; 2], middle: Vec3, area: f32) -> Self {
        // Of an equilateral triangle: area = 3√3/4 r².
        let whole = 1.299_038 * u.cross(v).length();
        let radius = if whole > 0.0 { (area.max(0.0) / whole).sqrt() } else { 0.0 };
        let corner = |cosine: f32, sine: f32| middle + radius * (cosine * u + sine * v);
        let corners = [corner(1.0, 0.0), corner(-0.5, 0.866_025_4), corner(-0.5, -0.866_025_4)];
        Self { corners, ..Self::default() }
    }

    /// Its middle.
    pub fn position(&self) -> Vec3 {
        let [a, b, c] = self.corners;
        (a + b + c) / 3.0
    }

    /// Area, square scene units.
    pub fn area(&self) -> f32 {
        let [a, b, c] = self.corners;
        0.5 * (b - a).cross(c - a).length()
    }

    /// The two halves, divided in the middle of the longest edge.
    pub fn halves(&self) -> [Self; 2] {
        let length = |i: usize| self.corners[i].distance_squared(self.corners[(i + 1) % 3]);
        let longest = (0..3).fold(0, |most, i| if length(i) > length(most) { i } else { most });
        let [a, b, c] = [0, 1, 2].map(|i| self.corners[(longest + i) % 3]);
        let middle = 0.5 * (a + b);
        [[a, middle, c], [middle, b, c]].map(|corners| Self { corners, ..*self })
    }

    /// Middles of the four triangles between the corners and the middles of edges.
    pub fn quarters(&self) -> [Vec3; 4] {
        self.quartered().map(|[a, b, c]| (a + b + c) / 3.0)
    }

    /// Middles of the sixteen triangles.
    pub fn sixteenths(&self) -> [Vec3; 16] {
        self.of_quarters(Self::quarters)
    }

    /// Middles of the 64 triangles.
    pub fn sixty_fourths(&self) -> [Vec3; 64] {
        self.of_quarters(Self::sixteenths)
    }

    /// Middles of the 256 triangles.
    pub fn two_hundred_fifty_sixths(&self) -> [Vec3; 256] {
        self.of_quarters(Self::sixty_fourths)
    }

    /// The places of all quarters.
    fn of_quarters<const N: usize, const ALL: usize>(&self, places: fn(&Self) -> [Vec3; N]) -> [Vec3; ALL] {
        let mut out = [Vec3::ZERO; ALL];
        for (part, corners) in out.chunks_exact_mut(N).zip(self.quartered()) {
            part.copy_from_slice(&places(&Self { corners, ..*self }));
        }
        out
    }

    fn quartered(&self) -> [[Vec3; 3]; 4] {
        let [a, b, c] = self.corners;
        let (ab, bc, ca) = (0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a));
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [bc, ca, ab]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn patch() -> Patch {
        let corners = [Vec3::ZERO, Vec3::new(3.0, 0.0, 0.0), Vec3::new(0.5, 0.0, 1.0)];
        Patch { corners, normal: Vec3::Y, albedo: Vec3::ONE, ..Patch::default() }
    }

    #[test]
    fn halves_and_samples_keep_area_and_middle() {
        let patch = patch();
        let halves = patch.halves();
        assert!((halves[0].area() + halves[1].area() - patch.area()).abs() < 1e-6);
        assert!(halves.iter().all(|half| half.area() < 0.51 * patch.area()));
        for middles in [&patch.quarters()[..], &patch.sixteenths()[..], &patch.sixty_fourths()[..]] {
            let mean = middles.iter().sum::<Vec3>() / middles.len() as f32;
            assert!(mean.distance(patch.position()) < 1e-6);
        }
    }

    #[test]
    fn a_patch_around_a_point_has_its_area() {
        let around = Patch::around(Vec3::ONE, Vec3::Y, 0.7, Vec3::ONE);
        assert!((around.area() - 0.7).abs() < 1e-5 && around.position().distance(Vec3::ONE) < 1e-6);
    }
}
