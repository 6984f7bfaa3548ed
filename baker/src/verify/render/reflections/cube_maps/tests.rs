use super::*;
use crate::geometry::mesh::TriangleSurfaces;
use crate::geometry::{Ray, Surfaces};
use crate::random::Stream;
use rebounce_shared::cube_map::cube::Cube;
use rebounce_shared::rbn::cube_maps::{CubeMapLayout, CubeTexel, SeenSurface};

/// A map in the middle of a cube of edge 2 whose walls have a colour that is linear in the place.
fn map(side: usize) -> LitCubeMap {
    let scene = crate::io::load("builtin:furnace").unwrap();
    let surfaces = TriangleSurfaces::from_scene(&scene);
    let layout = CubeMapLayout { side: side as u32, range: [1.0, 3f32.sqrt()], places: vec![[0.0; 3]] };
    let cube = Cube { side };
    let seen = |texel: usize| {
        let ray = Ray::visibility(Vec3::ZERO, cube.direction(texel));
        let hit = surfaces.cast(&ray, 0).unwrap();
        let surface = SeenSurface {
            distance: hit.distance,
            normal: hit.normal,
            reflectance: hit.albedo,
            metal: None,
            emitter: None,
            group: 0,
        };
        (CubeTexel::pack(&layout, &surface), colour(hit.position).extend(1.0))
    };
    let (texels, light): (Vec<_>, Vec<_>) = (0..cube.texels()).map(seen).unzip();
    LitCubeMap::new(&rebounce_shared::rbn::cube_maps::CubeMaps { layout, texels }, 0, light)
}

fn colour(place: Vec3) -> Vec3 {
    0.5 + 0.5 * place
}

/// Greatest difference of what is found from the colour where rays end, of rays from everywhere that end `within` of the middle
/// of a wall.
fn worst(map: &LitCubeMap, correction: Correction, within: f32) -> f32 {
    let lookup = CubeMapLookup { correction, ..CubeMapLookup::default() };
    let walls = ParallaxBox { low: Vec3::NEG_ONE, high: Vec3::ONE };
    let mut stream = Stream::new(11, 0);
    let mut worst = 0.0f32;
    for _ in 0..1000 {
        let position = stream.sphere() * (0.9 * stream.unit());
        let direction = stream.sphere();
        let end = walls.meet(position, direction).seen_from_map;
        if end.to_array().iter().filter(|x| x.abs() > within).count() > 1 {
            continue;
        }
        let around = NearMaps { lookup, maps: vec![map], position, middle: None };
        let mut cost = Cost::default();
        let found = around.radiance(direction, 0.0, || Vec3::ONE, &mut cost).unwrap();
        worst = worst.max(found.distance(colour(end)));
        assert!(cost.fallbacks == 0 && cost.steps > 0);
    }
    worst
}

#[test]
fn a_map_of_a_box_is_exact_when_corrected_by_the_box() {
    let map = map(32);
    // Interpolation between texels is exact on a flat wall.
    let off = worst(&map, Correction::Box, 0.95);
    assert!(off < 1e-3, "{off}");
    // By depth, to about a texel of the wall.
    let off = worst(&map, Correction::Depth, 0.95);
    assert!(off < 0.1, "{off}");
    // Not corrected, it is another place of the room.
    let off = worst(&map, Correction::None, 0.95);
    assert!(off > 0.5, "{off}");
}

#[test]
fn correction_by_depth_gets_better_with_finer_maps() {
    let [coarse, fine] = [16, 64].map(|side| worst(&map(side), Correction::Depth, 1.0));
    assert!(fine < 0.5 * coarse, "{coarse} {fine}");
}
