//! The bulk sections of a file, uploaded to GPU buffers in the file's layout.

use super::blended_fit;
use super::draw_batch::DrawBatch;
use super::fronts;
use super::ground;
use super::triangles::Triangles;
use crate::error::ViewerError;
use crate::gpu::bindings::{buffer, empty_buffer};
use crate::gpu::scope::Scope;
use crate::gpu::{Gpu, MAX_BINDING};
use rebounce_shared::baked::BakedScene;
#[cfg(feature = "radiosity")]
use rebounce_shared::interpolation::Entry;
use rebounce_shared::link::{Link, Sent};
use rebounce_shared::openness;
#[cfg(feature = "radiosity")]
use rebounce_shared::radiosity::clipping::{most_cuts, most_entries};
use rebounce_shared::rbn::LinkMatrix;
#[cfg(feature = "radiosity")]
use rebounce_shared::rbn::bulk::Cut;
use rebounce_shared::rbn::bulk::{Instance, Point};
use rebounce_shared::rbn::meta::{Alpha, Draw};
use std::collections::BinaryHeap;
use std::ops::Range;
use std::rc::Rc;
use wgpu::BufferUsages;

/// Bytes that WebGPU guarantees in one buffer.
pub const MAX_BUFFER: u64 = 256 << 20;

/// Links in one buffer: complete rows only.
pub struct Chunk {
    /// The links.
    pub links: wgpu::Buffer,
    /// Rows of the links.
    pub rows: Range<u32>,
    /// Index of the first link.
    pub first_link: u32,
}

/// A matrix of links.
pub struct LinkBuffers {
    /// Offset of the first link of each row, and the end of the last row.
    pub offsets: wgpu::Buffer,
    /// Links, in the number of buffers that the binding limit needs.
    pub chunks: Vec<Chunk>,
}

/// The scene's sections on the GPU.
pub struct Upload {
    own: Scope,
    /// Section `VERT`.
    pub vertices: wgpu::Buffer,
    /// Section `INDX`, with the winding of front faces turned counterclockwise ([`fronts`]).
    pub indices: wgpu::Buffer,
    /// The identity instance for draw calls without copies, then section `INST`.
    pub instances: wgpu::Buffer,
    /// Section `PNTS`.
    pub points: wgpu::Buffer,
    /// Section `CUTS`.
    pub cuts: wgpu::Buffer,
    /// Gain of each function's irradiance with detail: section `OPEN` by
    /// [`rebounce_shared::openness::gain`].
    pub gains: wgpu::Buffer,
    /// Candidate functions by place ([`rebounce_shared::basis::Lookup`]).
    pub lookup: wgpu::Buffer,
    /// By reconstruction group, the matrix from where it is to where the file has it: at_rest.wgsl.
    #[cfg(feature = "radiosity")]
    pub rest: wgpu::Buffer,
    /// Zero texel for scenes without a rig: rest_pixel.wgsl.
    #[cfg(feature = "radiosity")]
    pub no_rest: wgpu::TextureView,
    /// Offsets of the push rows.
    pub push_offsets: wgpu::Buffer,
    /// Entries of the push rows.
    pub push_entries: wgpu::Buffer,
    /// Offsets of the pull rows.
    pub pull_offsets: wgpu::Buffer,
    /// Entries of the pull rows.
    pub pull_entries: wgpu::Buffer,
    /// Section `LINK`.
    pub links: LinkBuffers,
    /// Section `LATL`.
    pub later: LinkBuffers,
    /// Section `SRCL`, if present.
    pub source_links: Option<LinkBuffers>,
    /// Draw calls by material, opaque draw calls first; blended materials excluded.
    pub runs: Vec<DrawBatch>,
    /// Draw calls of blended materials.
    pub blended_runs: Vec<DrawBatch>,
    /// Number of layers of the blended draw calls: see [`blended_fit::layers`].
    pub blended_layers: u32,
    /// Whether the blended layers have colours: see [`blended_fit::are_tinted`].
    pub tinted: bool,
    /// Draw calls for shadow maps, without glass: neighbouring opaque runs are merged, as the material does not
    /// matter.
    pub shadow_runs: Vec<DrawBatch>,
    /// Draw calls of glass.
    pub glass_runs: Vec<DrawBatch>,
    /// The ground under an object: see [`ground::uniform`].
    pub ground: wgpu::Buffer,
    /// All triangles, on the CPU.
    pub triangles: Rc<Triangles>,
}

