//! Damaged copies of STEP texts.

use std::ops::Range;

/// Numbers that are odd in a STEP file.
const ODD: [&str; 24] = [
    "0",
    "0.",
    "-0.",
    "-1",
    "-1.",
    "1",
    "2",
    "3.",
    "1.E-300",
    "-1.E-300",
    "1.E16",
    "1.E150",
    "-1.E150",
    "1.E300",
    "1.E308",
    "1.E999",
    "-1.E999",
    "4294967296",
    "9223372036854775807",
    "9223372036854775808",
    "18446744073709551616",
    "NAN",
    "INF",
    "6.283185307179586",
];
/// Attributes in place of others.
const VALUES: [&str; 12] = [
    "$",
    "*",
    "()",
    "(())",
    "''",
    ".T.",
    ".F.",
    ".U.",
    "#0",
    "#18446744073709551615",
    "\"0F\"",
    "LENGTH_MEASURE(1.)",
];
/// Most changes of one copy.
const MOST_CHANGES: u64 = 8;
/// Longest text of a copy, bytes.
const LONGEST: usize = 8 << 20;

/// The next number of SplitMix64 (Steele, Lea and Flood 2014), below `end`.
fn draw(state: &mut u64, end: usize) -> usize {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) % end.max(1) as u64) as usize
}

/// One of a list.
fn pick<'a, T: ?Sized>(state: &mut u64, list: &[&'a T]) -> &'a T {
    list[draw(state, list.len())]
}

/// Damaged copy number `index` of one of the texts. Texts below 20 kB are chosen alike, longer ones less often.
pub fn copy(texts: &[Vec<u8>], seed: u64, index: u64) -> Vec<u8> {
    let mut state = seed.wrapping_mul(0xd134_2543_de82_ef95) ^ index.wrapping_mul(0xa076_1d64_78bd_642f);
    let mut chosen = &texts[draw(&mut state, texts.len())];
    while draw(&mut state, chosen.len()) > 20_000 {
        chosen = &texts[draw(&mut state, texts.len())];
    }
    let mut text = chosen.clone();
    // Three of four keep the syntax, but for chance, so that what is read goes deep.
    let is_gentle = draw(&mut state, 4) > 0;
    for _ in 0..=draw(&mut state, MOST_CHANGES as usize) {
        if is_gentle {
            change_content(&mut text, &mut state);
        } else {
            change(&mut text, &mut state);
        }
        text.truncate(LONGEST);
    }
    text
}

/// A change of what is said, not of the syntax.
fn change_content(text: &mut Vec<u8>, state: &mut u64) {
    if text.is_empty() {
        return;
    }
    // Beyond the header.
    let data = text.windows(5).position(|window| window == b"DATA;").unwrap_or(0);
    let at = data + draw(state, text.len() - data);
    match draw(state, 16) {
        0..=3 => {
            let odd = pick(state, &ODD).as_bytes();
            let range = number(text, at).filter(|range| range.start > data && is_value(text, range));
            replace(text, range, odd);
        }
        4 | 5 => {
            // A number of the file for another, or a little more or less.
            let other = number(text, draw(state, text.len())).filter(|range| is_value(text, range));
            let mut with = other.map(|range| text[range].to_vec());
            let range = number(text, at).filter(|range| is_value(text, range));
            if draw(state, 2) == 0
                && let Some(range) = &range
                && let Some(value) =
                    std::str::from_utf8(&text[range.clone()]).ok().and_then(|it| it.parse::<f64>().ok())
            {
                let factor = [0.5, 0.999, 1.000_001, 1.01, 2.0, 1e6, -1.0][draw(state, 7)];
                with = Some(format!("{:?}", value * factor).to_uppercase().into_bytes());
            }
            if let Some(with) = with {
                replace(text, range, &with);
            }
        }
        6..=8 => redirect(text, at, state),
        9 => refer_to_itself(text, at),
        10 => {
            let other = keyword(text, draw(state, text.len())).map(|range| text[range].to_vec());
            if let Some(other) = other {
                replace(text, keyword(text, at).filter(|range| range.start > data + 5), &other);
            }
        }
        11 => {
            let value = pick(state, &VALUES).as_bytes();
            replace(text, reference(text, at).filter(|range| is_value(text, range)), value);
        }
        12 => {
            // True for false.
            let flag = next(
                text,
                at,
                |place| text[place..].starts_with(b".T.") || text[place..].starts_with(b".F."),
                |_| false,
            );
            if let Some(range) = flag {
                text[range.start + 1] = if text[range.start + 1] == b'T' { b'F' } else { b'T' };
            }
        }
        13 => {
            // A list loses an element, or has one twice.
            if let Some(range) = reference(text, at).filter(|range| text.get(range.end) == Some(&b',')) {
                let element = text[range.start..=range.end].to_vec();
                if draw(state, 2) == 0 {
                    text.drain(range.start..=range.end);
                } else {
                    let times = 1 << draw(state, 10);
                    text.splice(range.start..range.start, element.repeat(times));
                }
            }
        }
        14 => replace(text, Some(record(text, at)).filter(|range| range.start > data + 5), b""),
        _ => {
            // Two records of one type change their attributes.
            let [a, b] = [record(text, at), record(text, data + draw(state, text.len() - data))];
            let inner = |range: &Range<usize>| {
                let open = text[range.clone()].iter().position(|byte| *byte == b'(')?;
                Some(range.start + open..range.end)
            };
            if let (Some(a), Some(b)) = (inner(&a), inner(&b))
                && a.end <= b.start
                && a.start > data
            {
                let with = text[b].to_vec();
                text.splice(a, with);
            }
        }
    }
}

