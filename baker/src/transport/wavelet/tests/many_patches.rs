//! Many small patches: representatives of receivers are near, visible, with similar normals, and few; clusters of emitters
//! keep their power.

use super::super::gather_clusters::representatives;
use super::super::patch::PlacedPatch;
use super::*;
use std::collections::BTreeMap;

/// Tiles along each side of the square from -1 to 1, and area of one.
const SIDE: u32 = 24;
const TILE: f64 = 4.0 / (SIDE * SIDE) as f64;

fn tiles() -> Vec<WaveletPatch> {
    let corner = |i: u32| 2.0 * f64::from(i) / f64::from(SIDE) - 1.0;
    let tile = |i: u32| {
        let [x, y] = [i % SIDE, i / SIDE];
        let outline = rectangle(DVec2::new(corner(x), corner(y)), DVec2::new(corner(x + 1), corner(y + 1)));
        flat(DVec3::ZERO, DVec3::Y, vec![outline])
    };
    (0..SIDE * SIDE).map(tile).collect()
}

/// Planar slivers around a cylinder of radius 1 along y; outward or inward.
fn slivers(count: u32, half_length: f64, is_inward: bool) -> Vec<WaveletPatch> {
    let half = DVec2::new(half_length, 0.5 * TAU / f64::from(count));
    let sliver = |i: u32| {
        let angle = TAU * f64::from(i) / f64::from(count);
        let outward = DVec3::new(angle.cosine(), 0.0, angle.sine());
        let normal = if is_inward { -outward } else { outward };
        let frame = Frame::new(outward, normal, DVec3::Y).unwrap();
        patch_of(Surface::Plane(frame), false, vec![rectangle(-half, half)])
    };
    (0..count).map(sliver).collect()
}

fn placed(patches: &[WaveletPatch]) -> Vec<PlacedPatch<'_>> {
    patches.iter().enumerate().map(|(i, patch)| PlacedPatch::new(patch, i).unwrap()).collect()
}

/// Members of each representative.
fn clusters(representatives: &[usize]) -> BTreeMap<usize, Vec<usize>> {
    let mut out: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (patch, representative) in representatives.iter().enumerate() {
        out.entry(*representative).or_default().push(patch);
    }
    out
}

#[test]
fn representatives_of_a_plane_are_near_in_clusters_of_the_area() {
    let patches = tiles();
    let patches = placed(&patches);
    let least_area = 32.0 * TILE;
    let found = representatives(&patches, least_area, &|_, _| true);
    let clusters = clusters(&found);
    for (representative, members) in &clusters {
        assert_eq!(found[*representative], *representative);
        assert!(members.len() as f64 * TILE <= 0.5 * least_area * 1.000_001, "{members:?}");
        for member in members {
            let [a, b] = [*representative, *member].map(|patch| patches[patch].middle.position);
            assert!(a.distance(b) <= 0.5 * least_area.sqrt());
        }
    }
    // Sixteen tiles a cluster at most, and nine or more of what is halved.
    assert!(clusters.len() * 6 <= patches.len(), "{} clusters", clusters.len());
    // Patches that are not small keep their own light.
    let own: Vec<usize> = (0..patches.len()).collect();
    assert_eq!(representatives(&patches, 0.5 * TILE, &|_, _| true), own);
}

#[test]
fn a_wall_parts_clusters() {
    let patches = tiles();
    let patches = placed(&patches);
    // The plane x = 0.04 is in the midst of tiles' clusters.
    let wall = |at: DVec3| at.x < 0.04;
    let side = |patch: usize| wall(patches[patch].middle.position);
    let found = representatives(&patches, 32.0 * TILE, &|a, b| wall(a) == wall(b));
    assert!((0..patches.len()).all(|patch| side(patch) == side(found[patch])));
    assert!(clusters(&found).len() * 3 <= patches.len());
}

#[test]
fn clusters_on_a_curve_face_alike() {
    let patches = slivers(600, TAU / 1200.0, false);
    let patches = placed(&patches);
    // So large that only the normals part them.
    let found = representatives(&patches, 100.0, &|_, _| true);
    for (patch, representative) in found.iter().enumerate() {
        let [a, b] = [patch, *representative].map(|patch| patches[patch].middle.normal);
        assert!(a.distance(b) <= 0.1);
    }
    let count = clusters(&found).len();
    // 0.2 of TAU in each at most.
    assert!((32..128).contains(&count), "{count}");
}

#[test]
fn slivers_of_a_cylinder_give_all_their_power() {
    let settings = WaveletSettings { epsilon: 0.03, ..WaveletSettings::default() };
    // A sphere far around takes all; a small one in the middle sees 1 - 2 (1 - 1/sqrt 2) / 2 of the sphere of directions.
    let area = 2.0 * TAU;
    let around = area / (2.0 * TAU * 25.0);
    for (is_inward, radius, expected) in [(false, 5.0, around), (true, 0.3, 0.5_f64.sqrt())] {
        let mut patches: Vec<WaveletPatch> = slivers(400, 1.0, is_inward).into_iter().map(shining).collect();
        let receiver = patches.len();
        patches.push(sphere(DVec3::ZERO, radius, !is_inward));
        let solution = solved(&patches, &settings);
        let points = real_points(&patches[receiver], 32);
        let irradiance = |st| f64::from(solution.irradiance_of_emitters(receiver, st).x);
        let mean: f64 = points.iter().map(|(st, share)| share * irradiance(*st)).sum();
        println!("slivers, inward {is_inward}: {mean} and {expected}");
        assert!((mean / expected - 1.0).abs() < 0.01, "{mean} and {expected}");
    }
}
