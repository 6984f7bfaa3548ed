//! Records of a checkpoint, and their encoding.
//!
//! ```text
//! a record    0  u32  length of the contents, bytes
//!             4  u32  kind
//!             8  u32  XXH32, seeded with the salt, of the kind and the contents
//!            12       contents: u64 key of the part, then its bytes
//! ```
//!
//! All numbers are little-endian. The first record is the [`Identity`](super::Identity) as JSON, with salt 0 and kind 0; its
//! checksum is the salt of all later records, so that a record of a different bake is not accepted.

use std::io::{self, Read};
use xxhash_rust::xxh32::Xxh32;

/// Length of a record's header, bytes.
pub const HEAD: usize = 12;

/// Decoded record.
#[derive(Clone, Debug, PartialEq)]
pub enum Record {
    /// The identity as JSON.
    Identity(Vec<u8>),
    /// Result of a part: kind of the computation, key of the part, and the bytes.
    Part {
        /// Kind of the computation; not 0.
        kind: u32,
        /// Key of the part.
        key: u64,
        /// The result.
        bytes: Vec<u8>,
    },
}

const IDENTITY: u32 = 0;

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

fn record(salt: u32, kind: u32, contents: &[&[u8]]) -> Vec<u8> {
    let mut record = vec![0; HEAD];
    contents.iter().for_each(|part| record.extend_from_slice(part));
    let head = [(record.len() - HEAD) as u32, kind, checksum(salt, kind, &record[HEAD..])];
    for (place, number) in record.chunks_exact_mut(4).zip(head) {
        place.copy_from_slice(&number.to_le_bytes());
    }
    record
}

/// Encodes the identity record. Its checksum is the salt of the following records.
pub fn identity(json: &[u8]) -> Vec<u8> {
    record(0, IDENTITY, &[json])
}

/// Encodes the result of a part; see [`Record::Part`].
pub fn part(salt: u32, kind: u32, key: u64, bytes: &[u8]) -> Vec<u8> {
    record(salt, kind, &[&key.to_le_bytes(), bytes])
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
    if kind == IDENTITY {
        return Some(Record::Identity(contents));
    }
    let (key, bytes) = contents.split_first_chunk()?;
    Some(Record::Part { kind, key: u64::from_le_bytes(*key), bytes: bytes.to_vec() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn some() -> Vec<(Record, Vec<u8>)> {
        let record = |kind, key, bytes: &[u8]| {
            (Record::Part { kind, key, bytes: bytes.to_vec() }, part(7, kind, key, bytes))
        };
        vec![record(1, 0, b"points of a level"), record(3, 1 << 40, &[0; 33]), record(4, 2, &[])]
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
