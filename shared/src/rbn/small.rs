//! The small sections: bincode 2 standard configuration, at most [`MAX_BYTES`]. The bulk sections are columns of
//! fixed layout ([`codec`](super::codec)).

use super::RbnError;
use super::limits::MAX_BYTES;
use bincode::{Decode, Encode};

/// Encodes a section; `too_large` says what needs over [`MAX_BYTES`], and what to do about it.
///
/// # Errors
/// [`RbnError::TooLarge`].
pub(crate) fn encode(value: impl Encode, too_large: impl FnOnce() -> String) -> Result<Vec<u8>, RbnError> {
    let bytes = bincode::encode_to_vec(value, bincode::config::standard());
    bytes.ok().filter(|bytes| bytes.len() <= MAX_BYTES).ok_or_else(|| RbnError::TooLarge(too_large()))
}

/// Decodes the section of this name, all of it.
///
/// # Errors
/// [`RbnError::Invalid`] for malformed or left-over bytes.
pub(crate) fn decode<T: Decode<()>>(section: &str, bytes: &[u8]) -> Result<T, RbnError> {
    let config = bincode::config::standard().with_limit::<MAX_BYTES>();
    match bincode::decode_from_slice::<T, _>(bytes, config) {
        Ok((value, used)) if used == bytes.len() => Ok(value),
        Ok((_, used)) => {
            Err(RbnError::invalid(section, format!("{} bytes are left over", bytes.len() - used)))
        }
        Err(error) => Err(RbnError::invalid(section, error.to_string())),
    }
}
