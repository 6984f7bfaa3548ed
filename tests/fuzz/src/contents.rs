//! Unpacked contents of a .rbn file as a fuzz input: switches, then the parts with length prefixes. Arbitrary bytes
//! are valid contents, so that damage reaches the rules behind the codec.

use crate::{Random, mutated, put};
use bytemuck::Pod;
use rebounce_shared::link::{LaterLink, Link, MAX_SENDERS, MAX_SOURCES, Sent, SourceLink};
use rebounce_shared::rbn::bulk::{Copies, Cut, Instance, Point, Vertex};
use rebounce_shared::rbn::codec::{columns, links};
use rebounce_shared::rbn::container::MAGIC;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::rbn::light_groups::{self, GroupValue, LightGroup};
use rebounce_shared::rbn::{
    COPY_SECTIONS, GROUP_SECTIONS, LinkMatrix, MAX_TRIANGLES, SECTIONS, SOURCE_SECTIONS, meta, sources,
};
use rebounce_shared::diffuse_transfer::{DistantLight, TransferField};
use rebounce_shared::harmonics::COUNT;
use rebounce_shared::relight::{from_groups, from_sources};

/// Size of a link or later link in an input, bytes: a step from the previous index (zero at a row's end), then the
/// value.
const LINK: usize = 6;
/// First byte of an input; set low bits disable corrections.
const MARK: u8 = 0xe0;

/// Number of parts.
const PARTS: usize = 14;

/// Switches and parts, parts in the order of the sections.
pub struct Contents {
    switches: u8,
    parts: [Vec<u8>; PARTS],
}

