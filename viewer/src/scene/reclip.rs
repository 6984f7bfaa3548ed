//! Buffers of functions whose clip planes change with a motion: points, planes, parents and children.

use super::upload::Upload;
use crate::gpu::Gpu;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::radiosity::ClippedFunctions;
use rebounce_shared::rbn::bulk::Point;
use std::ops::Range;

/// What of the buffers is not the file's.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Reclipped {
    /// Points with other planes or samples, ascending.
    points: Vec<u32>,
    /// Whether parents and children are others.
    relations: bool,
}

/// Points that are written with those between them: writes are fewer.
const GAP: u32 = 1024;

/// Ranges that hold numbers, ascending, and few others.
fn ranges(numbers: &[u32]) -> impl Iterator<Item = Range<usize>> + '_ {
    let runs = numbers.chunk_by(|a, b| b - a <= GAP);
    runs.filter_map(|run| Some(*run.first()? as usize..*run.last()? as usize + 1))
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
        let now = Reclipped { points: functions.renewed.clone(), relations: functions.relations.is_some() };
        let mut numbers = [&before.points[..], &now.points].concat();
        numbers.sort_unstable();
        for range in ranges(&numbers) {
            let offset = (range.start * size_of::<Point>()) as u64;
            gpu.queue.write_buffer(&self.points, offset, bytemuck::cast_slice(&functions.points[range]));
        }
        let own = &functions.cuts[scene.cuts.len()..];
        if !own.is_empty() {
            let offset = size_of_val(&scene.cuts[..]) as u64;
            gpu.queue.write_buffer(&self.cuts, offset, bytemuck::cast_slice(own));
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_hold_all_numbers_and_no_long_gap() {
        let numbers = [3, 3, 4, 900, 2000, 5000, 5001];
        assert_eq!(ranges(&numbers).collect::<Vec<_>>(), [3..901, 2000..2001, 5000..5002]);
        assert_eq!(ranges(&[]).count(), 0);
    }
}
