//! Records of a checkpoint, and their encoding.
//!
//! ```text
//! a record    0  u32  length of the contents, bytes
//!             4  u32  kind
//!             8  u32  XXH32, seeded with the salt, of the kind and the contents
//!            12       contents
//! ```
//!
//! All numbers are little-endian. The first record is the [`Identity`](super::Identity) as JSON, with salt 0; its
//! checksum is the salt of all later records, so that a record of a different bake is not accepted.

use crate::sampling::{PlacedMark, SurfacePoint};
use crate::transport::direct_to_indirect::bytes::{Reader, lengths, put, put_columns, put_receivers};
use crate::transport::direct_to_indirect::gather::Gathered;
use crate::transport::direct_to_indirect::journal::Columns;
use bytemuck::Pod;
use glam::Vec3;
use rebounce_shared::interpolation::MAX_POINTS;
use rebounce_shared::rbn::bulk::{Cut, MAX_CUTS};
use std::io::{self, Read};
use xxhash_rust::xxh32::Xxh32;

/// Length of a record's header, bytes.
pub const HEAD: usize = 12;

/// Decoded contents of a record.
#[derive(Clone, Debug, PartialEq)]
pub enum Record {
    /// The identity as JSON.
    Identity(Vec<u8>),
    /// Points of one level (records are in level order), and the state of the placement after the level.
    Placed(PlacedMark, Vec<SurfacePoint>),
    /// Cuts and samples of consecutive points, from the given index on.
    Shaped(usize, Vec<Vec<Cut>>, Vec<u8>),
    /// Gather results of consecutive receivers, from the given index on.
    Receivers(usize, Vec<Gathered>),
    /// One part of the later bounces, by part number.
    Columns(usize, Columns),
}

const IDENTITY: u32 = 0;
const PLACED: u32 = 1;
const SHAPED: u32 = 2;
const RECEIVERS: u32 = 3;
const COLUMNS: u32 = 4;

fn checksum(salt: u32, kind: u32, contents: &[u8]) -> u32 {
    let mut hash = Xxh32::new(salt);
    hash.update(&kind.to_le_bytes());
    hash.update(contents);
    hash.digest()
}

/// Returns the checksum stored in a complete record.
pub fn checksum_in(record: &[u8]) -> u32 {
    record.get(8..HEAD).and_then(|bytes| bytes.try_into().ok()).map_or(0, u32::from_le_bytes)
}

/// Record under construction.
struct RecordWriter(Vec<u8>);

impl RecordWriter {
    fn new() -> Self {
        Self(vec![0; HEAD])
    }

    fn put<T: Pod>(&mut self, values: &[T]) -> &mut Self {
        put(&mut self.0, values);
        self
    }

    fn finish(mut self, salt: u32, kind: u32) -> Vec<u8> {
        let head = [(self.0.len() - HEAD) as u32, kind, checksum(salt, kind, &self.0[HEAD..])];
        self.0[..HEAD].copy_from_slice(bytemuck::cast_slice(&head));
        self.0
    }
}

/// Encodes the identity record. Its checksum is the salt of the following records.
pub fn identity(json: &[u8]) -> Vec<u8> {
    let mut out = RecordWriter::new();
    out.put(json);
    out.finish(0, IDENTITY)
}

/// See [`Record::Placed`].
pub fn placed(salt: u32, mark: &PlacedMark, points: &[SurfacePoint]) -> Vec<u8> {
    let mut out = RecordWriter::new();
    out.put(&[mark.next_particle]).put(&[mark.coarse_radius]);
    for point in points {
        out.put(&[point.position, point.normal, point.geometric_normal]);
    }
    out.finish(salt, PLACED)
}

/// See [`Record::Shaped`].
pub fn shaped(salt: u32, first: usize, cuts: &[Vec<Cut>], samples: &[u8]) -> Vec<u8> {
    let mut out = RecordWriter::new();
    out.put(&[first as u64, cuts.len() as u64]).put(&lengths(cuts.iter()));
    cuts.iter().for_each(|row| {
        out.put(row);
    });
    out.put(samples);
    out.finish(salt, SHAPED)
}

/// See [`Record::Receivers`].
pub fn receivers(salt: u32, first: usize, found: &[Gathered]) -> Vec<u8> {
    let mut out = RecordWriter::new();
    put_receivers(&mut out.0, first, found);
    out.finish(salt, RECEIVERS)
}

/// See [`Record::Columns`].
pub fn columns(salt: u32, part: usize, columns: &Columns) -> Vec<u8> {
    let mut out = RecordWriter::new();
    put_columns(&mut out.0, part, columns);
    out.finish(salt, COLUMNS)
}

