//! Parsers of numeric arguments, with checks of the range.

use rebounce_shared::rbn::cube_maps::MAX_SIDE;
use std::ops::RangeInclusive;

/// Parses a finite number accepted by `is_fine`; `wanted` begins the error message.
fn number(text: &str, wanted: &str, is_fine: impl Fn(f64) -> bool) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(number) if number.is_finite() && is_fine(number) => Ok(number),
        _ => Err(format!("{wanted} is needed")),
    }
}

/// Parses a number over 0, as in 0.08.
///
/// # Errors
/// The expected format.
pub fn over_zero(text: &str) -> Result<f64, String> {
    number(text, "a number over 0, as in 0.08,", |number| number > 0.0)
}

/// Parses a number, 0 or over.
///
/// # Errors
/// The expected format.
pub fn at_least_zero(text: &str) -> Result<f64, String> {
    number(text, "a number, 0 or more,", |number| number >= 0.0)
}

/// Parses a finite number.
///
/// # Errors
/// The expected format.
pub fn finite(text: &str) -> Result<f64, String> {
    number(text, "a number", |_| true)
}

/// Parses latitude in degrees, day of the year and solar hour, as in `48,172,15.5`.
///
/// # Errors
/// The expected format.
pub fn daylight(text: &str) -> Result<[f64; 3], String> {
    let wanted =
        "latitude (-90 to 90), day of the year (1 to 366) and hour (0 to 24) are needed, as in 48,172,15.5";
    let parts: Vec<f64> = text.split(',').map_while(|part| part.trim().parse().ok()).collect();
    match parts[..] {
        [latitude, day, hour]
            if text.split(',').count() == 3
                && (-90.0..=90.0).contains(&latitude)
                && (1.0..=366.0).contains(&day)
                && (0.0..=24.0).contains(&hour) =>
        {
            Ok([latitude, day, hour])
        }
        _ => Err(wanted.to_owned()),
    }
}

/// Parses a number over 0 that is normal in single precision, so stays over 0.
///
/// # Errors
/// The expected format.
pub fn over_zero_single(text: &str) -> Result<f32, String> {
    let single = over_zero(text)? as f32;
    if single.is_normal() {
        Ok(single)
    } else {
        Err("a number that is neither tiny nor huge is needed".to_owned())
    }
}

/// Parses a number, 0 or over, in single precision.
///
/// # Errors
/// The expected format.
pub fn at_least_zero_single(text: &str) -> Result<f32, String> {
    let single = at_least_zero(text)? as f32;
    if single.is_finite() { Ok(single) } else { Err("a smaller number is needed".to_owned()) }
}

/// Parses one number that is not negative, or two as in `0.9,0.35`.
///
/// # Errors
/// The expected format.
pub fn one_or_two(text: &str) -> Result<(f32, Option<f32>), String> {
    match text.split_once(',') {
        Some((first, second)) => Ok((at_least_zero_single(first)?, Some(at_least_zero_single(second)?))),
        None => Ok((at_least_zero_single(text)?, None)),
    }
}

/// Parses a number of cube maps, at most `most`, and texels along an edge of their faces, as in `16x32`; `0` for no maps.
///
/// # Errors
/// The expected format.
pub fn cube_maps(text: &str, most: usize) -> Result<(usize, usize), String> {
    if text.trim() == "0" {
        return Ok((0, 1));
    }
    let number = |part: &str, most: usize| part.trim().parse().ok().filter(|n| (1..=most).contains(n));
    text.split_once(['x', 'X'])
        .and_then(|(count, side)| Some((number(count, most)?, number(side, MAX_SIDE as usize)?)))
        .filter(|(_, side)| side.is_power_of_two())
        .ok_or_else(|| {
            format!(
                "give count x side, to {most}x{MAX_SIDE}, the side a power of two, as in 16x32; 0 for none"
            )
        })
}

/// Parses a number within `range`.
///
/// # Errors
/// The expected format.
pub fn within(text: &str, range: RangeInclusive<f32>) -> Result<f32, String> {
    let wanted = format!("a number from {} to {}", range.start(), range.end());
    Ok(number(text, &wanted, |number| range.contains(&(number as f32)))? as f32)
}

/// Parses the three coordinates of a place, as in `0,1.5,-2`.
///
/// # Errors
/// The expected format.
pub fn place(text: &str) -> Result<[f64; 3], String> {
    let wanted = "three numbers, as in 0,1.5,-2,";
    let numbers: Vec<f64> =
        text.split(',').map(|part| number(part, wanted, |x| x.abs() < 1e15)).collect::<Result<_, _>>()?;
    numbers.try_into().map_err(|_| format!("{wanted} is needed"))
}

/// Parses a rectangle of a picture: left, top, right and bottom as shares of width and height, as in `0.1,0.2,0.5,0.6`.
///
/// # Errors
/// The expected format.
pub fn rectangle(text: &str) -> Result<[f64; 4], String> {
    let wanted = "left, top, right and bottom as shares of the picture, as in 0.1,0.2,0.5,0.6,";
    let sides: Vec<f64> = text
        .split(',')
        .map(|part| number(part, wanted, |x| (0.0..=1.0).contains(&x)))
        .collect::<Result<_, _>>()?;
    match sides[..] {
        [left, top, right, bottom] if left < right && top < bottom => Ok([left, top, right, bottom]),
        _ => Err(format!("{wanted} is needed")),
    }
}

