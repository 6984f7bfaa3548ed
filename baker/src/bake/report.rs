//! Results and cost of a bake: the columns of the paper's Table 1 and the file's sections.

use super::BakeSettings;
use super::tracker::StageTraffic;
use crate::job::communicator::share::Traffic;
use crate::sampling::Points;
use crate::scene::Scene;
use crate::transport::Operator;
use crate::transport::environment::TransferReport;
use crate::transport::gloss::GlossReport;
use crate::transport::sources::SourceLinks;
use crate::verify::compare::uncertainty::ErrorEstimate;
use rebounce_shared::rbn::container::Section;
use serde::Serialize;
use std::fmt;

/// Figures of a bake; `--report FILE.json` writes them.
#[derive(Clone, Debug, Default, Serialize)]
pub struct BakeReport {
    /// The scene's name.
    pub scene: String,
    /// The preset's name.
    pub preset: String,
    /// Error against a path tracer that the preset promises.
    pub promised_error: f64,
    /// Measured error; `None` if not requested ([`super::judge`]) or hidden by noise.
    pub measured_error: Option<f64>,
    /// Lower bound of the measured error's interval.
    pub measured_error_at_least: Option<f64>,
    /// Upper bound of the measured error's interval.
    pub measured_error_at_most: Option<f64>,
    /// Triangles of the scene; a model counts once.
    pub triangles: u64,
    /// Instances of models; a model is kept in memory once.
    pub instances: u64,
    /// Triangles placed in the scene; a model counts once per instance.
    pub placed_triangles: u64,
    /// Triangles for rays, after [simplifying](crate::geometry::simplify); a model counts once.
    pub ray_triangles: u64,
    /// Start positions of importance particles, world space.
    pub viewpoints: Vec<[f64; 3]>,
    /// Whether importance particles also start from the sky: the scene is an object or a landscape, no room.
    pub is_open: bool,
    /// Whether a lamp was added to the file because the scene has no light.
    pub lamp_added: bool,
    /// Whether a camera was added to the file because the scene has no camera.
    pub camera_added: bool,
    /// Position of the file's first camera, world space.
    pub camera: [f64; 3],
    /// Whether no light, in its initial state, reaches any surface with functions.
    pub is_unlit: bool,
    /// Levels of points, coarsest first.
    pub levels: Vec<LevelReport>,
    /// Basis functions on all levels.
    pub functions: u64,
    /// Levels of senders.
    pub sender_levels: u64,
    /// Link threshold ε, a share of `reflected`.
    pub epsilon: f32,
    /// Share of light that the scene's surfaces reflect to each other.
    pub reflected: f32,
    /// Links kept.
    pub links: u64,
    /// Links kept for later bounces.
    pub later_links: u64,
    /// Entries of the rows between coarse points, from which later links are made.
    pub coarse_entries: u64,
    /// Number of senders times number of receivers.
    pub potential_links: u64,
    /// Ratio of links kept to potential links.
    pub link_share: f64,
    /// Rays cast for the operator.
    pub rays: u64,
    /// Whether points have links from the sky.
    pub has_sky: bool,
    /// Names of the groups of emissive surfaces.
    pub emissive_groups: Vec<String>,
    /// Links from the sky and from emissive surfaces.
    pub source_links: u64,
    /// Rays cast for them.
    pub source_rays: u64,
    /// Glossy transfer.
    pub gloss: GlossReport,
    /// Transfer from the environment, where the file is for one.
    pub transfer: Option<TransferReport>,
    /// Bounces in the operator.
    pub bounces: u32,
    /// Share of the reflected light that no sender covers.
    pub lost_share: f64,
    /// Share of the reflected light lost in links per bounce; negative if links add light.
    pub link_loss: f64,
    /// Seconds of each stage, in order.
    pub seconds: Vec<(String, f64)>,
    /// Number of processes of the bake.
    pub processes: u64,
    /// Traffic between processes; empty for one process.
    pub traffic: Vec<TrafficReport>,
    /// Peak memory of the process, bytes; 0 if unknown to the system.
    pub peak_memory_bytes: u64,
    /// The file's sections.
    pub sections: Vec<SectionReport>,
    /// The file's length, bytes.
    pub file_bytes: u64,
}

/// Figures of one level of points.
#[derive(Clone, Debug, Default, Serialize)]
pub struct LevelReport {
    /// Basis functions.
    pub functions: u64,
    /// Receivers with links, of these functions.
    pub receivers: u64,
    /// Links kept.
    pub links: u64,
    /// Poisson-disk radius, scene units.
    pub disk_radius: f32,
}

