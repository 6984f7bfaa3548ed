//! Visibility is reciprocal, matrices turn with the scene, and mirrored light is mirrored.

use super::*;
use crate::geometry::{Gloss, Hit, Ray};
use crate::sampling::{Points, SurfacePoint};
use glam::{Mat3, Quat, Vec3};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::harmonics::rotation::Rotation;
use rebounce_shared::harmonics::{Coefficients, band};

/// Rays of a matrix. What follows allows for directions that are not evenly spread at the edges of what is open.
const DIRECTIONS: u32 = 8192;

/// Black, with cones of directions that it hides from everywhere.
struct Cones(Vec<(Vec3, f32)>);

impl Cones {
    fn some(turn: Mat3) -> Self {
        let cones = [(Vec3::new(0.5, 0.8, 0.1), 0.8), (Vec3::new(-0.7, 0.2, 0.6), 0.9), (Vec3::Z, 0.93)];
        Self(cones.map(|(axis, cosine)| (turn * axis.normalize(), cosine)).to_vec())
    }
}

impl Surfaces for Cones {
    fn cast(&self, ray: &Ray, _seed: u32) -> Option<Hit> {
        let is_hidden = self.0.iter().any(|(axis, cosine)| ray.direction.dot(*axis) > *cosine);
        is_hidden.then_some(Hit {
            distance: 1.0,
            position: ray.origin + ray.direction,
            geometric_normal: -ray.direction,
            normal: -ray.direction,
            albedo: Vec3::ZERO,
            emission: Vec3::ZERO,
            emitter: None,
            is_unlit: false,
            group: 0,
            lightmap: None,
            gloss: Gloss::MATT,
        })
    }

    fn see(&self, ray: &Ray, seed: u32) -> Option<Hit> {
        self.cast(ray, seed)
    }

    fn transmittance(&self, _from: Vec3, _to: Vec3) -> Vec3 {
        Vec3::ONE
    }

    fn bounds(&self) -> (Vec3, Vec3) {
        (Vec3::NEG_ONE, Vec3::ONE)
    }

    fn epsilon(&self) -> f32 {
        1e-4
    }
}

/// The matrix of one channel under `cones`, by columns, at a point with this normal, and the visibility.
fn matrix(cones: &Cones, normal: Vec3) -> ([Coefficients; COUNT], Coefficients) {
    let point = SurfacePoint { position: Vec3::ZERO, normal, geometric_normal: normal, group: 0 };
    let points = Points { points: vec![point], ..Points::default() };
    let settings = GlossSettings { has_direct: true, ..GlossSettings::default() };
    let irradiance = SkyIrradiance::new(&BakedScene::default());
    let point_rays = PointRays::new(cones, &points, DIRECTIONS);
    let (found, rays) = MatrixGather::new(&point_rays, Some(irradiance), &settings).matrix(0);
    assert!(rays.abs_diff(u64::from(DIRECTIONS) / 2) < 100, "{rays}");
    let column = |j: usize| std::array::from_fn(|i| Vec3::splat(found[i * COUNT + j]));
    let visibility = std::array::from_fn(|i| Vec3::splat(found[3 * COUNT * COUNT + i]));
    (std::array::from_fn(column), visibility)
}

/// Coefficients of a function mirrored at the plane through the origin: half a turn about the normal, and all directions
/// reversed.
fn mirrored_at(normal: Vec3, coefficients: &Coefficients) -> Coefficients {
    let turned = Rotation::new(Mat3::from_axis_angle(normal, std::f32::consts::PI)).apply(coefficients);
    std::array::from_fn(|i| if band(i).is_multiple_of(2) { turned[i] } else { -turned[i] })
}

/// The matrix with rows and columns exchanged.
fn transposed(columns: &[Coefficients; COUNT]) -> [Coefficients; COUNT] {
    std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i]))
}

/// Greatest difference of two matrices.
fn difference(a: &[Coefficients; COUNT], b: &[Coefficients; COUNT]) -> f32 {
    let pairs = a.as_flattened().iter().zip(b.as_flattened());
    pairs.fold(0.0, |most, (a, b)| most.max((*a - *b).abs().max_element()))
}

#[test]
fn visibility_is_reciprocal() {
    // T = (1 + M) ∫ V y_i y_j, with the mirror M: without the mirrored half the matrix is symmetric, and so is T (1 + M).
    let normal = Vec3::new(0.3, 0.9, -0.2).normalize();
    let (columns, _) = matrix(&Cones::some(Mat3::IDENTITY), normal);
    let rows = transposed(&columns);
    let both: [Coefficients; COUNT] = rows.map(|row| {
        let mirrored = mirrored_at(normal, &row);
        std::array::from_fn(|j| row[j] + mirrored[j])
    });
    let off = difference(&both, &transposed(&both));
    assert!(off < 1e-4, "{off}");
    assert!(difference(&rows, &columns) > 0.1 && both[0][0].x > 0.5);
}

#[test]
fn arriving_light_is_the_same_on_both_sides_of_the_tangent_plane() {
    let normal = Vec3::new(-0.5, 0.4, 0.7).normalize();
    let (columns, visibility) = matrix(&Cones::some(Mat3::IDENTITY), normal);
    let mirrored = columns.map(|column| mirrored_at(normal, &column));
    assert!(difference(&columns, &mirrored) < 1e-4);
    let off = mirrored_at(normal, &visibility).into_iter().zip(visibility).map(|(a, b)| a.distance(b));
    assert!(off.fold(0.0, f32::max) < 1e-4);
}

#[test]
fn a_turned_scene_has_the_turned_matrix() {
    // Edges of cones lie between other directions after the turn.
    const MOST: f32 = 0.02;
    let turn = Mat3::from_quat(Quat::from_axis_angle(Vec3::new(0.3, 0.5, 0.8).normalize(), 1.1));
    let normal = Vec3::new(0.3, 0.9, -0.2).normalize();
    let (still, open) = matrix(&Cones::some(Mat3::IDENTITY), normal);
    let (turned, turned_open) = matrix(&Cones::some(turn), turn * normal);
    // T' = D T Dᵀ.
    let rotation = Rotation::new(turn);
    let half = still.map(|column| rotation.apply(&column));
    let expected = transposed(&transposed(&half).map(|row| rotation.apply(&row)));
    let off = difference(&turned, &expected);
    assert!(off < MOST, "{off}");
    let off = rotation.apply(&open).iter().zip(turned_open).map(|(a, b)| a.distance(b)).fold(0.0, f32::max);
    assert!(off < 2.0 * MOST, "{off}");
    assert!(difference(&turned, &still) > 10.0 * MOST);
}
