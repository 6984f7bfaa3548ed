//! Packed section: rejected, or unpacked to contents that survive a round trip. The first byte selects the section.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rebounce_fuzz::bounded;
use rebounce_shared::link::{LaterLink, Link, SourceLink};
use rebounce_shared::rbn::bulk::{Copies, Cut, Instance, Point, Vertex};
use rebounce_shared::rbn::codec::{MOST_TIMES, Reader, Writer, columns, links};
use rebounce_shared::rbn::cube_maps::{self, CubeTexel};
use rebounce_shared::rbn::diffuse_transfer;
use rebounce_shared::rbn::gloss;
use rebounce_shared::rbn::light_groups::{self, GroupValue};
use rebounce_shared::rbn::lightmap::{self, ChartOffset, Texel, TexelCoordinates};
use rebounce_shared::rbn::{RbnError, meta, rig, sources};
use rebounce_shared::rig::{MorphDelta, RigPoint, RigVertex};

fn records<T: columns::Columns>(bytes: &[u8]) {
    let Ok(records) = bounded(bytes.len(), 0, || columns::decode::<T>(bytes)) else { return };
    let again = columns::decode::<T>(&columns::encode(&records)).expect("what was packed");
    assert_eq!(bytemuck::cast_slice::<T, u32>(&again), bytemuck::cast_slice::<T, u32>(&records));
}

fn rows<E: links::Beside + PartialEq + std::fmt::Debug>(bytes: &[u8]) {
    let Ok((offsets, entries)) = bounded(bytes.len(), 0, || links::decode::<E>(bytes)) else { return };
    assert_eq!(links::decode::<E>(&links::encode(&offsets, &entries)), Ok((offsets, entries)));
}

fn plain(bytes: &[u8]) {
    let read = |bytes: &[u8]| Reader::new(bytes).bytes_up_to(bytes.len().saturating_mul(MOST_TIMES));
    let Ok(contents) = bounded(bytes.len(), 0, || read(bytes)) else { return };
    let mut writer = Writer::default();
    writer.bytes(&contents);
    assert_eq!(read(&writer.finish(contents.len())).expect("what was packed"), contents);
}

/// Bincode of a section: what is read can be written and read again.
fn whole<T>(bytes: &[u8], decode: fn(&[u8]) -> Result<T, RbnError>, encode: impl Fn(&T) -> Vec<u8>) {
    let Ok(contents) = bounded(bytes.len(), 0, || decode(bytes)) else { return };
    let packed = encode(&contents);
    assert_eq!(encode(&decode(&packed).expect("what was packed")), packed);
}

fuzz_target!(|bytes: &[u8]| {
    let Some((which, section)) = bytes.split_first() else { return };
    match which % 32 {
        0 => whole(section, meta::decode, |meta| meta::encode(meta).expect("it was as small before")),
        1 => records::<Vertex>(section),
        2 => records::<u32>(section),
        3 => records::<Point>(section),
        4 => records::<Cut>(section),
        5 => rows::<Link>(section),
        6 => rows::<LaterLink>(section),
        7 => records::<Instance>(section),
        8 => records::<Copies>(section),
        // Sources of nothing have no section; these are their bytes.
        9 => whole(section, sources::decode, |all| {
            sources::encode(all).expect("it was as small before").unwrap_or_else(|| vec![0; 7])
        }),
        10 => rows::<SourceLink>(section),
        11 => whole(section, light_groups::decode, |all| {
            light_groups::encode(all).expect("it was as small before").expect("no group is refused")
        }),
        12 => records::<GroupValue>(section),
        13 => whole(section, lightmap::decode, |layout| {
            lightmap::encode(layout).expect("it was as small before")
        }),
        14 => records::<TexelCoordinates>(section),
        15 => records::<ChartOffset>(section),
        16 => records::<Texel>(section),
        17 => whole(section, gloss::decode, |layout| gloss::encode(layout).expect("it was as small before")),
        18 => records::<u32>(section),
        22 => whole(section, diffuse_transfer::decode, |layout| {
            diffuse_transfer::encode(layout).expect("it was as small before")
        }),
        26 => whole(section, cube_maps::decode, |layout| {
            cube_maps::encode(layout).expect("it was as small before")
        }),
        27 => records::<CubeTexel>(section),
        28 => whole(section, rig::decode, |layout| rig::encode(layout).expect("it was as small before")),
        29 => records::<RigVertex>(section),
        30 => records::<MorphDelta>(section),
        31 => records::<RigPoint>(section),
        // Clusters, weights and vectors of glossy and diffuse transfer.
        _ => plain(section),
    }
});
