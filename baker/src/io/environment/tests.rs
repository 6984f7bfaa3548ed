use super::*;
use crate::io::picture::Picture;
use image::codecs::hdr::HdrEncoder;
use image::{Rgb, RgbImage};

/// Smooth radiance from 0.01 to 1,000.
fn picture(width: u32, height: u32) -> Environment {
    let pixel = |i: u32| {
        let (x, y) = ((i % width) as f32 / width as f32, (i / width) as f32 / height as f32);
        Vec3::new(0.01 + x, 0.5 + 0.5 * y, 0.1 + 1000.0 * (x * y).powi(8))
    };
    Environment { width, height, pixels: (0..width * height).map(pixel).collect() }
}

fn hdr(picture: &Environment) -> Vec<u8> {
    let mut bytes = Vec::new();
    let pixels: Vec<Rgb<f32>> = picture.pixels.iter().map(|p| Rgb(p.to_array())).collect();
    HdrEncoder::new(&mut bytes).encode(&pixels, picture.width as usize, picture.height as usize).unwrap();
    bytes
}

fn exr(picture: &Environment) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let (width, height) = (picture.width, picture.height);
    Picture { width, height, pixels: picture.pixels.clone() }.write(&path, 1.0).unwrap();
    std::fs::read(path).unwrap()
}

fn jpeg(picture: &RgbImage) -> Vec<u8> {
    let mut bytes = Vec::new();
    image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, 100).encode_image(picture).unwrap();
    bytes
}

/// A JPEG with another segment behind its first marker.
fn with_segment(jpeg: &[u8], marker: u8, payload: &[u8]) -> Vec<u8> {
    let mut bytes = jpeg[..2].to_vec();
    bytes.extend([0xff, marker]);
    bytes.extend((payload.len() as u16 + 2).to_be_bytes());
    bytes.extend(payload);
    bytes.extend(&jpeg[2..]);
    bytes
}

fn with_xmp(jpeg: &[u8], text: &str) -> Vec<u8> {
    with_segment(jpeg, 0xe1, format!("http://ns.adobe.com/xap/1.0/\0{text}").as_bytes())
}

const GAIN: &str = r#"hdrgm:Version="1.0" hdrgm:GainMapMin="0" hdrgm:GainMapMax="4" hdrgm:OffsetSDR="0"
    hdrgm:OffsetHDR="0""#;