impl Contents {
    /// Parses an input or a .rbn file; seeds are .rbn files.
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        if bytes.starts_with(&MAGIC) {
            return Some(Self::of(&BakedScene::from_bytes(bytes).ok()?));
        }
        let (switches, mut rest) = bytes.split_first().filter(|(first, _)| **first & MARK == MARK)?;
        let mut parts: [Vec<u8>; PARTS] = Default::default();
        for part in &mut parts {
            let Some((len, tail)) = rest.split_first_chunk::<4>() else { break };
            let (head, tail) = tail.split_at((u32::from_le_bytes(*len) as usize).min(tail.len()));
            (*part, rest) = (head.to_vec(), tail);
        }
        Some(Self { switches: *switches, parts })
    }

    fn of(scene: &BakedScene) -> Self {
        let parts = [
            meta::encode(&scene.meta).unwrap_or_default(),
            bytemuck::cast_slice(&scene.vertices).to_vec(),
            bytemuck::cast_slice(&scene.indices).to_vec(),
            bytemuck::cast_slice(&scene.points).to_vec(),
            bytemuck::cast_slice(&scene.cuts).to_vec(),
            steps(&scene.links, |link| (link.0 & (MAX_SENDERS as u32 - 1), link.0)),
            steps(&scene.later, |link| (link.sender, link.colour)),
            scene.texture_bytes.clone(),
            bytemuck::cast_slice(&scene.instances).to_vec(),
            bytemuck::cast_slice(&scene.copies).to_vec(),
            sources::encode(&scene.sources).ok().flatten().unwrap_or_default(),
            steps(&scene.source_links, |link| (link.sender() as u32, link.0)),
            light_groups::encode(&scene.light_groups.groups).ok().flatten().unwrap_or_default(),
            bytemuck::cast_slice(&scene.light_groups.values).to_vec(),
        ];
        Self { switches: MARK, parts }
    }

    fn to_bytes(&self) -> Vec<u8> {
        let mut out = vec![self.switches];
        for part in &self.parts {
            out.extend((part.len() as u32).to_le_bytes());
            out.extend(part);
        }
        out
    }

    /// Returns names and bytes of the sections; counts and indices are made consistent unless disabled by a switch.
    pub fn packed(&self) -> Vec<([u8; 4], Vec<u8>)> {
        let [meta_bytes, vertices, indices, points, cuts, links, later, textures, instances, copies, rest @ ..] =
            &self.parts;
        let [sources, source_links, groups, values] = rest;
        let is_made_to_fit = |bit: u8| self.switches >> bit & 1 == 0;
        let vertices: Vec<Vertex> = records(vertices);
        let mut indices: Vec<u32> = records(indices);
        let mut points: Vec<Point> = records(points);
        let cuts: Vec<Cut> = records(cuts);
        let instances: Vec<Instance> = records(instances);
        let mut copies: Vec<Copies> = records(copies);
        if is_made_to_fit(0) {
            indices.truncate(indices.len() / 3 * 3);
            indices.iter_mut().for_each(|i| *i %= vertices.len().max(1) as u32);
        }
        if is_made_to_fit(1) {
            for point in &mut points {
                let (first, count) = (point.cuts().start, point.cuts().len().min(4).min(cuts.len()));
                let first = first % (cuts.len() - count + 1);
                point.cuts = Point::pack_cuts(first, count, (point.cuts >> 3) as u8);
            }
        }
        let mut meta_bytes = meta_bytes.clone();
        let (mut rows, mut later_rows, mut lights) = (points.len(), 0, 0);
        if let Ok(mut meta) = meta::decode(&meta_bytes) {
            lights = meta.lights.len();
            if is_made_to_fit(2) {
                let mut next = 0u32;
                let last = meta.levels.len().saturating_sub(1);
                for (l, level) in meta.levels.iter_mut().enumerate() {
                    let left = points.len() as u32 - next;
                    level.first = next;
                    level.count = if l == last { left } else { level.count.min(left) };
                    next += level.count;
                }
                meta.direct_levels = meta.direct_levels.min(meta.levels.len() as u32);
                meta.sender_levels = meta.sender_levels.min(meta.direct_levels);
                meta.later_levels = meta.later_levels.min(meta.sender_levels);
                meta.levels
                    .iter()
                    .take(meta.later_levels as usize)
                    .for_each(|l| later_rows += l.count as usize);
            }
            if is_made_to_fit(3) {
                let mut first = 0;
                for draw in &mut meta.draws {
                    let count = draw.index_count.min(indices.len() as u32 - first) / 3 * 3;
                    (draw.first_index, draw.index_count) = (first, count);
                    first += count;
                }
                meta.draws.retain(|draw| draw.index_count > 0);
                if !copies.is_empty() {
                    copies.resize(meta.draws.len(), Copies::default());
                }
                for copies in &mut copies {
                    copies.first %= instances.len() as u32 + 1;
                    copies.count %= instances.len() as u32 - copies.first + 1;
                }
            }
            meta_bytes = meta::encode(&meta).unwrap_or(meta_bytes);
        }
        if !is_made_to_fit(4) {
            (rows, later_rows) = (usize::MAX, usize::MAX);
        }
        let links = matrix(links, rows, MAX_SENDERS, |sender, bits| Link(bits & !(MAX_SENDERS as u32 - 1) | sender));
        let later = matrix(later, later_rows, MAX_SENDERS, |sender, colour| LaterLink { sender, colour });
        let packed = [
            meta_bytes,
            columns::encode(&vertices),
            columns::encode(&indices),
            columns::encode(&points),
            columns::encode(&cuts),
            links::encode(&links.offsets, &links.links),
            links::encode(&later.offsets, &later.links),
            textures.clone(),
        ];
        let mut sections: Vec<_> = SECTIONS.into_iter().zip(packed).collect();
        if !(instances.is_empty() && copies.is_empty()) {
            let copied = [columns::encode(&instances), columns::encode(&copies)];
            sections.extend(COPY_SECTIONS.into_iter().zip(copied));
        }
        if !sources.is_empty() {
            let link = |source, bits: u32| SourceLink(bits & !(MAX_SOURCES as u32 - 1) | source);
            let linked = matrix(source_links, rows, MAX_SOURCES, link);
            let packed = [sources.clone(), links::encode(&linked.offsets, &linked.links)];
            sections.extend(SOURCE_SECTIONS.into_iter().zip(packed));
        }
        if !groups.is_empty() {
            let mut values: Vec<GroupValue> = records(values);
            let mut groups = groups.clone();
            if let (true, Ok(mut all)) = (is_made_to_fit(4), light_groups::decode(&groups)) {
                all.resize(lights, LightGroup { floor: 1e-3, has_direct: false });
                let columns = all.len() + all.iter().filter(|group| group.has_direct).count();
                values.resize(columns * points.len(), GroupValue::default());
                groups = light_groups::encode(&all).ok().flatten().unwrap_or(groups);
            }
            sections.extend(GROUP_SECTIONS.into_iter().zip([groups, columns::encode(&values)]));
        }
        sections
    }
}