/// Reads the next record from a file with `left` remaining bytes; returns the record and its length in bytes. Returns
/// `None` if the file ends, is cut short or is damaged at this position.
///
/// # Errors
/// Error of the operating system.
pub fn read(file: &mut impl Read, left: u64, salt: u32) -> io::Result<Option<(Record, u64)>> {
    if left < HEAD as u64 {
        return Ok(None);
    }
    let mut head = [0u32; 3];
    file.read_exact(bytemuck::bytes_of_mut(&mut head))?;
    let [length, kind, expected] = head;
    let whole = HEAD as u64 + length as u64;
    if whole > left {
        return Ok(None);
    }
    let mut contents = vec![0; length as usize];
    file.read_exact(&mut contents)?;
    if checksum(salt, kind, &contents) != expected {
        return Ok(None);
    }
    Ok(decode(kind, contents).map(|record| (record, whole)))
}

fn decode(kind: u32, contents: Vec<u8>) -> Option<Record> {
    let mut from = Reader(&contents);
    let record = match kind {
        IDENTITY => return Some(Record::Identity(contents)),
        PLACED => {
            let mark = PlacedMark { next_particle: from.one()?, coarse_radius: from.one()? };
            let points = from.take::<[Vec3; 3]>(from.rest::<[Vec3; 3]>())?;
            // Limit far above the number of particles of any bake.
            let is_mark = (1e-30..1e30).contains(&mark.coarse_radius) && mark.next_particle < 1 << 48;
            if !is_mark || points.len() > MAX_POINTS || !points.iter().flatten().all(|v| v.is_finite()) {
                return None;
            }
            let point = |[position, normal, geometric_normal]: [Vec3; 3]| SurfacePoint {
                position,
                normal,
                geometric_normal,
            };
            Record::Placed(mark, points.into_iter().map(point).collect())
        }
        SHAPED => {
            let [first, count] = from.one::<[u64; 2]>()?.map(|n| n as usize);
            let lengths = from.take::<u32>(count)?;
            let cuts: Vec<Vec<Cut>> = from.rows(&lengths)?;
            let is_finite = cuts.iter().flatten().flat_map(|cut| cut.towards).all(f32::is_finite);
            if !is_finite || cuts.iter().any(|cuts| cuts.len() > MAX_CUTS) {
                return None;
            }
            Record::Shaped(first, cuts, from.take(count)?)
        }
        RECEIVERS => {
            let (first, found) = from.receivers()?;
            Record::Receivers(first, found)
        }
        COLUMNS => {
            let (part, columns) = from.columns()?;
            Record::Columns(part, columns)
        }
        _ => return None,
    };
    from.is_empty().then_some(record)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transport::direct_to_indirect::gather_context::GatherCost;
    use rebounce_shared::link::Link;

    fn some() -> Vec<(Record, Vec<u8>)> {
        let mark = PlacedMark { coarse_radius: 0.3, next_particle: 1 << 40 };
        let point =
            SurfacePoint { position: Vec3::ONE, normal: Vec3::Y, geometric_normal: Vec3::new(0.0, 0.8, 0.6) };
        let cuts = vec![vec![], vec![Cut { towards: [1.0, 2.0, 3.0] }]];
        let found = vec![
            Gathered::default(),
            Gathered {
                links: vec![Link::pack(3, 0.5)],
                value: vec![Link::pack(3, 0.5), Link::pack(9, -0.1)],
                cost: GatherCost { rays: 512, seen: 0.7, lost: 1e-9 },
            },
        ];
        let some = Columns { bounces: 9, rows: vec![vec![], vec![(1, Vec3::new(0.1, 0.2, 0.3))]] };
        vec![
            (Record::Placed(mark, vec![point; 3]), placed(7, &mark, &[point; 3])),
            (Record::Shaped(5, cuts.clone(), vec![1, 255]), shaped(7, 5, &cuts, &[1, 255])),
            (Record::Receivers(64, found.clone()), receivers(7, 64, &found)),
            (Record::Columns(2, some.clone()), columns(7, 2, &some)),
        ]
    }

    #[test]
    fn records_come_back_as_they_were() {
        for (record, bytes) in some() {
            let back = read(&mut &bytes[..], bytes.len() as u64, 7).unwrap();
            assert_eq!(back, Some((record, bytes.len() as u64)));
            assert_eq!(read(&mut &bytes[..], bytes.len() as u64, 8).unwrap(), None, "another bake's");
        }
    }

    #[test]
    fn no_part_and_no_damaged_record_is_taken_for_one() {
        for (_, bytes) in some() {
            for end in 0..bytes.len() {
                assert_eq!(read(&mut &bytes[..end], end as u64, 7).unwrap(), None);
            }
            for at in 0..bytes.len() {
                let mut bytes = bytes.clone();
                bytes[at] ^= 0x10;
                // The damage makes the length greater than the file, or smaller, or changes the contents.
                assert_eq!(read(&mut &bytes[..], bytes.len() as u64, 7).unwrap(), None, "byte {at}");
            }
        }
    }
}