/// Traffic between the processes of a bake in one part of the bake.
#[derive(Clone, Debug, Default, Serialize)]
pub struct TrafficReport {
    /// Stage of the bake.
    pub stage: String,
    /// Level of points; `None` for stages without levels.
    pub level: Option<usize>,
    /// Bytes received by process 0 for the file.
    pub to_first: u64,
    /// Bytes received by every process for the following stages, including its own.
    pub to_all: u64,
}

/// Figures of one section of the file.
#[derive(Clone, Debug, Default, Serialize)]
pub struct SectionReport {
    /// Section name, four letters.
    pub name: String,
    /// Length of the section, bytes.
    pub bytes: u64,
}

impl BakeReport {
    pub(super) fn new(scene: &Scene, settings: &BakeSettings) -> Self {
        Self {
            scene: scene.name.clone(),
            preset: settings.preset.name().to_owned(),
            promised_error: settings.preset.promised_error(),
            triangles: scene.triangles.len() as u64,
            instances: scene.instances() as u64,
            placed_triangles: scene.triangles_placed(),
            sender_levels: settings.operator.sender_levels as u64,
            epsilon: settings.operator.epsilon,
            ..Self::default()
        }
    }

    pub(super) fn describe(&mut self, points: &Points, operator: &Operator, settings: &BakeSettings) {
        self.reflected = operator.reflected;
        let counts: Vec<usize> = operator.link_counts().collect();
        self.levels = points
            .levels
            .iter()
            .map(|level| {
                let rows = &counts[level.range()];
                LevelReport {
                    functions: level.count as u64,
                    receivers: rows.iter().filter(|links| **links > 0).count() as u64,
                    links: rows.iter().map(|links| *links as u64).sum(),
                    disk_radius: level.disk_radius,
                }
            })
            .collect();
        self.functions = points.points.len() as u64;
        let senders: u64 =
            self.levels.iter().take(settings.operator.sender_levels).map(|level| level.functions).sum();
        self.links = self.levels.iter().map(|level| level.links).sum();
        self.later_links = operator.later_count() as u64;
        self.coarse_entries = operator.coarse_count() as u64;
        self.potential_links = senders * self.functions;
        self.link_share = self.links as f64 / self.potential_links.max(1) as f64;
        self.rays = operator.rays;
        self.bounces = operator.bounces;
        self.lost_share = operator.lost_share;
        self.link_loss = operator.link_loss;
    }

    pub(super) fn describe_sources(&mut self, found: &SourceLinks) {
        self.has_sky = found.sources.has_sky;
        self.emissive_groups = found.sources.groups.iter().map(|group| group.name.clone()).collect();
        self.source_links = found.links.iter().map(|row| row.len() as u64).sum();
        self.source_rays = found.rays;
    }

    pub(super) fn add_traffic(&mut self, (stage, level, traffic): StageTraffic) {
        let Traffic { to_first, to_all } = traffic;
        if self.processes > 1 {
            self.traffic.push(TrafficReport { stage: stage.label().to_owned(), level, to_first, to_all });
        }
    }

    /// Adds the figures of the written file.
    pub fn add_file(&mut self, sections: &[Section], file_bytes: u64) {
        self.sections =
            sections.iter().map(|s| SectionReport { name: s.name(), bytes: s.len as u64 }).collect();
        self.file_bytes = file_bytes;
        self.peak_memory_bytes = peak_memory_bytes();
    }

    /// Adds the measured error.
    pub fn add_error(&mut self, error: ErrorEstimate) {
        let ErrorEstimate { value, at_least, at_most } = error;
        (self.measured_error, self.measured_error_at_least, self.measured_error_at_most) =
            (value, at_least, at_most);
    }

    /// Returns the measured error; `None` if not requested.
    pub fn measured(&self) -> Option<ErrorEstimate> {
        let (value, at_least, at_most) =
            (self.measured_error, self.measured_error_at_least, self.measured_error_at_most);
        value.or(at_most).map(|_| ErrorEstimate { value, at_least, at_most })
    }

    /// Returns the seconds of all stages.
    pub fn total_seconds(&self) -> f64 {
        self.seconds.iter().map(|s| s.1).sum()
    }
}

/// Returns the memory of the program, bytes, which never shrinks.
#[cfg(target_arch = "wasm32")]
pub fn peak_memory_bytes() -> u64 {
    const PAGE: u64 = 1 << 16;
    std::arch::wasm32::memory_size(0) as u64 * PAGE
}

/// Returns the peak resident memory of the process, bytes; 0 if unknown to the system.
#[cfg(not(target_arch = "wasm32"))]
pub fn peak_memory_bytes() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|line| line.split_whitespace().next()?.parse::<u64>().ok()).unwrap_or(0) * 1024
}

