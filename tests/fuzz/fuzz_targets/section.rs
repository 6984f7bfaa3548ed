//! Sections of a .rbn file with checksums that fit: the input is bytes of a file's sections, each with its length.
//! What is read keeps every rule that the viewer relies on.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rebounce_shared::rbn::{Scene, container};

/// Names of the sections, in the order of the input.
const NAMES: [[u8; 4]; 8] =
    [*b"META", *b"VERT", *b"INDX", *b"PNTS", *b"CUTS", *b"LINK", *b"LATL", *b"TEXD"];

fuzz_target!(|bytes: &[u8]| {
    let mut rest = bytes;
    let mut sections = Vec::new();
    for name in NAMES {
        let Some((len, tail)) = rest.split_first_chunk::<2>() else { return };
        let len = (u16::from_le_bytes(*len) as usize).min(tail.len());
        let (section, tail) = tail.split_at(len);
        sections.push((name, section));
        rest = tail;
    }
    let Ok(scene) = Scene::from_bytes(&container::write(&sections)) else { return };
    // What a frame reads.
    for (i, row) in scene.links.iter().enumerate() {
        assert!(row.iter().all(|link| link.amount().is_finite()), "row {i}");
    }
    for i in 0..scene.points.len() {
        assert!(scene.push().row(i).iter().all(|entry| entry.point() < i && entry.weight() > 0.0));
        assert!(scene.cuts_of(i).len() <= 4);
    }
    assert!(scene.indices.iter().all(|&i| (i as usize) < scene.vertices.len()));
    let lookup = &scene.relations.lookup;
    for (l, level) in scene.meta.levels.iter().enumerate() {
        for p in &scene.points[scene.level(l)] {
            let range = level.first..level.first + level.count;
            assert!(lookup.functions(l, p.position()).iter().all(|j| range.contains(j)));
        }
    }
});
