//! Codec of links: arbitrary bytes are rejected or give rows; arbitrary rows survive a round trip.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rebounce_shared::link::{LaterLink, Link, MAX_SENDERS, Sent, SourceLink};
use rebounce_shared::rbn::codec::links::{Beside, decode, encode};

fn round_trip<E: Beside + PartialEq + std::fmt::Debug>(rows: &[Vec<E>]) {
    let mut offsets = vec![0];
    let mut entries = Vec::new();
    for row in rows {
        entries.extend_from_slice(row);
        offsets.push(entries.len() as u32);
    }
    let packed = encode(&offsets, &entries);
    assert_eq!(decode::<E>(&packed).expect("what was packed"), (offsets, entries));
}

/// Parses rows from the input: a zero step ends a row.
fn rows<E: Sent>(bytes: &[u8], entry: impl Fn(u32, [u8; 4]) -> E) -> Vec<Vec<E>> {
    let mut rows = vec![Vec::new()];
    let mut index = 0;
    for part in bytes.chunks_exact(6) {
        let step = u16::from_le_bytes([part[0], part[1]]) as u32;
        if step == 0 || index + step >= MAX_SENDERS as u32 {
            rows.push(Vec::new());
            index = 0;
        } else {
            index += step;
            if let Some(row) = rows.last_mut() {
                row.push(entry(index, [part[2], part[3], part[4], part[5]]));
            }
        }
    }
    rows
}

fuzz_target!(|bytes: &[u8]| {
    if let Ok((offsets, links)) = decode::<Link>(bytes) {
        assert_eq!(decode::<Link>(&encode(&offsets, &links)), Ok((offsets, links)));
    }
    if let Ok((offsets, links)) = decode::<LaterLink>(bytes) {
        assert_eq!(decode::<LaterLink>(&encode(&offsets, &links)), Ok((offsets, links)));
    }
    if let Ok((offsets, links)) = decode::<SourceLink>(bytes) {
        assert_eq!(decode::<SourceLink>(&encode(&offsets, &links)), Ok((offsets, links)));
    }
    round_trip(&rows(bytes, |sender, bits| Link(u32::from_le_bytes(bits) & (0xff << 20 | 1 << 31) | sender)));
    round_trip(&rows(bytes, |sender, bits| LaterLink { sender, colour: u32::from_le_bytes(bits) }));
});
