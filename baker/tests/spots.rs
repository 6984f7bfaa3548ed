//! Bare walls have no spots, even if a small patch lights an entire room.

use rebounce::bake::{BakeSettings, Preset, bake};
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::io::picture::Only;
use rebounce::verify::compare::spots::{Rectangle, Spots, spots};
use rebounce::verify::expose::Exposure;
use rebounce::verify::render::render;

/// Two bare walls in the first camera's picture.
const WALLS: [Rectangle; 2] = [[0.03, 0.30, 0.36, 0.62], [0.47, 0.30, 0.83, 0.65]];

/// Spots on the walls of the attic at `draft` with fewer functions, by number of pooled levels.
fn attic(pooled_levels: usize) -> [Spots; 2] {
    let scene = rebounce::io::load("builtin:attic").unwrap();
    let mut settings = BakeSettings::new(Preset::Draft);
    settings.place.functions = 10_000;
    settings.operator.pooled_levels = pooled_levels;
    let (file, _) = bake(&scene, &settings, &()).unwrap();
    let surfaces = TriangleSurfaces::from_scene(&scene);
    let exposure = Exposure { size: [480, 270], samples: 1, seed: 1 };
    let picture = render(&file, &surfaces, &scene.cameras[0], &scene.lights, exposure, Only::Indirect, || ());
    WALLS.map(|wall| spots(&picture, wall))
}

#[test]
fn bare_walls_have_no_spots_where_neighbours_share_what_their_rays_find() {
    let shared = BakeSettings::new(Preset::Draft).operator.pooled_levels;
    let (alone, together) = (attic(0), attic(shared));
    for (alone, together) in alone.iter().zip(&together) {
        assert!(together.deviation < 0.7 * alone.deviation, "{together:?}, alone {alone:?}");
    }
}