/// Converts bytes to records.
fn records<T: Pod>(bytes: &[u8]) -> Vec<T> {
    bytes.chunks_exact(size_of::<T>()).map(bytemuck::pod_read_unaligned).collect()
}

/// Encodes links as steps.
fn steps<L: Copy>(matrix: &LinkMatrix<L>, split: impl Fn(L) -> (u32, u32)) -> Vec<u8> {
    let mut out = Vec::new();
    for row in matrix.iter() {
        let mut last = 0;
        for &link in row {
            let (sender, bits) = split(link);
            let step = (sender + 1 - last).min(u16::MAX as u32) as u16;
            last = sender + 1;
            out.extend(step.to_le_bytes());
            out.extend(bits.to_le_bytes());
        }
        out.extend([0; LINK]);
    }
    out
}

/// Decodes `rows` rows of senders below `senders` from steps, or every row for `usize::MAX`.
fn matrix<L: Copy>(bytes: &[u8], rows: usize, senders: usize, link: impl Fn(u32, u32) -> L) -> LinkMatrix<L> {
    let mut found = vec![Vec::new()];
    let mut next = 0u32;
    for part in bytes.chunks_exact(LINK) {
        let step = u16::from_le_bytes([part[0], part[1]]) as u32;
        let bits = u32::from_le_bytes([part[2], part[3], part[4], part[5]]);
        match (step, found.last_mut()) {
            (1.., Some(row)) if next + step <= senders as u32 => {
                next += step;
                row.push(link(next - 1, bits));
            }
            _ => {
                found.push(Vec::new());
                next = 0;
            }
        }
    }
    // The last row has an end marker, too.
    found.pop();
    if rows != usize::MAX {
        found.resize(rows, Vec::new());
    }
    LinkMatrix::from_rows(&found)
}

/// Damages one part, as bytes or in one word.
pub fn mutate(data: &mut [u8], size: usize, max_size: usize, seed: u32) -> usize {
    const ODD: [u32; 12] = [
        0,
        1,
        2,
        0x7fff_ffff,
        u32::MAX,
        0x7f80_0000,
        0x7fc0_0000,
        0xff80_0000,
        0x5863_5fa9,
        0x26901d7d,
        0x0000_0001,
        0x7149_f2ca,
    ];
    let mut random = Random::new(seed);
    let Some(mut contents) = Contents::from_bytes(&data[..size]) else {
        return libfuzzer_sys::fuzzer_mutate(data, size, max_size);
    };
    // Over a third of the mutations apply to the metadata and to the points.
    const OFTEN: [usize; 18] = [0, 0, 0, 0, 3, 3, 3, 1, 2, 4, 5, 6, 7, 8, 9, 10, 11, 12];
    let part = &mut contents.parts[OFTEN.get(random.below(OFTEN.len() + 1)).copied().unwrap_or(PARTS - 1)];
    match random.below(8) {
        0 if part.len() >= 4 => {
            let at = 4 * random.below(part.len() / 4);
            part[at..at + 4].copy_from_slice(&ODD[random.below(ODD.len())].to_le_bytes());
        }
        1 if part.len() >= 56 => {
            let (from, to) = (28 * random.below(part.len() / 28), 28 * random.below(part.len() / 28));
            part.copy_within(from..from + 28, to);
        }
        2 => contents.switches ^= 1 << random.below(5),
        _ => *part = mutated(part, part.len() + 64),
    }
    match put(&contents.to_bytes(), data, max_size) {
        Some(size) => size,
        None => libfuzzer_sys::fuzzer_mutate(data, size, max_size),
    }
}

