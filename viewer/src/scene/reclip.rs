//! Buffers of functions whose clip planes change with a motion: points, planes, parents and children.

use super::upload::Upload;
use crate::gpu::Gpu;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::interpolation::Entry;
use rebounce_shared::radiosity::ClippedFunctions;
use rebounce_shared::radiosity::clipping::{most_cuts, most_entries};
use rebounce_shared::rbn::bulk::Cut;

/// Bytes that planes, parents and children of a scene need, whatever moves; none beyond the file's where nothing can.
pub(super) fn room(scene: &BakedScene) -> [usize; 3] {
    if scene.groups.nodes.is_empty() {
        return [0; 3];
    }
    let most = most_entries(scene);
    [most_cuts(scene) * size_of::<Cut>(), most.push * size_of::<Entry>(), most.pull * size_of::<Entry>()]
}

/// What of the buffers is not the file's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reclipped {
    /// Points have other planes or samples.
    points: bool,
    /// So have parents and children.
    relations: bool,
}

impl Upload {
    /// Writes the functions of a scene whose groups have moved, as far as they differ from the file's, or differed before.
    pub(super) fn reclip(
        &self,
        gpu: &Gpu,
        scene: &BakedScene,
        functions: &ClippedFunctions,
        before: &mut Reclipped,
    ) {
        let now =
            Reclipped { points: !functions.renewed.is_empty(), relations: functions.relations.is_some() };
        if now.points || before.points {
            gpu.queue.write_buffer(&self.points, 0, bytemuck::cast_slice(&functions.points));
            let first = scene.cuts.len();
            let offset = (first * size_of::<Cut>()) as u64;
            gpu.queue.write_buffer(&self.cuts, offset, bytemuck::cast_slice(&functions.cuts[first..]));
        }
        if now.relations || before.relations {
            let relations = functions.relations.as_ref().unwrap_or(&scene.relations);
            for (buffer, words) in [
                (&self.push_offsets, &relations.push_offsets[..]),
                (&self.push_entries, bytemuck::cast_slice(&relations.push_entries)),
                (&self.pull_offsets, &relations.pull_offsets[..]),
                (&self.pull_entries, bytemuck::cast_slice(&relations.pull_entries)),
            ] {
                gpu.queue.write_buffer(buffer, 0, bytemuck::cast_slice(words));
            }
        }
        *before = now;
    }
}
