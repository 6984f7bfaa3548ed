//! Results and cost of a fixed solution: the columns of Table 1 of Lehtinen et al. 2007, and the file's sections.

use super::BakeReport;
use super::report::{SectionReport, peak_memory_bytes};
use crate::sampling::Points;
use crate::transport::radiosity::{FixedSolution, RadiositySettings};
use rebounce_shared::rbn::container::Section;
use serde::Serialize;
use std::fmt;

/// Figures of a solution; `solve --report FILE.json` writes them.
#[derive(Clone, Debug, Default, Serialize)]
pub struct SolveReport {
    /// The scene's name.
    pub scene: String,
    /// The preset's name.
    pub preset: String,
    /// Triangles of the scene; a model counts once.
    pub triangles: u64,
    /// Groups of light.
    pub groups: u64,
    /// Whether a lamp was added to the file because the scene has no light.
    pub lamp_added: bool,
    /// Samples generated: basis functions on all levels.
    pub samples_generated: u64,
    /// Samples gathered to.
    pub samples_gathered: u64,
    /// Visibility rays: those of gathers.
    pub visibility_rays: u64,
    /// Rays for the light of a sky and of emissive surfaces.
    pub source_rays: u64,
    /// Levels of the hierarchy.
    pub levels: u64,
    /// Samples and gathered samples of each level, coarsest first.
    pub samples_by_level: Vec<[u64; 2]>,
    /// Samples on the coarsest level.
    pub samples_at_coarsest: u64,
    /// ε_E: variation that refines a receiver, a share of the mean bounced irradiance.
    pub epsilon_e: f32,
    /// ε_Ω: greatest solid angle of a sender's function, steradian.
    pub epsilon_omega: f32,
    /// Number of bounces.
    pub bounces: u32,
    /// Seconds of evaluating basis functions in gathers, of all threads together.
    pub function_seconds: f64,
    /// Seconds of casting visibility rays in gathers, of all threads together.
    pub ray_seconds: f64,
    /// Figures of wavelet radiosity; `None` of other solvers.
    pub wavelet: Option<WaveletReport>,
    /// Figures of antiradiance; `None` of other solvers.
    pub antiradiance: Option<AntiradianceReport>,
    /// Seconds of each stage, in order.
    pub seconds: Vec<(String, f64)>,
    /// Peak memory of the process, bytes; 0 if unknown to the system.
    pub peak_memory_bytes: u64,
    /// The file's sections.
    pub sections: Vec<SectionReport>,
    /// The file's length, bytes.
    pub file_bytes: u64,
}

/// Figures of wavelet radiosity: columns of the tables of Alonso et al. 2001.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct WaveletReport {
    /// M1, M2 or M3.
    pub order: String,
    /// Input primitives: faces of all instances.
    pub faces: u64,
    /// Faces that cannot be mapped: they neither shoot nor receive.
    pub unmapped_faces: u64,
    /// Patches: a two-sided face has two.
    pub patches: u64,
    /// Final meshes: leaves of the quadtrees, of all lights together.
    pub leaf_cells: u64,
    /// RGB coefficients.
    pub coefficients: u64,
    /// Bytes of the quadtrees.
    pub bytes: u64,
    /// Patches that have shot.
    pub shooting_patches: u64,
    /// Shots of all lights together.
    pub shots: u64,
    /// Visibility rays between patches.
    pub rays: u64,
    /// Share of the power that was shot, of the last light.
    pub convergence: f64,
    /// Width and height of the lightmap, texels; `None` where its charts do not fit a texture.
    pub lightmap: Option<[u32; 2]>,
    /// Charts of the lightmap.
    pub charts: u64,
    /// Triangles without a chart: they have the light of the points.
    pub triangles_left_out: u64,
}

/// Figures of antiradiance: columns of Tables 1 and 2 of Dachsbacher et al. 2007.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct AntiradianceReport {
    /// Bins of directions.
    pub bins: u64,
    /// Patches, and with them clusters.
    pub patches: u64,
    /// Patches and clusters.
    pub elements: u64,
    /// Links.
    pub links: u64,
    /// Form factors of the links: one for each bin that a link uses.
    pub transfers: u64,
    /// `ordered`, `symmetric` or `asymmetric`.
    pub iteration: String,
    /// Steps, of the last group of light.
    pub iterations: u32,
    /// Seconds of making hierarchy, links and form factors.
    pub link_seconds: f64,
    /// Seconds of all global passes.
    pub global_seconds: f64,
    /// Seconds of all local passes.
    pub local_seconds: f64,
    /// Seconds of all pushes and pulls.
    pub push_pull_seconds: f64,
    /// Difference of each step's irradiance from the last step's, a share of it, of the last group of light.
    pub differences: Vec<f32>,
    /// Bytes of the tables of radiance and intensity, of the form factors, and of what orders them.
    pub bytes: u64,
}

