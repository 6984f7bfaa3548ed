//! Packed section: rejected, or unpacked to contents that survive a round trip. The first byte selects the section.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rebounce_fuzz::bounded;
use rebounce_shared::link::{LaterLink, Link};
use rebounce_shared::rbn::bulk::{Copies, Cut, Instance, Point, Vertex};
use rebounce_shared::rbn::codec::{columns, links};
use rebounce_shared::rbn::meta;

fn records<T: columns::Columns>(bytes: &[u8]) {
    let Ok(records) = bounded(bytes.len(), 0, || columns::decode::<T>(bytes)) else { return };
    let again = columns::decode::<T>(&columns::encode(&records)).expect("what was packed");
    assert_eq!(bytemuck::cast_slice::<T, u32>(&again), bytemuck::cast_slice::<T, u32>(&records));
}

fn rows<E: links::Beside + PartialEq + std::fmt::Debug>(bytes: &[u8]) {
    let Ok((offsets, entries)) = bounded(bytes.len(), 0, || links::decode::<E>(bytes)) else { return };
    assert_eq!(links::decode::<E>(&links::encode(&offsets, &entries)), Ok((offsets, entries)));
}

fuzz_target!(|bytes: &[u8]| {
    let Some((which, section)) = bytes.split_first() else { return };
    match which % 9 {
        0 => {
            let Ok(meta) = bounded(section.len(), 0, || meta::decode(section)) else { return };
            let packed = meta::encode(&meta).expect("it was as small before");
            assert_eq!(meta::encode(&meta::decode(&packed).expect("what was packed")).ok(), Some(packed));
        }
        1 => records::<Vertex>(section),
        2 => records::<u32>(section),
        3 => records::<Point>(section),
        4 => records::<Cut>(section),
        5 => rows::<Link>(section),
        6 => rows::<LaterLink>(section),
        7 => records::<Instance>(section),
        _ => records::<Copies>(section),
    }
});
