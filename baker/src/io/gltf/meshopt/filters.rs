//! Inverse filters: decoding of attributes that were transformed for better compression.

/// Undoes a filter in place; an unknown filter or stride is an error.
pub(super) fn undo(filter: &str, bytes: &mut [u8], stride: usize) -> Result<(), String> {
    match (filter, stride) {
        ("NONE", _) => {}
        ("EXPONENTIAL", _) => bytes.as_chunks_mut::<4>().0.iter_mut().for_each(exponential),
        ("QUATERNION", 8) => bytes.as_chunks_mut::<8>().0.iter_mut().for_each(quaternion),
        ("OCTAHEDRAL", 4) => {
            for v in bytes.as_chunks_mut::<4>().0 {
                let [x, y, z] = octahedral([v[0], v[1], v[2]].map(|b| (b as i8) as f32), 127.0);
                [v[0], v[1], v[2]] = [x, y, z].map(|c| c as i8 as u8);
            }
        }
        ("OCTAHEDRAL", 8) => {
            for v in bytes.as_chunks_mut::<8>().0 {
                let [x, y, z, w] = words(v).map(|c| c as i16);
                let [x, y, z] = octahedral([x, y, z].map(f32::from), 32767.0).map(|c| c as i16);
                *v = bytes_of([x, y, z, w].map(|c| c as u16));
            }
        }
        ("COLOR", 4) => {
            for v in bytes.as_chunks_mut::<4>().0 {
                let [y, co, cg, a] = *v;
                *v = colour([y as i32, co as i8 as i32, cg as i8 as i32, a as i32], 255.0).map(|c| c as u8);
            }
        }
        ("COLOR", 8) => {
            for v in bytes.as_chunks_mut::<8>().0 {
                let [y, co, cg, a] = words(v);
                let rgba = colour([y as i32, co as i16 as i32, cg as i16 as i32, a as i32], 65535.0);
                *v = bytes_of(rgba.map(|c| c as u16));
            }
        }
        _ => return Err(format!("has the filter {filter:?} over {stride} bytes")),
    }
    Ok(())
}

fn words(v: &[u8; 8]) -> [u16; 4] {
    std::array::from_fn(|i| u16::from_le_bytes([v[2 * i], v[2 * i + 1]]))
}

fn bytes_of(words: [u16; 4]) -> [u8; 8] {
    std::array::from_fn(|i| words[i / 2].to_le_bytes()[i % 2])
}

/// Decodes a vector of length `max` from two octahedral coordinates and the encoding of 1.
fn octahedral([x, y, one]: [f32; 3], max: f32) -> [f32; 3] {
    let (x, y) = (x / one, y / one);
    let z = 1.0 - x.abs() - y.abs();
    let fold = (-z).max(0.0);
    let (x, y) = (x - fold.copysign(x), y - fold.copysign(y));
    let scale = max / (x * x + y * y + z * z).sqrt();
    [x, y, z].map(|c| (c * scale).round())
}

/// Decodes a quaternion from the three smaller components; the fourth number has the index of the missing component,
/// and the range.
fn quaternion(v: &mut [u8; 8]) {
    let [x, y, z, w] = words(v).map(|c| c as i16);
    let scale = std::f32::consts::FRAC_1_SQRT_2 / (w | 3) as f32;
    let small = [x, y, z].map(|c| c as f32 * scale);
    let missing = (1.0 - small.iter().map(|c| c * c).sum::<f32>()).max(0.0).sqrt();
    let mut out = [0; 4];
    for (i, c) in small.into_iter().chain([missing]).enumerate() {
        out[((w & 3) as usize + 1 + i) % 4] = (c * 32767.0).round() as i16 as u16;
    }
    *v = bytes_of(out);
}

/// A float from an exponent of 8 bits and a mantissa of 24.
fn exponential(v: &mut [u8; 4]) {
    let bits = i32::from_le_bytes(*v);
    let (exponent, mantissa) = (bits >> 24, (bits << 8) >> 8);
    *v = ((mantissa as f64 * (exponent as f64).exp2()) as f32).to_le_bytes();
}

/// Decodes RGBA from luma, two chroma differences and alpha; the highest set bit of alpha is the bit depth of all
/// channels.
fn colour([y, co, cg, a]: [i32; 4], max: f32) -> [f32; 4] {
    let full = (1i32 << (32 - a.leading_zeros())) - 1;
    let alpha = a & (full >> 1);
    let alpha = alpha << 1 | (alpha & 1);
    let scale = max / full as f32;
    [y + co - cg, y + cg, y - co - cg, alpha].map(|c| (c as f32 * scale).round())
}