#[cfg(feature = "antiradiance")]
impl AntiradianceReport {
    pub(super) fn new(
        settings: &crate::transport::antiradiance::AntiradianceSettings,
        work: crate::transport::antiradiance::AntiradianceWork,
    ) -> Self {
        use rebounce_shared::antiradiance::Iteration;
        let [global, push, local, pull] = work.pass_seconds;
        let iteration = match settings.solver.iteration {
            Iteration::Ordered => "ordered",
            Iteration::Symmetric => "symmetric",
            Iteration::Asymmetric(_) => "asymmetric",
        };
        Self {
            bins: work.bins as u64,
            patches: work.patches as u64,
            elements: work.elements as u64,
            links: work.links as u64,
            transfers: work.transfers as u64,
            iteration: iteration.to_owned(),
            iterations: work.iterations,
            link_seconds: work.link_seconds,
            global_seconds: global,
            local_seconds: local,
            push_pull_seconds: push + pull,
            differences: work.differences,
            bytes: work.bytes,
        }
    }
}

impl AntiradianceReport {
    fn describe(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "elements      {}, {} of them patches; {} bins", self.elements, self.patches, self.bins)?;
        writeln!(
            f,
            "links         {} with {} form factors, in {:.1} s",
            self.links, self.transfers, self.link_seconds
        )?;
        let ms = |seconds: f64| 1e3 * seconds / f64::from(self.iterations.max(1));
        writeln!(
            f,
            "iteration     {}, {} steps: global {:.0} ms, push and pull {:.0} ms, local {:.0} ms each",
            self.iteration,
            self.iterations,
            ms(self.global_seconds),
            ms(self.push_pull_seconds),
            ms(self.local_seconds)
        )?;
        writeln!(f, "tables        {:.1} MB", self.bytes as f64 / 1e6)
    }
}

#[cfg(feature = "exact-faces")]
impl WaveletReport {
    pub(super) fn new(
        patches: &crate::transport::wavelet::ScenePatches,
        settings: &crate::transport::wavelet::WaveletSettings,
        figures: &crate::transport::wavelet::Figures,
        lightmap: Option<crate::transport::wavelet::lightmap::LightmapFigures>,
    ) -> Self {
        Self {
            lightmap: lightmap.map(|lightmap| lightmap.size),
            charts: lightmap.map_or(0, |lightmap| lightmap.charts.into()),
            triangles_left_out: lightmap.map_or(0, |lightmap| lightmap.left_out.into()),
            order: format!("{:?}", settings.order),
            faces: patches.faces() as u64,
            unmapped_faces: patches.unmapped as u64,
            patches: patches.count() as u64,
            leaf_cells: figures.leaf_cells as u64,
            coefficients: figures.coefficients as u64,
            bytes: figures.bytes as u64,
            shooting_patches: figures.shooting_patches as u64,
            shots: figures.shots as u64,
            rays: figures.rays,
            convergence: figures.convergence.last().copied().unwrap_or(1.0),
        }
    }
}

impl SolveReport {
    pub(super) fn new(bake: BakeReport, settings: &RadiositySettings, solution: &FixedSolution) -> Self {
        let [ray_seconds, function_seconds] = solution.gather_seconds;
        Self {
            scene: bake.scene,
            preset: bake.preset,
            triangles: bake.triangles,
            lamp_added: bake.lamp_added,
            samples_gathered: solution.levels.iter().map(|level| level.gathered).sum(),
            samples_by_level: solution.levels.iter().map(|level| [level.points, level.gathered]).collect(),
            visibility_rays: solution.rays,
            source_rays: solution.source_rays,
            epsilon_e: settings.epsilon_e,
            epsilon_omega: settings.epsilon_omega,
            bounces: solution.bounces,
            function_seconds,
            ray_seconds,
            ..Self::default()
        }
    }