impl Upload {
    /// Uploads every section except textures.
    ///
    /// # Errors
    /// [`ViewerError::TooLarge`] when a section is larger than the limit of its buffer; no section is uploaded
    /// then.
    pub fn new(gpu: &Gpu, scene: &BakedScene) -> Result<Self, ViewerError> {
        let most = Most::of(gpu.buffer_limits());
        most.check(scene)?;
        #[cfg(feature = "radiosity")]
        most.check_rig(scene)?;
        let own = Scope::new(gpu);
        let section = |name, usage, content: &[u8]| buffer(&own, name, usage, content);
        let stored = |name, content: &[u8]| section(name, BufferUsages::STORAGE, content);
        let cast = bytemuck::cast_slice::<u32, u8>;
        // Large enough for what a motion brings.
        let [cuts, push, pull] = room(scene);
        let roomy = |name, content: &[u8], bytes: usize| {
            let buffer = empty_buffer(
                &own,
                name,
                BufferUsages::STORAGE | BufferUsages::COPY_DST,
                content.len().max(bytes) as u64,
            );
            if !content.is_empty() {
                gpu.queue.write_buffer(&buffer, 0, content);
            }
            buffer
        };
        let (mut runs, relations) = (runs(scene), &scene.relations);
        let gains: Vec<f32> = scene.openness.iter().copied().map(openness::gain).collect();
        let instances = [&[Instance::IDENTITY], &scene.instances[..]].concat();
        let shadow_runs = merged(&runs);
        let indices = fronts::indices(scene, &runs);
        let all_runs = runs.clone();
        let blended_runs = runs.split_off(runs.iter().take_while(|run| !run.blended).count());
        Ok(Self {
            ground: ground::uniform(&own, &scene.meta.shown.ground),
            links: matrix(stored, "LINK", &scene.links, most.binding),
            // Where points have values, those of the sources are among them.
            source_links: (!scene.source_links.is_empty() && !scene.is_precomputed())
                .then(|| matrix(stored, "SRCL", &scene.source_links, most.binding)),
            // One buffer: coarse points have few links.
            later: matrix(stored, "LATL", &scene.later, u64::MAX),
            vertices: section("VERT", vertex_usage(scene), bytemuck::cast_slice(&scene.vertices)),
            indices: section("INDX", BufferUsages::INDEX, cast(&indices)),
            instances: section("INST", BufferUsages::VERTEX, bytemuck::cast_slice(&instances)),
            // A rig begins with them.
            #[cfg(feature = "radiosity")]
            points: section(
                "PNTS",
                BufferUsages::STORAGE | BufferUsages::COPY_SRC,
                bytemuck::cast_slice(&scene.points),
            ),
            #[cfg(not(feature = "radiosity"))]
            points: stored("PNTS", bytemuck::cast_slice(&scene.points)),
            cuts: roomy("CUTS", bytemuck::cast_slice(&scene.cuts), cuts),
            gains: stored("OPEN", bytemuck::cast_slice(&gains)),
            lookup: stored("PNTS", cast(&relations.lookup.words)),
            #[cfg(feature = "radiosity")]
            rest: section(
                "RGRP",
                BufferUsages::UNIFORM,
                bytemuck::cast_slice(&[Instance::IDENTITY; rebounce_shared::rbn::groups::MAX_GROUPS + 1]),
            ),
            #[cfg(feature = "radiosity")]
            no_rest: super::rest_picture::rest_picture(&own, [1, 1]),
            push_offsets: stored("PNTS", cast(&relations.push_offsets)),
            push_entries: roomy("PNTS", bytemuck::cast_slice(&relations.push_entries), push),
            pull_offsets: stored("PNTS", cast(&relations.pull_offsets)),
            pull_entries: roomy("PNTS", bytemuck::cast_slice(&relations.pull_entries), pull),
            blended_layers: blended_fit::layers(scene, &blended_runs),
            tinted: blended_fit::are_tinted(&scene.meta, &blended_runs),
            glass_runs: blended_runs.iter().filter(|run| run.glass).cloned().collect(),
            runs,
            blended_runs,
            shadow_runs,
            triangles: Triangles::new(&scene.vertices, indices.into_owned(), instances, all_runs).into(),
            own,
        })
    }