/// Whether a token is an attribute, not the number of a record.
fn is_value(text: &[u8], range: &Range<usize>) -> bool {
    let before = text[..range.start].iter().rev().find(|byte| !byte.is_ascii_whitespace());
    matches!(before, Some(b'(' | b','))
}

/// A reference to what another place refers to, or to any number.
fn redirect(text: &mut Vec<u8>, at: usize, state: &mut u64) {
    let mut other = reference(text, draw(state, text.len())).map(|range| text[range].to_vec());
    if draw(state, 8) == 0 {
        other = Some(format!("#{}", draw(state, 1000)).into_bytes());
    }
    let range = reference(text, at).filter(|range| is_value(text, range));
    replace(text, range, &other.unwrap_or_default());
}

/// A reference of a record to itself.
fn refer_to_itself(text: &mut Vec<u8>, at: usize) {
    let line = record(text, at);
    let own = reference(text, line.start).map(|range| text[range].to_vec());
    let inner = reference(text, at).filter(|range| range.end <= line.end && is_value(text, range));
    replace(text, inner, &own.unwrap_or_default());
}

/// A change of any kind.
fn change(text: &mut Vec<u8>, state: &mut u64) {
    if text.is_empty() {
        return;
    }
    let at = draw(state, text.len());
    match draw(state, 24) {
        0 => text[at] ^= 1 << draw(state, 8),
        1 => text[at] = draw(state, 256) as u8,
        2..=5 => replace(text, number(text, at), pick(state, &ODD).as_bytes()),
        6..=8 => redirect(text, at, state),
        9 => refer_to_itself(text, at),
        10 => replace(text, token(text, at), b""),
        11 => {
            let found = token(text, at);
            let twice = found.clone().map(|range| [&text[range.clone()], b",", &text[range]].concat());
            replace(text, found, &twice.unwrap_or_default());
        }
        12 | 13 => {
            let other = token(text, draw(state, text.len())).map(|range| text[range].to_vec());
            replace(text, token(text, at), &other.unwrap_or_default());
        }
        14 => replace(text, token(text, at), pick(state, &VALUES).as_bytes()),
        15 => {
            // A type for another.
            let other = keyword(text, draw(state, text.len())).map(|range| text[range].to_vec());
            replace(text, keyword(text, at), &other.unwrap_or_default());
        }
        16 => replace(text, Some(record(text, at)), b""),
        17 => {
            let line = text[record(text, at)].to_vec();
            let to = record(text, draw(state, text.len())).end;
            text.splice(to..to, line);
        }
        18 => {
            // Two records change their contents.
            let [a, b] = [record(text, at), record(text, draw(state, text.len()))];
            if a.end <= b.start {
                let joined = [&text[b.clone()], &text[a.end..b.start], &text[a.clone()]].concat();
                text.splice(a.start..b.end, joined);
            }
        }
        19 if draw(state, 4) == 0 => text.truncate(at),
        20 => {
            // Nested lists, closed or not.
            let depth = 1 << draw(state, 15);
            let mut nested = vec![b'('; depth];
            if draw(state, 2) == 0 {
                nested.push(b'$');
                nested.extend(std::iter::repeat_n(b')', depth));
            }
            replace(text, token(text, at), &nested);
        }
        21 => {
            let filler = pick(state, &["x", "\\X2\\03C0", "''", "\\", "/*", "\u{e9}", "(", "1", "#"]);
            let long = filler.repeat(1 << draw(state, 16));
            let quoted = if draw(state, 2) == 0 { format!("'{long}'") } else { long };
            replace(text, token(text, at), quoted.as_bytes());
        }
        22 => {
            // A list becomes long: the same element again and again.
            let found = token(text, at);
            let again = found.clone().map(|range| [&text[range], b","].concat().repeat(1 << draw(state, 12)));
            if let (Some(range), Some(again)) = (found, again) {
                text.splice(range.start..range.start, again);
            }
        }
        _ => {
            let end = (at + draw(state, 200)).min(text.len());
            text.drain(at..end);
        }
    }
}