    pub(super) fn describe(&mut self, points: &Points, groups: usize, seconds: Vec<(String, f64)>) {
        self.samples_generated = points.points.len() as u64;
        self.levels = points.levels.len() as u64;
        self.samples_at_coarsest = points.levels.first().map_or(0, |level| level.count as u64);
        self.groups = groups as u64;
        self.seconds = seconds;
    }

    /// Adds the figures of the written file.
    pub fn add_file(&mut self, sections: &[Section], file_bytes: u64) {
        self.sections =
            sections.iter().map(|s| SectionReport { name: s.name(), bytes: s.len as u64 }).collect();
        self.file_bytes = file_bytes;
        self.peak_memory_bytes = peak_memory_bytes();
    }

    /// Returns the seconds of all stages.
    pub fn total_seconds(&self) -> f64 {
        self.seconds.iter().map(|stage| stage.1).sum()
    }
}

impl fmt::Display for SolveReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mb = |bytes: u64| format!("{:.1} MB", bytes as f64 / 1e6);
        writeln!(f, "scene         {} ({} triangles), preset {}", self.scene, self.triangles, self.preset)?;
        if self.lamp_added {
            writeln!(
                f,
                "light         none in the scene; a lamp was added, in its first view (--shot: others)"
            )?;
        }
        writeln!(f, "groups        {} of light, which stay in place", self.groups)?;
        let levels = |which: usize| {
            let counts = self.samples_by_level.iter().map(|counts| counts[which].to_string());
            counts.collect::<Vec<String>>().join(", ")
        };
        let (levels, gathered) = (levels(0), levels(1));
        writeln!(f, "samples       {} on {} levels ({levels})", self.samples_generated, self.levels)?;
        writeln!(f, "gathered to   {} ({gathered})", self.samples_gathered)?;
        if let Some(of) = &self.wavelet {
            let unmapped = match of.unmapped_faces {
                0 => String::new(),
                count => format!(", {count} of them without a map: they are dark"),
            };
            writeln!(f, "wavelets      {}: {} faces{unmapped}, {} patches", of.order, of.faces, of.patches)?;
            writeln!(
                f,
                "meshes        {} leaves, {} coefficients, {}",
                of.leaf_cells,
                of.coefficients,
                mb(of.bytes)
            )?;
            writeln!(
                f,
                "shots         {} by {} patches, {:.1}% of the power",
                of.shots,
                of.shooting_patches,
                100.0 * of.convergence
            )?;
            match of.lightmap {
                Some([width, height]) => {
                    let (charts, out) = (of.charts, of.triangles_left_out);
                    let left_out = match out {
                        0 => String::new(),
                        _ => format!("; {out} triangles without one have the light of the points"),
                    };
                    writeln!(f, "lightmap      {width} x {height} texels, {charts} charts{left_out}")?;
                }
                None => writeln!(f, "lightmap      none: its charts do not fit a texture")?,
            }
        } else if let Some(of) = &self.antiradiance {
            of.describe(f)?;
        } else {
            writeln!(
                f,
                "thresholds    epsilon_E {}, epsilon_omega {} sr",
                self.epsilon_e, self.epsilon_omega
            )?;
        }
        writeln!(f, "rays          {:.1} M", self.visibility_rays as f64 / 1e6)?;
        if self.source_rays > 0 {
            let rays = self.source_rays as f64 / 1e6;
            writeln!(f, "source rays   {rays:.1} M, for the sky and for shining surfaces")?;
        }
        writeln!(f, "bounces       {}", self.bounces)?;
        let seconds: Vec<String> = self.seconds.iter().map(|(name, s)| format!("{name} {s:.1}")).collect();
        writeln!(f, "seconds       {:.1} ({})", self.total_seconds(), seconds.join(", "))?;
        writeln!(
            f,
            "gathers       basis functions {:.1} s, visibility rays {:.1} s, of all threads together",
            self.function_seconds, self.ray_seconds
        )?;
        writeln!(f, "peak memory   {}", mb(self.peak_memory_bytes))?;
        let sections: Vec<String> =
            self.sections.iter().map(|s| format!("{} {}", s.name, mb(s.bytes))).collect();
        write!(f, "file          {} ({})", mb(self.file_bytes), sections.join(", "))
    }
}