/// White with a gain of 1 on the left and of 16 on the right; the map has a quarter of the width.
fn ultra_hdr() -> Vec<u8> {
    let base = jpeg(&RgbImage::from_pixel(64, 32, Rgb([255; 3])));
    let map = RgbImage::from_fn(16, 8, |x, _| Rgb([if x < 8 { 0 } else { 255 }; 3]));
    let mut file = with_xmp(&base, r#"hdrgm:Version="1.0""#);
    file.extend(with_xmp(&jpeg(&map), GAIN));
    file
}

fn problem(bytes: &[u8]) -> String {
    decode(bytes, "sky").unwrap_err().to_string()
}

#[test]
fn radiance_comes_back_from_hdr() {
    let original = picture(64, 32);
    let (read, notes) = decode(&hdr(&original), "sky.hdr").unwrap();
    assert_eq!((read.width, read.height, notes.len()), (64, 32, 0));
    for (a, b) in read.pixels.iter().zip(&original.pixels) {
        assert!((*a - *b).abs().max_element() <= b.max_element() / 127.0, "{a} {b}");
    }
}

#[test]
fn radiance_comes_back_from_exr_and_from_a_path() {
    let original = picture(64, 32);
    assert_eq!(decode(&exr(&original), "sky.exr").unwrap(), (original.clone(), Vec::new()));
    let folder = tempfile::tempdir().unwrap();
    // The format is known by the first bytes.
    let path = folder.path().join("sky.unknown");
    std::fs::write(&path, exr(&original)).unwrap();
    assert_eq!(read(&path).unwrap().0, original);
    let absent = read(&folder.path().join("none.hdr")).unwrap_err().to_string();
    assert!(absent.contains("none.hdr") && absent.contains("check the path"), "{absent}");
}

#[test]
fn signature_and_exposure_of_a_radiance_header_are_read() {
    let original = picture(16, 8);
    let bytes = hdr(&original);
    let end = bytes.iter().position(|&b| b == b'\n').unwrap();
    let mut changed = b"#?RGBE\nEXPOSURE=4\nEXPOSURE=0.5\nCOLORCORR= 1 1 2".to_vec();
    changed.extend(&bytes[end..]);
    let (read, notes) = decode(&changed, "sky.hdr").unwrap();
    assert_eq!(notes.len(), 1, "{notes:?}");
    let plain = decode(&bytes, "sky.hdr").unwrap().0;
    assert_eq!(read.pixels[5], plain.pixels[5] / Vec3::new(2.0, 2.0, 4.0));
    let mut dark = b"#?RGBE\nEXPOSURE=0".to_vec();
    dark.extend(&bytes[end..]);
    assert!(problem(&dark).contains("exposure"), "{}", problem(&dark));
}

#[test]
fn a_gain_map_is_applied_wherever_it_lies() {
    let check = |bytes: &[u8]| {
        let (read, _) = decode(bytes, "sky.jpg").unwrap();
        assert_eq!((read.width, read.height), (64, 32));
        let near = |a: Vec3, b: f32| assert!((a / b - 1.0).abs().max_element() < 0.05, "{a} instead of {b}");
        near(read.at(16, 10), 1.0);
        near(read.at(48, 20), 16.0);
    };
    check(&ultra_hdr());

    // By the Multi-Picture index, with something else between the pictures.
    let base = jpeg(&RgbImage::from_pixel(64, 32, Rgb([255; 3])));
    let map = with_xmp(&jpeg(&RgbImage::from_fn(16, 8, |x, _| Rgb([(x / 8 * 255) as u8; 3]))), GAIN);
    for is_big in [false, true] {
        let u16 = |x: u16| if is_big { x.to_be_bytes() } else { x.to_le_bytes() };
        let u32 = |x: u32| if is_big { x.to_be_bytes() } else { x.to_le_bytes() };
        let index = |offset: u32| {
            let mut index = b"MPF\0".to_vec();
            index.extend(if is_big { b"MM\0\x2a" } else { b"II\x2a\0" });
            index.extend(u32(8));
            index.extend(u16(1));
            index.extend([&u16(0xb002)[..], &u16(7), &u32(32), &u32(26), &u32(0)].concat());
            index.extend([u32(0), u32(0), u32(0), u32(0)].concat());
            index.extend([u32(0), u32(map.len() as u32), u32(offset), u32(0)].concat());
            index
        };
        let first = with_segment(&base, 0xe2, &index(0));
        // The TIFF header lies behind SOI, marker, length and "MPF\0".
        let offset = first.len() + 7 - 10;
        let mut file = with_segment(&base, 0xe2, &index(offset as u32));
        file.extend(b"between");
        file.extend(&map);
        check(&file);
    }
}

#[test]
fn what_is_no_environment_is_refused_with_a_reason() {
    for bytes in [&b""[..], b"#", b"\x89PNG\r\n", b"hello"] {
        assert!(problem(bytes).contains("neither Radiance"));
    }
    let plain = jpeg(&RgbImage::new(64, 32));
    assert!(problem(&plain).contains("without a gain map"));
    let iso = with_segment(&plain, 0xe2, b"urn:iso:std:iso:ts:21496:-1\0\0\0");
    assert!(problem(&iso).contains("ISO 21496-1"));
    let mut inverse = plain.clone();
    inverse.extend(with_xmp(&plain, r#"hdrgm:GainMapMax="1" hdrgm:BaseRenditionIsHDR="True""#));
    assert!(problem(&inverse).contains("base picture"));
}

#[test]
fn truncated_files_are_refused() {
    for (bytes, name) in [(hdr(&picture(64, 32)), "Radiance"), (exr(&picture(64, 32)), "OpenEXR")] {
        for length in [12, 30, 200, bytes.len() / 2, bytes.len() - 1] {
            let message = problem(&bytes[..length]);
            assert!(message.contains(name) && message.contains("download it again"), "{length}: {message}");
        }
    }
    let bytes = ultra_hdr();
    let base = jpeg(&RgbImage::from_pixel(64, 32, Rgb([255; 3]))).len();
    for length in [3, 200, base / 2, base + 40, bytes.len() / 2 + 200, bytes.len() - 1] {
        let message = problem(&bytes[..length]);
        assert!(message.contains("truncated"), "{length}: {message}");
    }
}

#[test]
fn texels_that_are_no_radiance_are_named() {
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -0.5] {
        let mut bad = picture(64, 32);
        bad.pixels[5 * 64 + 17].y = value;
        bad.pixels[9 * 64].x = value;
        let message = problem(&exr(&bad));
        assert!(message.contains("x = 17, y = 5") && message.contains("paint the pixel over"), "{message}");
    }
}

#[test]
fn sizes_that_are_no_panorama_are_refused() {
    let header = |size: &str| format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n{size}\n").into_bytes();
    assert!(problem(&header("-Y 0 +X 0")).contains("0x0 pixels"));
    assert!(problem(&hdr(&picture(60, 40))).contains("1.50:1"));
    assert!(problem(&exr(&picture(32, 32))).contains("1.00:1"));
    for (width, height) in [(65, 32), (63, 32), (2, 1)] {
        assert!(decode(&hdr(&picture(width, height)), "sky").is_ok());
    }
}

#[test]
fn bombs_are_refused_before_memory_is_taken() {
    let header = |size: &str| format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n{size}\n").into_bytes();
    for size in
        ["-Y 50000 +X 100000", "-Y 100000 +X 100000", "-Y 8192 +X 16384", "-Y 2147483647 +X 4294967294"]
    {
        let message = problem(&header(size));
        assert!(message.contains("claims") || message.contains("too large"), "{message}");
    }
    // The size of an EXR is in its data window and display window.
    let mut bytes = exr(&picture(64, 32));
    let window = [0i32, 0, 63, 31].map(i32::to_le_bytes).concat();
    let large = [0i32, 0, 99_999, 49_999].map(i32::to_le_bytes).concat();
    let places: Vec<usize> = (0..bytes.len() - 16).filter(|&i| bytes[i..i + 16] == window[..]).collect();
    assert_eq!(places.len(), 2);
    places.into_iter().for_each(|i| bytes[i..i + 16].copy_from_slice(&large));
    let name = b"chunkCount\0int\0\x04\0\0\0";
    if let Some(at) = bytes.windows(name.len()).position(|window| window == name) {
        // Blocks of 16 lines.
        bytes[at + name.len()..][..4].copy_from_slice(&3125i32.to_le_bytes());
    }
    assert!(problem(&bytes).contains("claims 100000x50000"), "{}", problem(&bytes));
    // The size of a JPEG is in its frame header: FF C0, length, precision, height, width.
    let mut bytes = ultra_hdr();
    let frame = bytes.windows(2).position(|pair| pair == [0xff, 0xc0]).unwrap();
    bytes[frame + 5..frame + 9].copy_from_slice(&[0x7f, 0xff, 0xff, 0xfe]);
    assert!(problem(&bytes).contains("claims 65534x32767"), "{}", problem(&bytes));
}

#[test]
fn wide_environments_are_reduced_and_keep_their_energy() {
    let wide = picture(4098, 2049);
    let (read, notes) = decode(&exr(&wide), "sky.exr").unwrap();
    assert_eq!((read.width, read.height), (4096, 2048));
    assert!(notes[0].contains("4098x2049") && notes[0].contains("4096x2048"), "{notes:?}");
    let ratio = read.energy() / wide.energy();
    assert!((ratio - 1.0).abs().max_element() < 1e-5, "{ratio}");
}