impl fmt::Display for BakeReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mb = |bytes: u64| format!("{:.1} MB", bytes as f64 / 1e6);
        let instances = match self.instances {
            0 => String::new(),
            instances => format!(", of models with {instances} instances {} in all", self.placed_triangles),
        };
        writeln!(
            f,
            "scene         {} ({} triangles{}, {} for rays{}), preset {}",
            self.scene,
            self.triangles,
            instances,
            self.ray_triangles,
            if self.is_open { ", open to the sky" } else { "" },
            self.preset
        )?;
        if self.lamp_added {
            writeln!(f, "light         none in the scene; a lamp was added to the file, in its first view")?;
        }
        if self.is_unlit {
            writeln!(
                f,
                "light         none reaches a surface that is seen: the picture is black until they move"
            )?;
        }
        if self.camera_added {
            let ([x, y, z], place) = (self.camera, if self.is_open { "outside" } else { "in a room" });
            writeln!(
                f,
                "camera        none in the scene; one was added {place}, at {x:.2}, {y:.2}, {z:.2} (--viewpoint x,y,z: from there)"
            )?;
        }
        let levels: Vec<String> = self.levels.iter().map(|l| l.functions.to_string()).collect();
        writeln!(f, "functions     {} on {} levels ({})", self.functions, levels.len(), levels.join(", "))?;
        let rows: Vec<String> = self.levels.iter().map(|l| l.receivers.to_string()).collect();
        writeln!(f, "receivers     {} with links", rows.join(", "))?;
        writeln!(
            f,
            "links         {} ({:.4}% of {} potential) and {} for later bounces, {} sender levels, epsilon {} of {:.2}",
            self.links,
            100.0 * self.link_share,
            self.potential_links,
            self.later_links,
            self.sender_levels,
            self.epsilon,
            self.reflected
        )?;
        writeln!(f, "rays          {:.1} M", self.rays as f64 / 1e6)?;
        if self.source_rays > 0 {
            let sky = self.has_sky.then_some("the sky".to_owned());
            let groups = (!self.emissive_groups.is_empty())
                .then(|| format!("{} groups of shining surfaces", self.emissive_groups.len()));
            let sources: Vec<String> = sky.into_iter().chain(groups).collect();
            writeln!(
                f,
                "sources       {}: {} links, {:.1} M rays",
                sources.join(", "),
                self.source_links,
                self.source_rays as f64 / 1e6
            )?;
        }
        if let Some(TransferReport { points, vectors, compression_error }) = &self.transfer {
            writeln!(
                f,
                "transfer      {vectors} vectors for {points} points, packed with an error of {:.1}%",
                100.0 * compression_error
            )?;
        }
        let gloss = &self.gloss;
        if gloss.links > 0 {
            let (links, points) = (gloss.links, gloss.linked_points);
            writeln!(
                f,
                "gloss links   {links} to {points} points, {:.1} a row",
                links as f64 / points as f64
            )?;
        }
        if gloss.cube_maps > 0 {
            writeln!(f, "cube maps     {} of {} texels in all", gloss.cube_maps, gloss.cube_map_texels)?;
        }
        if gloss.matrices > 0 {
            writeln!(
                f,
                "gloss         {} matrices for {} points, {:.1} M rays, packed with an error of {:.1}%",
                gloss.matrices,
                gloss.points,
                gloss.rays as f64 / 1e6,
                100.0 * gloss.compression_error
            )?;
        }
        writeln!(
            f,
            "bounces       {}; a bounce loses {:.3}% of the light where no function is and {:.3}% in links",
            self.bounces,
            100.0 * self.lost_share,
            100.0 * self.link_loss
        )?;
        let seconds: Vec<String> = self.seconds.iter().map(|(name, s)| format!("{name} {s:.1}")).collect();
        writeln!(f, "seconds       {:.1} ({})", self.total_seconds(), seconds.join(", "))?;
        if self.processes > 1 {
            let sum = |bytes: fn(&TrafficReport) -> u64| mb(self.traffic.iter().map(bytes).sum());
            writeln!(
                f,
                "processes     {}; process 0 took in {}, each one {}",
                self.processes,
                sum(|part| part.to_first),
                sum(|part| part.to_all)
            )?;
        }
        if let Some(error) = self.measured() {
            let said = error.said(3);
            writeln!(f, "error         {} against a path tracer", said.trim_start_matches("error "))?;
        }
        writeln!(f, "peak memory   {}", mb(self.peak_memory_bytes))?;
        let sections: Vec<String> =
            self.sections.iter().map(|s| format!("{} {}", s.name, mb(s.bytes))).collect();
        write!(f, "file          {} ({})", mb(self.file_bytes), sections.join(", "))
    }
}
