//! What a bake made and what it cost: the columns of the paper's Table 1 and the file's sections.

use super::{BakeSettings, Stage};
use crate::communicator::share::Traffic;
use crate::picture::uncertainty::Estimate;
use crate::sampling::Points;
use crate::scene::Scene;
use crate::transport::direct_to_indirect::Operator;
use rebounce_shared::rbn::container::Section;
use serde::Serialize;
use std::fmt;

/// A bake's figures; `--report FILE.json` writes them.
#[derive(Clone, Debug, Default, Serialize)]
pub struct BakeReport {
    /// The scene's name.
    pub scene: String,
    /// The preset's name.
    pub preset: String,
    /// The error against a path tracer that the preset is made for.
    pub promised_error: f64,
    /// The error that was measured, where one was asked for ([`super::judge`]) and noise does not hide it.
    pub measured_error: Option<f64>,
    /// It is hardly less than this.
    pub measured_error_at_least: Option<f64>,
    /// It is hardly more than this.
    pub measured_error_at_most: Option<f64>,
    /// Triangles of the scene, those of copies counted once.
    pub triangles: u64,
    /// Instances of models, which are in memory once each.
    pub instances: u64,
    /// Triangles that stand in the scene, those of each copy counted.
    pub placed_triangles: u64,
    /// Those that rays are cast at, after [simplifying](crate::geometry::simplify); those of copies counted once.
    pub ray_triangles: u64,
    /// Where importance particles started, world space.
    pub viewpoints: Vec<[f64; 3]>,
    /// Whether they came from the sky, too: the scene is an object or a landscape, no room.
    pub is_open: bool,
    /// Whether the scene had no light, so that the file got one.
    pub lamp_added: bool,
    /// Whether the scene had no camera, so that the file got one.
    pub camera_added: bool,
    /// Where the file's first camera is, world space.
    pub camera: [f64; 3],
    /// Whether no light, as they are at first, reaches any surface that has functions.
    pub is_unlit: bool,
    /// Levels of points, coarsest first.
    pub levels: Vec<LevelReport>,
    /// Basis functions on all levels.
    pub functions: u64,
    /// Levels of senders.
    pub sender_levels: u64,
    /// Link threshold ε, a share of `reflected`.
    pub epsilon: f32,
    /// The share of light that the scene's surfaces pass on to each other.
    pub reflected: f32,
    /// Links kept.
    pub links: u64,
    /// Links kept for light that bounces again.
    pub later_links: u64,
    /// Entries of the rows between coarse points that those are made of.
    pub coarse_entries: u64,
    /// Senders times receivers.
    pub potential_links: u64,
    /// Links kept over potential links.
    pub link_share: f64,
    /// Rays cast for the operator.
    pub rays: u64,
    /// Bounces that the operator holds.
    pub bounces: u32,
    /// Share of the reflected light that no sender covers.
    pub lost_share: f64,
    /// Share of the reflected light that links leave out, once a bounce; negative where they add to it.
    pub link_loss: f64,
    /// Seconds of each stage, in order.
    pub seconds: Vec<(String, f64)>,
    /// Processes that baked together.
    pub processes: u64,
    /// What they sent each other; empty for one process.
    pub traffic: Vec<TrafficReport>,
    /// Peak memory of the process, bytes; 0 where the system does not tell.
    pub peak_memory_bytes: u64,
    /// The file's sections.
    pub sections: Vec<SectionReport>,
    /// The file's length, bytes.
    pub file_bytes: u64,
}

/// One level of points in numbers.
#[derive(Clone, Debug, Default, Serialize)]
pub struct LevelReport {
    /// Basis functions.
    pub functions: u64,
    /// Of these, receivers that kept links.
    pub receivers: u64,
    /// Links kept.
    pub links: u64,
    /// Poisson-disk radius, scene units.
    pub disk_radius: f32,
}

/// What the processes of a bake sent each other in one part of it.
#[derive(Clone, Debug, Default, Serialize)]
pub struct TrafficReport {
    /// The stage.
    pub stage: String,
    /// The level of points that it was about, where it was about one.
    pub level: Option<usize>,
    /// Bytes that process 0 took in for the file.
    pub to_first: u64,
    /// Bytes that every process took in for what follows, its own included.
    pub to_all: u64,
}

/// One section of the file in numbers.
#[derive(Clone, Debug, Default, Serialize)]
pub struct SectionReport {
    /// Its four letters.
    pub name: String,
    /// Its length.
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
        self.reflected = settings.operator.reflected;
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

    pub(super) fn add_traffic(&mut self, stage: Stage, level: Option<usize>, traffic: Traffic) {
        let Traffic { to_first, to_all } = traffic;
        if self.processes > 1 {
            self.traffic.push(TrafficReport { stage: stage.label().to_owned(), level, to_first, to_all });
        }
    }

    /// Adds what is known once the file is written.
    pub fn add_file(&mut self, sections: &[Section], file_bytes: u64) {
        self.sections =
            sections.iter().map(|s| SectionReport { name: s.name(), bytes: s.len as u64 }).collect();
        self.file_bytes = file_bytes;
        self.peak_memory_bytes = peak_memory_bytes();
    }

    /// Adds the error that was measured.
    pub fn add_error(&mut self, error: Estimate) {
        let Estimate { value, at_least, at_most } = error;
        (self.measured_error, self.measured_error_at_least, self.measured_error_at_most) =
            (value, at_least, at_most);
    }

    /// The error that was measured, where one was asked for.
    pub fn measured(&self) -> Option<Estimate> {
        let (value, at_least, at_most) =
            (self.measured_error, self.measured_error_at_least, self.measured_error_at_most);
        value.or(at_most).map(|_| Estimate { value, at_least, at_most })
    }

    /// Seconds of all stages.
    pub fn total_seconds(&self) -> f64 {
        self.seconds.iter().map(|s| s.1).sum()
    }
}

/// Peak resident memory of this process, bytes; 0 where the system does not tell.
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