/// Puts bytes in place of a range, if there is one.
fn replace(text: &mut Vec<u8>, range: Option<Range<usize>>, with: &[u8]) {
    if let Some(range) = range {
        text.splice(range, with.iter().copied());
    }
}

/// The next range from a position, or from the beginning, of bytes that pass, the first of which passes another test.
fn next(
    text: &[u8],
    at: usize,
    begins: impl Fn(usize) -> bool,
    goes_on: impl Fn(u8) -> bool,
) -> Option<Range<usize>> {
    let start = (at..text.len()).chain(0..at).find(|&place| begins(place))?;
    let length = text[start + 1..].iter().take_while(|byte| goes_on(**byte)).count();
    Some(start..start + 1 + length)
}

fn is_word(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || byte == b'_'
}

/// Whether a token may begin after the byte before this position.
fn is_start(text: &[u8], at: usize) -> bool {
    at == 0 || !is_word(text[at - 1]) && text[at - 1] != b'#' && text[at - 1] != b'.'
}

fn number(text: &[u8], at: usize) -> Option<Range<usize>> {
    let begins = |place: usize| {
        let byte = text[place];
        is_start(text, place) && (byte.is_ascii_digit() || byte == b'-')
    };
    next(text, at, begins, |byte| is_word(byte) || matches!(byte, b'.' | b'-' | b'+'))
}

fn reference(text: &[u8], at: usize) -> Option<Range<usize>> {
    next(text, at, |place| text[place] == b'#', |byte| byte.is_ascii_digit())
}

fn keyword(text: &[u8], at: usize) -> Option<Range<usize>> {
    next(text, at, |place| is_start(text, place) && text[place].is_ascii_uppercase(), is_word)
}

/// A number, reference, keyword, or a single sign.
fn token(text: &[u8], at: usize) -> Option<Range<usize>> {
    let begins = |place: usize| is_start(text, place) && !text[place].is_ascii_whitespace();
    let range = next(text, at, begins, |byte| is_word(byte) || byte == b'.')?;
    let first = text[range.start];
    let is_sign = !is_word(first) && !matches!(first, b'#' | b'.' | b'-');
    Some(if is_sign { range.start..range.start + 1 } else { range })
}

/// The record about a position, with its semicolon and line break.
fn record(text: &[u8], at: usize) -> Range<usize> {
    let is_end = |byte: &u8| *byte == b';';
    let start = text[..at].iter().rposition(is_end).map_or(0, |end| end + 1);
    let start = start + text[start..at].iter().take_while(|byte| byte.is_ascii_whitespace()).count();
    let end = text[at..].iter().position(is_end).map_or(text.len(), |end| at + end + 1);
    let end = end + text[end..].iter().take_while(|byte| **byte == b'\n').count();
    start..end
}
