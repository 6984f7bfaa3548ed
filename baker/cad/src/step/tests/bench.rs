//! `shared/scenes/cad/bench.step`, if it is there, and beside it a fine tessellation of the same.

use super::integrate::{area_and_volume, assert_loops_closed};
use crate::step::read;
use crate::surface::Surface;
use crate::trim::TrimEdge;
use glam::{DVec2, DVec3};
use std::path::Path;

struct Mesh {
    name: String,
    area: f64,
    volume: f64,
    triangles: Vec<[DVec3; 3]>,
    low: DVec3,
    high: DVec3,
}

/// Numbers after each `key` of a text.
fn numbers(text: &str, key: &str) -> Vec<usize> {
    let number =
        |rest: &str| rest.split(|c: char| !c.is_ascii_digit()).find(|word| !word.is_empty())?.parse().ok();
    text.split(key).skip(1).filter_map(number).collect()
}

/// The meshes of the one glTF file that this reads: positions and indices by turns, one after the other, a mesh a node.
fn meshes(bytes: &[u8]) -> Vec<Mesh> {
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let json = std::str::from_utf8(&bytes[20..20 + length]).unwrap();
    let nodes = json.split("\"nodes\":").last().unwrap().split("\"meshes\":").next().unwrap();
    let names: Vec<&str> =
        nodes.split("\"name\":").skip(1).map(|rest| rest.split('"').nth(1).unwrap()).collect();
    let accessors = json.split("\"accessors\":").nth(1).unwrap();
    let counts = numbers(accessors.split("\"bufferViews\":").next().unwrap(), "\"count\":");
    let mut at = 20 + length + 8;
    let mut words = |count: usize| {
        let slice = &bytes[at..at + 4 * count];
        at += 4 * count;
        slice.chunks(4).map(|word| word.try_into().unwrap()).collect::<Vec<[u8; 4]>>()
    };
    let mut found = Vec::new();
    for (name, pair) in names.iter().zip(counts.chunks(2)) {
        let coordinates: Vec<f64> =
            words(3 * pair[0]).into_iter().map(|word| f64::from(f32::from_le_bytes(word))).collect();
        let places: Vec<DVec3> = coordinates.chunks(3).map(DVec3::from_slice).collect();
        let indices: Vec<usize> =
            words(pair[1]).into_iter().map(|word| u32::from_le_bytes(word) as usize).collect();
        let (mut area, mut volume) = (0.0, 0.0);
        let corners = |at: &[usize]| [places[at[0]], places[at[1]], places[at[2]]];
        let triangles: Vec<[DVec3; 3]> = indices.chunks(3).map(corners).collect();
        for &[a, b, c] in &triangles {
            area += 0.5 * (b - a).cross(c - a).length();
            volume += a.dot(b.cross(c)) / 6.0;
        }
        let low = places.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = places.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        found.push(Mesh { name: (*name).to_owned(), area, volume, triangles, low, high });
    }
    found
}

fn files() -> Option<[Vec<u8>; 2]> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/scenes/cad");
    let folder = std::env::var_os("REBOUNCE_CAD").map_or(root, Into::into);
    let [step, glb] = ["bench.step", "bench.glb"].map(|name| std::fs::read(folder.join(name)).ok());
    Some([step?, glb?])
}

#[test]
fn every_edge_of_the_bench_is_run_once_each_way() {
    if let Some([step, _]) = files() {
        super::assert_closed(&step);
    }
}