    /// Binds the vertex, instance and index buffers of [`DrawBatch`]es.
    pub fn bind(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_vertex_buffer(1, self.instances.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.own.bytes()
    }
}

/// Usage of the vertices: shaders write those that deform.
#[cfg(feature = "radiosity")]
fn vertex_usage(scene: &BakedScene) -> BufferUsages {
    match scene.rig.is_empty() {
        true => BufferUsages::VERTEX,
        false => BufferUsages::VERTEX | BufferUsages::STORAGE,
    }
}

/// Without radiosity nothing deforms.
#[cfg(not(feature = "radiosity"))]
fn vertex_usage(_: &BakedScene) -> BufferUsages {
    BufferUsages::VERTEX
}

/// Bytes that planes, parents and children of a scene need, whatever moves; none beyond the file's where nothing can.
#[cfg(feature = "radiosity")]
fn room(scene: &BakedScene) -> [usize; 3] {
    if scene.groups.nodes.is_empty() {
        return [0; 3];
    }
    let most = most_entries(scene);
    [most_cuts(scene) * size_of::<Cut>(), most.push * size_of::<Entry>(), most.pull * size_of::<Entry>()]
}

/// Without radiosity nothing moves.
#[cfg(not(feature = "radiosity"))]
fn room(_: &BakedScene) -> [usize; 3] {
    [0; 3]
}

/// Size limits of a device, bytes.
struct Most {
    /// Of a buffer.
    buffer: u64,
    /// Of a storage binding.
    binding: u64,
}

impl Most {
    /// The device's limits, capped at WebGPU's guarantees: a scene that opens on this device opens on any device.
    fn of([buffer, binding]: [u64; 2]) -> Self {
        let buffer = buffer.min(MAX_BUFFER);
        Self { buffer, binding: binding.min(MAX_BINDING).min(buffer) }
    }

