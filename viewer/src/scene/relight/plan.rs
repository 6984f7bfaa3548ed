//! The dispatches of a frame of relighting.

use super::Parts;
use crate::gpu::bindings::{WORKGROUP, grid};
use crate::scene::upload::{LinkBuffers, Upload};
use bytemuck::{Pod, Zeroable};
use rebounce_shared::baked::BakedScene;
use std::ops::Range;

/// Stride of steps in the uniform buffer, bytes.
pub(super) const STRIDE: u64 = 256;
/// Threads that measure the [level](rebounce_shared::exposure::level) of the light: `LEVELS` of key.wgsl.
pub(super) const LEVEL_THREADS: u32 = 512;

/// Average number of links of a row below which a single thread processes the row.
const SHORT: usize = 16;

/// `Step` of the shaders (step.wgsl): parameters of a dispatch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Step {
    first: u32,
    pub(super) count: u32,
    extra: u32,
    /// Threads of the grid in x; for shared rows, workgroups in x.
    threads: u32,
    /// 1 if the scene has normal maps.
    tilts: u32,
    pad: [u32; 3],
}

impl Step {
    /// With flags of join.wgsl.
    pub(super) fn with_parts(self, parts: Parts) -> Self {
        let extra = u32::from(parts.bounced) | u32::from(parts.from_sources) << 1 | self.tilts << 2;
        Self { extra, ..self }
    }
}

/// Shader of a dispatch; kernels over links have a chunk index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kernel {
    Direct,
    Pull,
    Send,
    /// Several threads share a row.
    Transport(usize),
    /// One thread per row.
    Short(usize),
    Bounce,
    Lift,
    Level,
    /// Light straight from the sources.
    Sources(usize),
    /// Adds it to the direct light; or light of a fixed solution.
    Join,
    /// Adds it to what is displayed.
    Show,
}

#[cfg(feature = "radiosity")]
impl Kernel {
    /// Whether it computes bounced light from links, or shows it.
    pub(super) fn is_bounced(self) -> bool {
        use Kernel::{Bounce, Lift, Send, Short, Show, Transport};
        matches!(self, Send | Transport(_) | Short(_) | Bounce | Lift | Show)
    }
}

/// One dispatch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Dispatch {
    pub(super) kernel: Kernel,
    pub(super) step: Step,
    pub(super) groups: [u32; 2],
}

impl Dispatch {
    /// One thread for each of `count` elements.
    pub(super) fn threads(kernel: Kernel, first: usize, count: usize) -> Self {
        let groups = grid((count as u32).div_ceil(WORKGROUP));
        let step = Step {
            first: first as u32,
            count: count as u32,
            threads: groups[0] * WORKGROUP,
            ..Step::default()
        };
        Self { kernel, step, groups }
    }

    /// `lanes` threads per row.
    pub(super) fn lanes(kernel: Kernel, step: Step, lanes: u32) -> Self {
        let groups = grid(step.count.div_ceil(WORKGROUP / lanes));
        Self { kernel, step: Step { threads: groups[0], ..step }, groups }
    }
}

/// All dispatches of a frame, in order.
pub(super) fn plan(scene: &BakedScene, upload: &Upload, lanes: u32) -> Vec<Dispatch> {
    let level = |kernel, l: usize| Dispatch::threads(kernel, scene.level(l).start, scene.level(l).len());
    // Computes the irradiance of the points of the first `levels` levels, from links and parents.
    let transport = |plan: &mut Vec<Dispatch>, levels: u32| {
        for l in 0..levels as usize {
            let level = scene.level(l);
            let links = scene.links.offsets[level.end] - scene.links.offsets[level.start];
            let is_short = (links as usize) < SHORT * level.len();
            if is_short {
                push_rows(plan, &upload.links, level, Kernel::Short, 1);
            } else {
                push_rows(plan, &upload.links, level, Kernel::Transport, lanes);
            }
        }
    };
    let mut plan = Vec::new();
    if let Some(links) = &upload.source_links {
        for l in 0..scene.meta.levels.len() {
            push_rows(&mut plan, links, scene.level(l), Kernel::Sources, lanes);
        }
    }
    plan.push(Dispatch::threads(Kernel::Direct, 0, scene.direct_count()));
    // Points with values have no links, and a scene for radiosity neither.
    let (mut senders, mut coarse, mut levels) =
        (scene.sender_count(), scene.later_count(), scene.meta.levels.len());
    if scene.is_precomputed() || scene.is_unlinked() {
        (senders, coarse, levels) = (0, 0, 0);
    }
    if upload.source_links.is_some() || scene.is_precomputed() {
        plan.push(Dispatch::threads(Kernel::Join, 0, scene.direct_count()));
    }
    let send = Dispatch::threads(Kernel::Send, 0, senders);
    plan.extend(
        (0..(scene.meta.direct_levels as usize).saturating_sub(1)).rev().map(|l| level(Kernel::Pull, l)),
    );
    plan.push(send);
    if coarse > 0 {
        transport(&mut plan, scene.meta.later_levels);
        let step = Step { count: coarse as u32, ..Step::default() };
        plan.push(Dispatch::lanes(Kernel::Bounce, step, lanes));
        let finer = scene.meta.later_levels as usize..scene.meta.sender_levels as usize;
        plan.extend(finer.map(|l| level(Kernel::Lift, l)));
        plan.push(send);
    }
    transport(&mut plan, levels as u32);
    if upload.source_links.is_some() {
        plan.push(Dispatch::threads(Kernel::Show, 0, scene.points.len()));
    }
    plan.push(measure(scene));
    plan.retain(|dispatch| dispatch.step.count > 0);
    let bumpy = scene.meta.is_bumpy();
    for dispatch in &mut plan {
        dispatch.step.tilts = bumpy as u32;
        match dispatch.kernel {
            // Direct light has no tilts.
            Kernel::Join => dispatch.step = Step { tilts: 0, ..dispatch.step }.with_parts(Parts::ALL),
            Kernel::Show => dispatch.step = dispatch.step.with_parts(Parts::ALL),
            _ => {}
        }
    }
    plan
}

/// Appends dispatches over the rows of a level, chunk by chunk.
fn push_rows(
    plan: &mut Vec<Dispatch>,
    links: &LinkBuffers,
    level: Range<usize>,
    kernel: fn(usize) -> Kernel,
    lanes: u32,
) {
    for (i, chunk) in links.chunks.iter().enumerate() {
        let first = chunk.rows.start.max(level.start as u32);
        let end = chunk.rows.end.min(level.end as u32);
        let count = end.saturating_sub(first);
        let step = Step { first, count, extra: chunk.first_link, ..Step::default() };
        plan.push(Dispatch::lanes(kernel(i), step, lanes));
    }
}

/// Measures the light level at the finest senders, which are spread evenly over all surfaces of the light
/// transport.
fn measure(scene: &BakedScene) -> Dispatch {
    let senders = (scene.meta.sender_levels as usize).checked_sub(1).map_or(0..0, |l| scene.level(l));
    let step = Step {
        first: senders.start as u32,
        count: senders.len() as u32,
        threads: LEVEL_THREADS,
        ..Step::default()
    };
    Dispatch { kernel: Kernel::Level, step, groups: [LEVEL_THREADS / WORKGROUP, 1] }
}
