//! Wall of pieces with T-junctions (corners on the edges of neighbours): the rasterizer leaves gaps of single pixels
//! between the pieces; the viewer shows nothing from behind the wall in the gaps.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;
use crate::panel;

use common::{picture, renderer};
use glam::{DVec3, Vec2, Vec3, vec3};
use panel::panel;
use rebounce::bake::bake;
use rebounce::scene::Scene;
use rebounce_shared::camera::Camera;
use rebounce_shared::light::Light;
use rebounce_shared::rbn::meta::Material;
use rebounce_tests::small::settings;
use rebounce_viewer::settings::Mode;

const SIZE: u32 = 160;

/// Camera at a height, rolled by an angle in radians, that sees only the wall.
fn camera(height: f32, roll: f64) -> Camera {
    let eye = vec3(0.06, height, 0.5);
    let up = DVec3::new(roll.sin(), roll.cos(), 0.0);
    let target = vec3(-0.02, 0.1 * height, -0.4);
    Camera {
        position: eye.as_dvec3().to_array(),
        target: target.as_dvec3().to_array(),
        up: up.to_array(),
        yfov_deg: 50.0,
    }
}

/// Adds a rectangle that faces +z.
fn piece(scene: &mut Scene, [low, high]: [Vec2; 2], z: f32, material: u32) {
    let half = 0.5 * (high - low);
    let sides = [Vec3::X * half.x, Vec3::Y * half.y];
    panel(scene, (low + half).extend(z), sides, material, false);
}

/// Adds the black underside of a piece, extending back from the wall.
fn underside(scene: &mut Scene, [from, to]: [f32; 2], y: f32, material: u32) {
    let sides = [Vec3::X * 0.5 * (to - from), Vec3::NEG_Z * 0.025];
    panel(scene, vec3(0.5 * (from + to), y, -0.425), sides, material, false);
}

/// Scene of a white wall with columns of different pieces, a black wall behind, and a lamp in front.
fn wall(has_depth: bool) -> Scene {
    let mut scene = rebounce::io::load("builtin:furnace").unwrap();
    let white = scene.materials.len() as u32;
    scene.materials.push(Material { base_color: [0.9, 0.9, 0.9, 1.0], ..Material::default() });
    scene.materials.push(Material {
        base_color: [0.0, 0.0, 0.0, 1.0],
        double_sided: true,
        ..Material::default()
    });
    for column in 0..6u32 {
        let x = -0.9 + 0.3 * column as f32 + 0.0137 * (column % 3) as f32;
        let next = -0.9 + 0.3 * (column + 1) as f32 + 0.0137 * ((column + 1) % 3) as f32;
        let rows = 1 + 3 * column % 7;
        let y = |row: u32| -0.9 + 1.8 * row as f32 / rows as f32;
        for row in 0..rows {
            piece(&mut scene, [Vec2::new(x, y(row)), Vec2::new(next, y(row + 1))], -0.4, white);
            if has_depth {
                underside(&mut scene, [x, next], y(row), white + 1);
            }
        }
    }
    piece(&mut scene, [Vec2::splat(-0.9), Vec2::splat(0.95)], -0.45, white + 1);
    scene.lights =
        vec![Light::Point { position: [0.1, 0.3, 0.9], intensity: 1.0, color: [1.0; 3], radius: 0.0 }];
    scene.cameras = vec![camera(0.0, 0.0)];
    scene
}

/// Counts pixels at least a fifth darker than the median of their neighbourhood.
fn dark_spots(picture: &[Vec3]) -> usize {
    let inner = 1..SIZE - 1;
    let pixels = inner.clone().flat_map(|y| inner.clone().map(move |x| (x, y)));
    let at = |x: u32, y: u32| picture[(y * SIZE + x) as usize].x;
    let is_dark = |&(x, y): &(u32, u32)| {
        let mut around: Vec<f32> = (0..9).map(|k| at(x + k % 3 - 1, y + k / 3 - 1)).collect();
        around.sort_by(f32::total_cmp);
        at(x, y) < 0.8 * around[4]
    };
    pixels.filter(is_dark).count()
}

/// Counts dark spots in pictures of the wall from several views; `None` without an adapter.
fn open_pixels(has_depth: bool) -> Option<usize> {
    let file = bake(&wall(has_depth), &settings(1_000), &()).unwrap().0;
    let mut viewer = renderer(&file)?;
    viewer.set_mode(Mode::Direct);
    // Single pictures as during motion, not an average.
    viewer.set_still_pictures(1);
    let mut open = 0;
    for step in 0..24 {
        let camera = camera(0.01 * f32::from(step as u8), 0.137 * f64::from(step));
        viewer.set_camera(camera).unwrap();
        let seen = picture(&mut viewer, [SIZE; 2], 0.0);
        assert!(seen.iter().map(|p| p.x).sum::<f32>() > 0.05 * seen.len() as f32, "the wall is lit");
        open += dark_spots(&seen);
    }
    Some(open)
}

#[test]
fn nothing_shows_between_the_pieces_of_a_wall() {
    for has_depth in [false, true] {
        let Some(open) = open_pixels(has_depth) else { return };
        assert_eq!(
            open, 0,
            "pixels that show what is behind the wall, or the undersides of its pieces: {has_depth}"
        );
    }
}
