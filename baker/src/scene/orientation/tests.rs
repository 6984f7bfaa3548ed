//! Pictures of each kind, tagged by hand, lose the orientation only.

use super::*;
use crate::random::Stream;
use image::metadata::Orientation;
use image::{ExtendedColorType, ImageDecoder, ImageFormat, ImageReader};
use std::io::Cursor;

const KINDS: [ImageFormat; 3] = [ImageFormat::Jpeg, ImageFormat::Png, ImageFormat::WebP];

/// A picture of 8 by 4 texels without metadata.
fn plain(kind: ImageFormat) -> Vec<u8> {
    let texels: Vec<u8> = (0..8 * 4 * 3).map(|i| (i * 2) as u8).collect();
    let mut file = Cursor::new(Vec::new());
    image::write_buffer_with_format(&mut file, &texels, 8, 4, ExtendedColorType::Rgb8, kind).unwrap();
    file.into_inner()
}

/// Exif metadata with a maker's name and an orientation.
fn metadata(is_big: bool, orientation: u16) -> Vec<u8> {
    let short = |n: u16| if is_big { n.to_be_bytes() } else { n.to_le_bytes() };
    let long = |n: u32| if is_big { n.to_be_bytes() } else { n.to_le_bytes() };
    let mut out = if is_big { b"MM".to_vec() } else { b"II".to_vec() };
    out.extend(short(42));
    out.extend(long(8));
    out.extend(short(2));
    for (tag, kind, count, value) in [(0x010f, 2, 4, *b"abc\0"), (ORIENTATION, 3, 1, [0; 4])] {
        out.extend(short(tag));
        out.extend(short(kind));
        out.extend(long(count));
        out.extend(value);
    }
    let end = out.len();
    out[end - 4..end - 2].copy_from_slice(&short(orientation));
    out.extend(long(0));
    out
}

/// A picture with these metadata.
fn tagged(kind: ImageFormat, exif: &[u8]) -> Vec<u8> {
    let file = plain(kind);
    match kind {
        ImageFormat::Jpeg => {
            let segment = [b"Exif\0\0", exif].concat();
            let length = (segment.len() as u16 + 2).to_be_bytes();
            [&file[..2], &[0xff, 0xe1], &length, &segment, &file[2..]].concat()
        }
        ImageFormat::Png => {
            // After the header, which has 13 bytes.
            let chunk = [b"eXIf", exif].concat();
            let sum = crc32fast::hash(&chunk).to_be_bytes();
            [&file[..33], &(exif.len() as u32).to_be_bytes(), &chunk, &sum, &file[33..]].concat()
        }
        _ => {
            let extended = [b"VP8X".as_slice(), &[10, 0, 0, 0, 8, 0, 0, 0, 7, 0, 0, 3, 0, 0]].concat();
            let chunk = [b"EXIF".as_slice(), &(exif.len() as u32).to_le_bytes(), exif].concat();
            let body = [b"WEBP".as_slice(), &extended, &file[12..], &chunk].concat();
            [b"RIFF".as_slice(), &(body.len() as u32).to_le_bytes(), &body].concat()
        }
    }
}

fn orientation(kind: ImageFormat, file: &[u8]) -> Orientation {
    ImageReader::with_format(Cursor::new(file), kind).into_decoder().unwrap().orientation().unwrap()
}

#[test]
fn a_turn_is_taken_out_and_nothing_else() {
    for kind in KINDS {
        for is_big in [false, true] {
            let mut file = tagged(kind, &metadata(is_big, 6));
            assert_eq!(orientation(kind, &file), Orientation::Rotate90, "{kind:?}");
            straighten(&mut file);
            assert_eq!(orientation(kind, &file), Orientation::NoTransforms, "{kind:?}");
            // A picture that is tagged upright from the start is the same file.
            let upright = tagged(kind, &metadata(is_big, 1));
            assert!(file == upright, "{kind:?}");
            straighten(&mut file);
            assert!(file == upright, "{kind:?}");
            let texels = |file: &[u8]| image::load_from_memory_with_format(file, kind).unwrap().into_rgb8();
            assert_eq!(texels(&file), texels(&plain(kind)));
        }
    }
}

#[test]
fn a_picture_without_a_turn_is_the_same_to_the_byte() {
    for kind in KINDS {
        let file = plain(kind);
        let mut after = file.clone();
        straighten(&mut after);
        assert!(after == file, "{kind:?}");
    }
}

#[test]
fn damage_is_no_panic() {
    for kind in KINDS {
        let file = tagged(kind, &metadata(true, 8));
        for end in 0..file.len() {
            straighten(&mut file[..end].to_vec());
        }
        for seed in 0..2_000 {
            let (mut damaged, mut stream) = (file.clone(), Stream::new(seed, 0));
            for _ in 0..3 {
                let at = stream.bits() as usize % damaged.len();
                damaged[at] = if stream.unit() < 0.5 { 0xff } else { stream.bits() as u8 };
            }
            straighten(&mut damaged);
        }
    }
}