#[test]
fn the_bench_has_the_areas_volumes_and_boxes_of_its_tessellation() {
    let Some([step, glb]) = files() else { return };
    let assembly = read(&step).unwrap();
    assert_eq!(assembly.notes, Vec::<String>::new());
    let meshes = meshes(&glb);
    assert_eq!((assembly.parts.len(), assembly.instances.len(), meshes.len()), (9, 9, 9));
    assert_eq!(assembly.parts.iter().map(|part| part.faces.len()).sum::<usize>(), 55);
    for (instance, mesh) in assembly.instances.iter().zip(&meshes) {
        let part = &assembly.parts[instance.part];
        assert_eq!(instance.path, ["bench", mesh.name.as_str()]);
        assert!(part.is_closed);
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (mut area, mut volume, mut edges) = (0.0, 0.0, 0);
        for (face, colour) in &part.faces {
            assert!(colour.is_some());
            assert_loops_closed(face);
            let [face_area, face_volume] = area_and_volume(face);
            area += face_area;
            volume += face_volume;
            edges += face.loops.iter().map(Vec::len).sum::<usize>();
            // The box of the face's places: a grid within, and the edges.
            for at in grid(&face.loops) {
                let place = instance.world_from_part.transform_point3(face.surface.point(at));
                low = low.min(place);
                high = high.max(place);
            }
        }
        // Vertices lie on the surfaces; how far sides stand off them is the error of the tessellation.
        let part_from_world = instance.world_from_part.inverse();
        let distance = |place: DVec3| {
            let place = part_from_world.transform_point3(place);
            let from = |surface: &Surface| surface.point(surface.invert(place, None)).distance(place);
            part.faces.iter().map(|(face, _)| from(&face.surface)).fold(f64::INFINITY, f64::min)
        };
        let (mut off, mut sag): (f64, f64) = (0.0, 0.0);
        for [a, b, c] in mesh.triangles.iter().step_by(1 + mesh.triangles.len() / 400) {
            off = off.max(distance(*a));
            sag = [*a + *b, *b + *c, *c + *a].into_iter().map(|sum| distance(0.5 * sum)).fold(sag, f64::max);
        }
        assert!(off < 1e-6, "{off}");
        let error = |found: f64, expected: f64| (found - expected).abs() / expected;
        println!(
            "{:8} area {area:.7} ({:.1e}) volume {volume:.8} ({:.1e}) box ({:.1e}, {:.1e}) {edges} trim edges, sag {sag:.1e}",
            mesh.name,
            error(area, mesh.area),
            error(volume, mesh.volume),
            low.distance(mesh.low),
            high.distance(mesh.high)
        );
        assert!(volume > 0.0);
        assert!(error(area, mesh.area) < 1e-3, "{} {area} {}", mesh.name, mesh.area);
        assert!(error(volume, mesh.volume) < 1e-3, "{} {volume} {}", mesh.name, mesh.volume);
        let outside = (mesh.low - low).max(high - mesh.high);
        assert!(outside.min_element() > -1e-6, "{} {outside}", mesh.name);
        assert!(outside.max_element() < sag.max(1e-4), "{} {outside}", mesh.name);
    }
}

/// Places of a face: on its edges, and a grid of those within.
fn grid(loops: &[Vec<TrimEdge>]) -> Vec<DVec2> {
    let mut edges = Vec::new();
    for edge in loops.iter().flatten() {
        for step in 0..=256 {
            let along = f64::from(step) / 256.0;
            edges.push(match *edge {
                TrimEdge::Segment { from, to } => from.lerp(to, along),
                TrimEdge::Arc { centre, radii, angles: [a, b] } => {
                    centre + radii * DVec2::from_angle(a + along * (b - a))
                }
            });
        }
        // Long polygonal lines need no more than their vertices.
        if loops.iter().map(Vec::len).sum::<usize>() > 500 {
            edges.truncate(edges.len() - 255);
        }
    }
    let low = edges.iter().copied().fold(DVec2::INFINITY, DVec2::min);
    let high = edges.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
    let is_within = |at: DVec2| {
        let polygon = edges.windows(2).filter(|pair| (pair[0].y > at.y) != (pair[1].y > at.y));
        polygon.filter(|p| p[0].x + (at.y - p[0].y) / (p[1].y - p[0].y) * (p[1].x - p[0].x) > at.x).count()
            % 2
            == 1
    };
    let mut places = edges.clone();
    // One loop only: between loops the line of vertices would jump.
    if loops.len() == 1 {
        for i in 0..=200 {
            for j in 0..=200 {
                let at = low + (high - low) * DVec2::new(f64::from(i), f64::from(j)) / 200.0;
                if is_within(at) {
                    places.push(at);
                }
            }
        }
    }
    places
}