/// Parses an albedo, grey or RGB, as in `0.8` or `0.8,0.7,0.6`, with components from 0 to 1.
///
/// # Errors
/// The expected format.
pub fn albedo(text: &str) -> Result<[f32; 3], String> {
    let wanted = "one number or three from 0 to 1, as in 0.8 or 0.8,0.7,0.6,";
    let part = |part: &str| number(part, wanted, |x| (0.0..=1.0).contains(&x)).map(|x| x as f32);
    match text.split(',').map(part).collect::<Result<Vec<_>, _>>()?[..] {
        [grey] => Ok([grey; 3]),
        [r, g, b] => Ok([r, g, b]),
        _ => Err(format!("{wanted} is needed")),
    }
}

/// Parses a number of bytes. A suffix K, M or G is 10^3, 10^6 or 10^9; KiB, MiB or GiB is 2^10, 2^20 or 2^30.
///
/// # Errors
/// The expected format.
pub fn bytes(text: &str) -> Result<u64, String> {
    match with_unit(text.trim().trim_end_matches(['b', 'B'])) {
        Some(bytes) if bytes >= 1.0 && bytes < u64::MAX as f64 => Ok(bytes as u64),
        _ => Err("a number of bytes is needed, as in 8M or 2.5G".to_owned()),
    }
}

/// Parses a count from 1 to `most`, as in 25000, 25K or 1e4.
///
/// # Errors
/// The expected format.
pub fn count(text: &str, most: usize) -> Result<usize, String> {
    match with_unit(text.trim()) {
        Some(count) if count.fract() == 0.0 && (1.0..=most as f64).contains(&count) => Ok(count as usize),
        _ => Err(format!("a whole number from 1 to {most} is needed, as in 25000 or 25K")),
    }
}

/// Parses a number with an optional suffix K, M or G, or Ki, Mi or Gi.
fn with_unit(text: &str) -> Option<f64> {
    let (text, base) = match text.strip_suffix(['i', 'I']) {
        Some(text) => (text, 1024.0f64),
        None => (text, 1000.0),
    };
    let power = match text.chars().next_back()?.to_ascii_uppercase() {
        'K' => 1,
        'M' => 2,
        'G' => 3,
        _ if base == 1024.0 => return None,
        _ => 0,
    };
    let digits = if power > 0 { &text[..text.len() - 1] } else { text };
    digits
        .trim()
        .parse::<f64>()
        .ok()
        .filter(|number| number.is_finite())
        .map(|number| number * base.powi(power))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_nothing_can_be_made_with_are_refused() {
        for text in ["nan", "inf", "-1", "", "x", "1e400"] {
            assert!(over_zero(text).is_err() && at_least_zero(text).is_err(), "{text}");
            assert!(over_zero_single(text).is_err() && within(text, 0.5..=4.0).is_err(), "{text}");
            assert!(bytes(text).is_err() && count(text, 100).is_err(), "{text}");
            assert!(place(&format!("0,{text},1")).is_err() || text == "-1", "{text}");
        }
        assert_eq!(one_or_two("0.9,0.35"), Ok((0.9, Some(0.35))));
        assert_eq!(one_or_two("0.5"), Ok((0.5, None)));
        assert!(["0.9,", "0.9,x", "0.9,0.3,0.1", "-1"].iter().all(|text| one_or_two(text).is_err()));
        assert_eq!(rectangle("0,0.25,0.5,1"), Ok([0.0, 0.25, 0.5, 1.0]));
        for text in ["0,0,1", "0.5,0,0.5,1", "0,0,1,1.5", "0,1,1,0", "0,0,1,1,x", "0,0,1,1,1"] {
            assert!(rectangle(text).is_err(), "{text}");
        }
        assert_eq!((albedo("0.5"), albedo("0,0.5,1")), (Ok([0.5; 3]), Ok([0.0, 0.5, 1.0])));
        for text in ["1.5", "-0.1", "0.5,0.5", "", "0,0,0,0", "red"] {
            assert!(albedo(text).is_err(), "{text}");
        }
        assert!(over_zero("0").is_err() && at_least_zero("0") == Ok(0.0));
        assert!(over_zero_single("1e-60").is_err() && over_zero_single("1e60").is_err());
        assert!(place("1,2").is_err() && place("1,2,3,4").is_err() && place("1,2,1e300").is_err());
        assert_eq!(place("0, 1.5,-2"), Ok([0.0, 1.5, -2.0]));
        assert_eq!(within("1.5", 1.0..=4.0), Ok(1.5));
    }

    #[test]
    fn units_are_thousands_or_1024s() {
        let found = ["8M", "2.5g", "8MB", "8MiB", "1 KiB", "12"].map(|text| bytes(text).unwrap());
        assert_eq!(found, [8_000_000, 2_500_000_000, 8_000_000, 8 << 20, 1024, 12]);
        assert!(bytes("8i").is_err() && bytes("0.5").is_err() && bytes("M").is_err());
        assert_eq!(["25K", "1e4", "7"].map(|text| count(text, 1 << 20).unwrap()), [25_000, 10_000, 7]);
        assert!(count("0", 9).is_err() && count("10", 9).is_err() && count("1.5", 9).is_err());
    }
}