/// Asserts the invariants of the viewer, including the lookups of its shaders.
pub fn keeps_promises(scene: &BakedScene) {
    for (i, row) in scene.links.iter().enumerate() {
        assert!(row.iter().all(|link| link.amount().is_finite()), "row {i}");
    }
    let strengths = scene.sources.strengths(None, &[]);
    assert_eq!(strengths.len(), scene.sources.count());
    assert!(scene.source_links.iter().flatten().all(|link| link.sender() < strengths.len()));
    assert!(from_sources(scene, &strengths).len() == scene.source_links.len());
    assert!(scene.solved_lights().is_none_or(|lights| lights.len() == scene.light_groups.groups.len()));
    if scene.is_for_environment() {
        let sky = [glam::Vec3::ONE; COUNT];
        let light = DistantLight { sky, all: sky, emission: vec![glam::Vec3::ONE; scene.sources.groups.len()] };
        let received = TransferField::new(scene).irradiance(&light);
        assert_eq!(received.len(), scene.points.len());
        assert!(received.iter().all(|own| own.direct.min_element() >= 0.0 && own.bounced.min_element() >= 0.0));
    }
    let groups = vec![glam::Vec3::ONE; scene.light_groups.groups.len()];
    let light = from_groups(scene, &groups);
    assert!(light.bounced.iter().chain(&light.direct).all(|e| e.is_finite() && e.min_element() >= 0.0));
    for i in 0..scene.points.len() {
        assert!(scene.push().row(i).iter().all(|entry| entry.point() < i && entry.weight() > 0.0));
        assert!(scene.cuts_of(i).len() <= 4);
        assert!(scene.points[i].normal().is_normalized() && scene.points[i].tint().is_finite());
    }
    for (i, _) in scene.meta.draws.iter().enumerate() {
        for instance in &scene.instances[scene.copies_of(i)] {
            let place = instance.local_from_model();
            assert!(place.is_finite() && place.inverse().is_finite() && place.matrix3.determinant() > 0.0);
        }
    }
    assert!(scene.triangles_placed() <= MAX_TRIANGLES);
    assert!(scene.indices.iter().all(|&i| (i as usize) < scene.vertices.len()));
    let lookup = &scene.relations.lookup;
    let mut reached = 0;
    for (l, level) in scene.meta.levels.iter().enumerate() {
        let range = level.first..level.first + level.count;
        for p in &scene.points[scene.level(l)] {
            let functions = lookup.functions(l, p.position());
            assert!(functions.iter().all(|j| range.contains(j)));
            reached += functions.len();
        }
    }
    assert!(reached >= scene.points.len(), "a function is not found where it is");
    for light in scene.meta.lights.iter().map(|light| light.source(scene.meta.origin)) {
        assert!(light.position.is_finite() && light.intensity.is_finite() && light.direction.is_normalized());
    }
    for frame in scene.meta.cameras.iter().map(|camera| camera.frame(scene.meta.origin)) {
        assert!(frame.eye.is_finite() && frame.direction(0.3, 0.7, 16, 9).is_normalized());
    }
    (0..scene.meta.textures.len())
        .for_each(|i| assert_eq!(scene.texture(i).len() as u64, scene.meta.textures[i].len));
}
