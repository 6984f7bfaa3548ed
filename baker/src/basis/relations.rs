//! Parents and children (paper, section 2.1), in the form that the file stores.

use super::{Evaluator, Leveled, Support};
use crate::points::{PointLevel, Points};
use crate::watch::{Stopped, Watch};
use rayon::prelude::*;
use rebounce_shared::interpolation::{Entry, Rows, pack_row};

/// Who is whose parent and child.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Relations {
    /// Push rows, one per point: where each begins; and one past the end.
    pub push_offsets: Vec<u32>,
    /// A point's parents with their normalised weights at the point. Parents are of the next
    /// coarser level, or of the finest coarser one that covers the point; none at level 0 and
    /// where no coarser function reaches ("orphans").
    pub push_entries: Vec<Entry>,
    /// Pull rows, one per point of all sampled levels but the finest: where each begins.
    pub pull_offsets: Vec<u32>,
    /// A point's children with their weights.
    pub pull_entries: Vec<Entry>,
}

impl Relations {
    /// Finds the relations of points; those of `direct_levels` levels but the last get children. A unit of `watch` is
    /// a point.
    ///
    /// # Errors
    /// [`Stopped`].
    pub fn new(points: &Points, direct_levels: usize, watch: &dyn Watch) -> Result<Self, Stopped> {
        let mut relations = Self { push_offsets: vec![0], ..Self::default() };
        let mut coarser: Vec<Evaluator> = Vec::new();
        for (l, level) in points.levels.iter().enumerate() {
            let evaluator = evaluator(points, l);
            let leveled = Leveled::new(std::mem::take(&mut coarser));
            let rows: Vec<Vec<(u32, f32)>> = points.points[level.range()]
                .par_iter()
                .map(|p| {
                    watch.step(1)?;
                    let mut row = Vec::new();
                    leveled.interpolate(p.position, p.normal, &mut row);
                    Ok(row)
                })
                .collect::<Result<_, Stopped>>()?;
            for row in rows {
                pack_row(&row, &mut relations.push_entries);
                relations.push_offsets.push(relations.push_entries.len() as u32);
            }
            coarser = leveled.into_levels();
            coarser.push(evaluator);
        }
        relations.add_children(points, direct_levels);
        Ok(relations)
    }

    /// The push matrix.
    pub fn push(&self) -> Rows<'_> {
        Rows { offsets: &self.push_offsets, entries: &self.push_entries }
    }

    /// The pull rows are the push rows transposed, and sharpened: a child counts by the fourth power
    /// of its share, so that a point averages the direct light around it and not beyond its
    /// neighbours. Averaging with the plain shares and interpolating again would blur it twice.
    fn add_children(&mut self, points: &Points, direct_levels: usize) {
        let parents = points.count_on(direct_levels.saturating_sub(1));
        let mut children: Vec<Vec<(u32, f32)>> = vec![Vec::new(); parents];
        for j in 0..points.count_on(direct_levels) {
            let row = self.push().row(j);
            let total: f32 = row.iter().map(|e| e.weight()).sum();
            for entry in row {
                children[entry.point()].push((j as u32, (entry.weight() / total).powi(4)));
            }
        }
        self.pull_offsets.push(0);
        for row in children {
            pack_row(&row, &mut self.pull_entries);
            self.pull_offsets.push(self.pull_entries.len() as u32);
        }
    }
}

/// The evaluator of one level.
pub(crate) fn evaluator(points: &Points, level: usize) -> Evaluator {
    let level = &points.levels[level];
    with_supports(points, level, level.support_radius)
}

/// Support over disk radius of a function that takes what a ray finds: narrow, so that the direct
/// light at its point is blurred little and few functions share a hit.
const SENDER_OVERLAP: f32 = 1.25;

/// The evaluator of one level of senders.
pub(crate) fn sender_evaluator(points: &Points, level: usize) -> Evaluator {
    let level = &points.levels[level];
    with_supports(points, level, SENDER_OVERLAP * level.disk_radius)
}

fn with_supports(points: &Points, level: &PointLevel, radius: f32) -> Evaluator {
    let support = |i: usize| {
        let p = &points.points[i];
        Support { position: p.position, normal: p.normal, radius, cuts: points.cuts_of(i) }
    };
    Evaluator::new(level.range().map(support), level.first as u32)
}
