//! Modes TRIANGLES and INDICES: index lists.

use super::{ByteStream, unzigzag};

/// The last 2^n numbers pushed.
struct Recent<const N: usize> {
    numbers: [u32; N],
    next: usize,
}

impl<const N: usize> Recent<N> {
    fn new() -> Self {
        Self { numbers: [u32::MAX; N], next: 0 }
    }

    fn push(&mut self, number: u32) {
        self.numbers[self.next % N] = number;
        self.next = self.next.wrapping_add(1);
    }

    /// Returns the number pushed `back` numbers before the last.
    fn get(&self, back: usize) -> u32 {
        self.numbers[self.next.wrapping_sub(1 + back) % N]
    }
}

/// Decoder state of a triangle list.
struct DecoderState<'a> {
    edges: Recent<32>,
    vertices: Recent<16>,
    /// The next new index.
    next: u32,
    /// The last explicit index.
    last: u32,
    data: ByteStream<'a>,
}

impl DecoderState<'_> {
    fn fresh(&mut self) -> u32 {
        self.next = self.next.wrapping_add(1);
        self.next.wrapping_sub(1)
    }

    fn written_out(&mut self) -> Option<u32> {
        self.last = self.last.wrapping_add(unzigzag(self.data.number()?));
        Some(self.last)
    }

    /// Decodes a corner: a new vertex, a recent vertex, or (if `written`) an explicit index.
    fn corner(&mut self, code: u8, written: bool) -> Option<u32> {
        match code {
            0 => Some(self.fresh()),
            15 if written => self.written_out(),
            _ => Some(self.vertices.get(code as usize - 1)),
        }
    }

    /// Adds a new or explicit corner to the recent vertices.
    fn remember(&mut self, code: u8, written: bool, corner: u32) {
        if code == 0 || (code == 15 && written) {
            self.vertices.push(corner);
        }
    }

    fn push_edges(&mut self, edges: &[[u32; 2]]) {
        for &[a, b] in edges {
            self.edges.push(a);
            self.edges.push(b);
        }
    }

    /// Decodes a triangle that shares an edge with an earlier triangle.
    fn on_edge(&mut self, edge: u8, code: u8) -> Option<[u32; 3]> {
        let [a, b] = [0, 1].map(|end| self.edges.get(2 * edge as usize + end));
        let c = match code {
            0 => self.fresh(),
            1..13 => self.vertices.get(code as usize),
            13 | 14 => {
                self.last = if code == 13 { self.last.wrapping_sub(1) } else { self.last.wrapping_add(1) };
                self.last
            }
            _ => self.written_out()?,
        };
        if code == 0 || code >= 13 {
            self.vertices.push(c);
        }
        self.push_edges(&[[b, c], [c, a]]);
        Some([a, b, c])
    }

    /// Decodes a triangle without a shared edge; `known` is the table of frequent corner codes.
    fn alone(&mut self, code: u8, known: &[u8]) -> Option<[u32; 3]> {
        let written = code >= 14;
        let codes = if written { self.data.byte()? } else { *known.get(code as usize)? };
        if written && codes == 0 {
            self.next = 0;
        }
        let (second, third) = (codes >> 4, codes & 15);
        let a = if code == 15 { self.written_out()? } else { self.fresh() };
        let b = self.corner(second, written)?;
        let c = self.corner(third, written)?;
        self.vertices.push(a);
        self.remember(second, written, b);
        self.remember(third, written, c);
        self.push_edges(&[[a, b], [b, c], [c, a]]);
        Some([a, b, c])
    }
}

/// Decodes a triangle list of `count` indices.
pub(super) fn triangles(packed: &[u8], count: usize) -> Option<Vec<u32>> {
    if packed.first() != Some(&0xe1) || !count.is_multiple_of(3) {
        return None;
    }
    let (body, known) = packed[1..].split_at_checked(packed.len().checked_sub(17)?)?;
    // One code byte per triangle bounds the count by the data.
    let (codes, data) = body.split_at_checked(count / 3)?;
    let (edges, vertices) = (Recent::new(), Recent::new());
    let mut state = DecoderState { edges, vertices, next: 0, last: 0, data: ByteStream { bytes: data } };
    let mut out = Vec::with_capacity(count);
    for code in codes {
        let (high, low) = (code >> 4, code & 15);
        out.extend(if high < 15 { state.on_edge(high, low) } else { state.alone(low, known) }?);
    }
    state.data.bytes.is_empty().then_some(out)
}

/// Decodes `count` indices without triangle structure: deltas to either of two earlier indices.
pub(super) fn sequence(packed: &[u8], count: usize) -> Option<Vec<u32>> {
    if packed.first() != Some(&0xd1) {
        return None;
    }
    let mut stream = ByteStream { bytes: packed[1..].split_at_checked(packed.len().checked_sub(5)?)?.0 };
    let mut last = [0u32; 2];
    let mut out = Vec::new();
    for _ in 0..count {
        let value = stream.number()?;
        let last = &mut last[(value & 1) as usize];
        *last = last.wrapping_add(unzigzag(value >> 1));
        out.push(*last);
    }
    stream.bytes.is_empty().then_some(out)
}