    /// Checks the size of every section, before the first upload.
    fn check(&self, scene: &BakedScene) -> Result<(), ViewerError> {
        let relations = &scene.relations;
        let longest = scene.links.offsets.windows(2).map(|row| row[1] - row[0]).max().unwrap_or(0);
        let sections = [
            ("VERT", self.buffer, size_of_val(&scene.vertices[..])),
            ("INDX", self.buffer, size_of_val(&scene.indices[..])),
            ("INST", self.buffer, (scene.instances.len() + 1) * size_of::<Instance>()),
            // Light at a point needs four floats.
            ("PNTS", self.binding, scene.points.len() * size_of::<Point>().max(16)),
            ("PNTS", self.binding, size_of_val(&relations.lookup.words[..])),
            ("PNTS", self.binding, size_of_val(&relations.push_offsets[..])),
            ("PNTS", self.binding, size_of_val(&relations.push_entries[..])),
            ("PNTS", self.binding, size_of_val(&relations.pull_offsets[..])),
            ("PNTS", self.binding, size_of_val(&relations.pull_entries[..])),
            ("CUTS", self.binding, size_of_val(&scene.cuts[..])),
            // A row is never split.
            ("LINK", self.binding, longest as usize * size_of::<Link>()),
            ("LINK", self.binding, size_of_val(&scene.links.offsets[..])),
            ("SRCL", self.binding, size_of_val(&scene.source_links.offsets[..])),
            ("LATL", self.binding, size_of_val(&scene.later.links[..])),
            ("LATL", self.binding, size_of_val(&scene.later.offsets[..])),
        ];
        for (section, limit, bytes) in sections {
            let bytes = bytes as u64;
            if bytes > limit {
                return Err(ViewerError::TooLarge { section, bytes, limit });
            }
        }
        Ok(())
    }
}

#[cfg(feature = "radiosity")]
impl Most {
    /// Checks the size of what shaders read and write of a rig.
    fn check_rig(&self, scene: &BakedScene) -> Result<(), ViewerError> {
        let rig = &scene.rig;
        if rig.is_empty() {
            return Ok(());
        }
        let sections = [
            ("VERT", size_of_val(&scene.vertices[..])),
            ("RIGV", size_of_val(&rig.vertices[..])),
            ("RIGM", size_of_val(&rig.deltas[..])),
            ("RIGP", size_of_val(&rig.points[..])),
        ];
        let too_large = sections.into_iter().find(|(_, bytes)| *bytes as u64 > self.binding);
        too_large.map_or(Ok(()), |(section, bytes)| {
            Err(ViewerError::TooLarge { section, bytes: bytes as u64, limit: self.binding })
        })
    }
}

/// Uploads a matrix in chunks of at most `limit` bytes of links.
fn matrix<L: Sent + bytemuck::Pod>(
    stored: impl Fn(&'static str, &[u8]) -> wgpu::Buffer,
    name: &'static str,
    matrix: &LinkMatrix<L>,
    limit: u64,
) -> LinkBuffers {
    let part = |rows: Range<u32>| {
        let [first, end] = [rows.start, rows.end].map(|row| matrix.offsets[row as usize]);
        let links = stored(name, bytemuck::cast_slice(&matrix.links[first as usize..end as usize]));
        Chunk { links, rows, first_link: first }
    };
    let chunks = chunks(&matrix.offsets, limit / size_of::<L>() as u64).into_iter().map(part).collect();
    LinkBuffers { offsets: stored(name, bytemuck::cast_slice(&matrix.offsets)), chunks }
}

/// Splits the rows into chunks of at most `most` links. A longer row stays whole; [`Most::check`] refuses that row.
fn chunks(offsets: &[u32], most: u64) -> Vec<Range<u32>> {
    let rows = offsets.len().saturating_sub(1);
    let mut out = Vec::new();
    let mut start = 0;
    for row in 0..rows {
        if row > start && (offsets[row + 1] - offsets[start]) as u64 > most {
            out.push(start as u32..row as u32);
            start = row;
        }
    }
    if rows > start {
        out.push(start as u32..rows as u32);
    }
    out
}

/// Draw calls in sorted order: opaque first, then alpha-tested, blended last; within these groups, one-sided calls
/// and equal materials are adjacent.
fn runs(scene: &BakedScene) -> Vec<DrawBatch> {
    let run = |(number, d): (usize, &Draw)| {
        let instances = match scene.copies_of(number) {
            copies if copies.is_empty() => 0..1,
            copies => copies.start as u32 + 1..copies.end as u32 + 1,
        };
        let material = &scene.meta.materials[d.material as usize];
        let blended = blended_fit::is_blended(&scene.meta, material);
        DrawBatch {
            material: d.material,
            indices: d.first_index..d.first_index + d.index_count,
            instances,
            cut: blended || matches!(material.alpha, Alpha::Mask { .. }),
            blended,
            glass: material.is_glass(),
            one_sided: !material.double_sided,
        }
    };
    let draws = scene.meta.draws.iter().enumerate().filter(|(_, d)| d.index_count > 0);
    sorted(&draws.map(run).collect::<Vec<_>>(), |run| {
        (run.cut, run.blended, run.one_sided, run.material, run.indices.start)
    })
}

/// Sort key of runs.
type Order = (bool, bool, bool, u32, u32);

/// Sorts runs by a key, through a heap: a tenth of the code of the standard sort.
fn sorted(runs: &[DrawBatch], order: fn(&DrawBatch) -> Order) -> Vec<DrawBatch> {
    let keys: BinaryHeap<_> = runs.iter().map(order).zip(0..).collect();
    keys.into_sorted_vec().into_iter().map(|(_, i): (_, usize)| runs[i].clone()).collect()
}

/// Draws the same triangles in fewer runs: opaque neighbours in the index buffer are merged if their instances are
/// equal.
fn merged(runs: &[DrawBatch]) -> Vec<DrawBatch> {
    let opaque: Vec<_> = runs.iter().filter(|r| !r.cut).cloned().collect();
    let mut out: Vec<DrawBatch> = Vec::new();
    for run in sorted(&opaque, |run| (false, false, false, 0, run.indices.start)) {
        match out.last_mut() {
            Some(last) if last.indices.end == run.indices.start && last.instances == run.instances => {
                last.indices.end = run.indices.end
            }
            _ => out.push(run),
        }
    }
    out.extend(runs.iter().filter(|r| r.cut && !r.glass).cloned());
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::draw_batch::instances;
    use rebounce_shared::rbn::bulk::Copies;
    use rebounce_shared::rbn::meta::Material;

    #[test]
    fn chunks_hold_every_row_once_and_fit() {
        let offsets: Vec<u32> = (0..21).map(|i| i * 5).collect();
        let chunks = chunks(&offsets, 12);
        assert_eq!(chunks.len(), 10);
        assert_eq!(chunks[0].start, 0);
        assert_eq!(chunks[9].end, 20);
        for pair in chunks.windows(2) {
            assert_eq!(pair[0].end, pair[1].start);
        }
    }

    #[cfg(feature = "radiosity")]
    #[test]
    fn a_rig_must_fit_bindings() {
        use rebounce_shared::rig::{MorphDelta, RigMesh};
        let mut scene = BakedScene { vertices: vec![Default::default(); 10], ..BakedScene::default() };
        let most = Most { buffer: 1000, binding: 239 };
        assert!(most.check_rig(&scene).is_ok(), "nothing deforms");
        scene.rig.layout.meshes = vec![RigMesh::default()];
        assert!(most.check_rig(&scene).unwrap_err().to_string().contains("VERT"));
        scene.vertices.pop();
        assert!(most.check_rig(&scene).is_ok());
        scene.rig.deltas = vec![MorphDelta::default(); 10];
        assert!(most.check_rig(&scene).unwrap_err().to_string().contains("RIGM"));
    }

    #[test]
    fn what_is_too_large_is_told_with_both_numbers() {
        let mut scene = BakedScene { vertices: vec![Default::default(); 10], ..BakedScene::default() };
        scene.links.offsets = vec![0, 3, 4];
        let refusal =
            |buffer: u64, binding: u64, scene: &BakedScene| match (Most { buffer, binding }).check(scene) {
                Err(ViewerError::TooLarge { section, bytes, limit }) => Some((section, bytes, limit)),
                other => other.map(|()| None).unwrap(),
            };
        assert_eq!(refusal(240, 12, &scene), None);
        assert_eq!(refusal(239, 12, &scene), Some(("VERT", 240, 239)));
        // A row of three links is not split; neither are the rows' offsets.
        assert_eq!(refusal(240, 11, &scene), Some(("LINK", 12, 11)));
        let text = ViewerError::TooLarge { section: "VERT", bytes: 240, limit: 239 }.to_string();
        assert!(text.contains("240 bytes") && text.contains("239"), "{text}");
        let default = Most::of([u64::MAX; 2]);
        assert_eq!((default.buffer, default.binding), (MAX_BUFFER, MAX_BINDING));
    }

    #[test]
    fn copies_keep_to_their_own_runs() {
        let mut scene = BakedScene::default();
        scene.meta.materials = vec![Material::default(), Material::default()];
        let draw = |material: u32, k: u32| Draw { material, first_index: 3 * k, index_count: 3 };
        scene.meta.draws = vec![draw(0, 0), draw(1, 1), draw(0, 2), draw(1, 3), draw(0, 4)];
        let [alone, two, three] = [(0, 0), (0, 2), (2, 3)].map(|(first, count)| Copies { first, count });
        scene.copies = vec![alone, alone, two, two, three];
        scene.instances = vec![Instance::IDENTITY; 5];
        let runs = runs(&scene);
        let of = |run: &DrawBatch| (run.indices.clone(), run.instances.clone());
        assert_eq!(
            runs.iter().map(of).collect::<Vec<_>>(),
            [(0..3, 0..1), (6..9, 1..3), (12..15, 3..6), (3..6, 0..1), (9..12, 1..3),]
        );
        assert_eq!(
            merged(&runs).iter().map(of).collect::<Vec<_>>(),
            [(0..6, 0..1), (6..12, 1..3), (12..15, 3..6)]
        );
        assert_eq!(instances(&scene, &runs[0]), [Instance::IDENTITY]);
        assert_eq!(instances(&scene, &runs[2]).len(), 3);
    }

    #[test]
    fn shadows_draw_the_same_triangles() {
        let mut scene = BakedScene::default();
        scene.meta.materials = vec![
            Material::default(),
            Material { alpha: Alpha::Blend, ..Default::default() },
            Material::default(),
        ];
        scene.meta.draws = vec![
            Draw { material: 2, first_index: 0, index_count: 30 },
            Draw { material: 1, first_index: 60, index_count: 3 },
            Draw { material: 0, first_index: 30, index_count: 30 },
        ];
        let runs = runs(&scene);
        assert_eq!(runs.iter().map(|r| r.material).collect::<Vec<_>>(), [0, 2, 1]);
        let shadows = merged(&runs);
        assert_eq!(shadows.len(), 2);
        assert_eq!((shadows[0].indices.clone(), shadows[0].cut), (0..60, false));
        assert_eq!((shadows[1].indices.clone(), shadows[1].cut), (60..63, true));
    }
}
