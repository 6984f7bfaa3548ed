//! Segments of a JPEG file (ISO/IEC 10918-1, annex B), and the pictures that lie behind its first one (CIPA DC-007,
//! Multi-Picture Format).

const SOI: u8 = 0xd8;
const EOI: u8 = 0xd9;
const SOS: u8 = 0xda;
const APP1: u8 = 0xe1;
const APP2: u8 = 0xe2;
const XMP: &[u8] = b"http://ns.adobe.com/xap/1.0/\0";
const MPF: &[u8] = b"MPF\0";
const ICC: &[u8] = b"ICC_PROFILE\0";
/// Tag of the list of pictures in a Multi-Picture index, and the size of its entries in bytes.
const PICTURES: u16 = 0xb002;
const ENTRY: usize = 16;

/// The segments of the first picture of a file.
pub(super) struct JpegSegments<'a> {
    file: &'a [u8],
    /// Marker, and where the payload begins and ends.
    segments: Vec<(u8, usize, usize)>,
    /// Where the picture ends; `None` if it is truncated.
    pub(super) end: Option<usize>,
}

impl<'a> JpegSegments<'a> {
    /// Walks through a file; stops where it is damaged.
    pub(super) fn new(file: &'a [u8]) -> Self {
        let mut found = Self { file, segments: Vec::new(), end: None };
        let mut at = 2;
        while let Some((marker, payload)) = next_marker(file, at) {
            match marker {
                EOI => {
                    found.end = Some(payload);
                    break;
                }
                // Markers without a payload.
                0x01 | 0xd0..=SOI => at = payload,
                _ => {
                    let Some(length) = u16_at(file, payload, false) else { break };
                    let end = payload + usize::from(length);
                    if length < 2 || end > file.len() {
                        break;
                    }
                    found.segments.push((marker, payload + 2, end));
                    at = if marker == SOS { end_of_scan(file, end) } else { end };
                }
            }
        }
        found
    }

    /// Where the payloads of a marker with a signature are, behind the signature.
    fn with(&self, marker: u8, signature: &'static [u8]) -> impl Iterator<Item = (usize, usize)> {
        let is_it = move |&&(m, start, end): &&(u8, usize, usize)| {
            m == marker && self.file[start..end].starts_with(signature)
        };
        self.segments.iter().filter(is_it).map(move |&(_, start, end)| (start + signature.len(), end))
    }

    /// The XMP metadata.
    pub(super) fn xmp(&self) -> Option<String> {
        let (start, end) = self.with(APP1, XMP).next()?;
        Some(String::from_utf8_lossy(&self.file[start..end]).into_owned())
    }

    /// Whether there is a colour profile.
    pub(super) fn has_profile(&self) -> bool {
        self.with(APP2, ICC).next().is_some()
    }

    /// Whether there is a segment APP2 with a signature.
    pub(super) fn has_app2(&self, signature: &'static [u8]) -> bool {
        self.with(APP2, signature).next().is_some()
    }

    /// The other pictures of the file: those of the Multi-Picture index, then what follows the first picture.
    pub(super) fn others(&self) -> Vec<&'a [u8]> {
        let indexed = self.with(APP2, MPF).filter_map(|(start, _)| self.indexed(start)).flatten();
        let behind = self.end.and_then(|end| {
            let rest = &self.file[end..];
            let start = rest.windows(3).position(|bytes| bytes == [0xff, SOI, 0xff])?;
            Some(&rest[start..])
        });
        indexed.chain(behind).collect()
    }

    /// Pictures of a Multi-Picture index whose TIFF header is at a place; offsets count from there.
    fn indexed(&self, header: usize) -> Option<Vec<&'a [u8]>> {
        let is_big = self.file.get(header..header + 2)? == b"MM";
        let u16_at = |at: usize| u16_at(self.file, at, !is_big);
        let u32_at = |at: usize| u32_at(self.file, at, !is_big);
        let directory = header.checked_add(u32_at(header + 4)? as usize)?;
        let fields = (0..usize::from(u16_at(directory)?)).map(|i| directory + 2 + 12 * i);
        let list = fields.take_while(|&at| u16_at(at).is_some()).find(|&at| u16_at(at) == Some(PICTURES))?;
        let count = u32_at(list + 4)? as usize / ENTRY;
        let first = header.checked_add(u32_at(list + 8)? as usize)?;
        let picture = |i: usize| {
            let entry = first.checked_add(i * ENTRY)?;
            let (size, offset) = (u32_at(entry + 4)? as usize, u32_at(entry + 8)? as usize);
            let start = header.checked_add(offset)?;
            let bytes = self.file.get(start..start.checked_add(size)?)?;
            bytes.starts_with(&[0xff, SOI]).then_some(bytes)
        };
        // The first entry is the picture itself, with an offset of 0.
        Some((1..count.min(64)).filter_map(picture).collect())
    }
}

/// The marker at a place, with fill bytes before it, and where it ends.
fn next_marker(file: &[u8], at: usize) -> Option<(u8, usize)> {
    let rest = file.get(at..)?;
    let fill = rest.iter().take_while(|&&byte| byte == 0xff).count();
    (fill > 0).then_some(())?;
    Some((*rest.get(fill)?, at + fill + 1))
}

/// Where the entropy-coded data from a place end: before a marker that is neither a stuffed byte nor a restart.
fn end_of_scan(file: &[u8], at: usize) -> usize {
    let is_marker = |pair: &[u8]| pair[0] == 0xff && !matches!(pair[1], 0 | 0xd0..=0xd7 | 0xff);
    file[at..].windows(2).position(is_marker).map_or(file.len(), |i| at + i)
}

fn u16_at(file: &[u8], at: usize, is_little: bool) -> Option<u16> {
    let bytes = file.get(at..at.checked_add(2)?)?.try_into().ok()?;
    Some(if is_little { u16::from_le_bytes(bytes) } else { u16::from_be_bytes(bytes) })
}

fn u32_at(file: &[u8], at: usize, is_little: bool) -> Option<u32> {
    let bytes = file.get(at..at.checked_add(4)?)?.try_into().ok()?;
    Some(if is_little { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) })
}
