//! Symmetric and asymmetric iteration (antiradiance paper, section 2.2), and the ordered one.

use super::bins::Bins;
use super::hierarchy::Hierarchy;
use super::leaving::{DirectLight, Leaving};
use super::links::Links;
use super::lobe::Lobes;
use super::patches::Patch;
use super::spread::Spread;
use super::sweep::{Sweep, SweepScene};
use super::transfer::Transfer;
use super::transfers::{Exchange, SenderTables, Spreading, Transfers};
use super::transport::{global_pass, pull, push};
use super::workers::Workers;
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;
use std::sync::OnceLock;

/// Order of radiance and antiradiance steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Iteration {
    /// Both in each step, in the order of the light's way: see [`super::sweep`].
    #[default]
    Ordered,
    /// Both in each step (Eq. 13 and 14).
    Symmetric,
    /// Radiance in one step of so many, antiradiance in all: converges like light that bounces.
    Asymmetric(u32),
}

impl Iteration {
    /// Whether a step, counted from 0, reflects light.
    pub fn reflects(&self, step: u32) -> bool {
        match self {
            Self::Ordered | Self::Symmetric => true,
            Self::Asymmetric(steps) => (step + 1).is_multiple_of((*steps).max(1)),
        }
    }
}

/// Settings of a solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolverSettings {
    /// Number of bins, see [`Bins::new`].
    pub bins: usize,
    /// Greatest solid angle of the elements of a link, in bins.
    pub width: f32,
    /// How wide senders reach several bins.
    pub spreading: Spreading,
    /// Order of the steps.
    pub iteration: Iteration,
    /// Most steps.
    pub iterations: u32,
    /// It ends earlier where the irradiance changes by less than this share between two steps that reflect.
    pub tolerance: f32,
}

impl Default for SolverSettings {
    fn default() -> Self {
        Self {
            bins: 128,
            width: 2.0,
            spreading: Spreading::Exact,
            iteration: Iteration::Ordered,
            iterations: 40,
            tolerance: 1e-4,
        }
    }
}

/// What a solution took.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AntiradianceFigures {
    /// Steps.
    pub iterations: u32,
    /// Change of the irradiance by each step, a share of it (root mean squares over the area).
    pub changes: Vec<f32>,
}

/// A part of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pass {
    /// Light over links.
    Global,
    /// From clusters to patches.
    Push,
    /// K and J.
    Local,
    /// From patches to clusters.
    Pull,
}

/// Whoever follows a solution.
pub trait Observer {
    /// A part of a step has passed.
    fn passed(&mut self, _pass: Pass) {}

    /// A step has passed; has the bounced irradiance by patch, and says whether to go on.
    fn stepped(&mut self, _irradiance: &[Vec3]) -> bool {
        true
    }
}

impl Observer for () {}

/// Elements and their links, ready for any light.
pub struct AntiradianceSolver<'a> {
    /// Patches.
    pub patches: &'a [Patch],
    /// Elements.
    pub hierarchy: Hierarchy,
    /// Directions.
    pub bins: Bins,
    /// Number of links.
    pub links: usize,
    /// Form factors.
    pub transfers: Transfers,
    /// Gaussians.
    pub spread: Spread,
    /// By patch.
    pub normalisations: Vec<f32>,
    /// Metals.
    pub lobes: Lobes,
    /// Links in the order of sweeps; made for the first ordered solution.
    ordered: OnceLock<Sweep>,
}

impl<'a> AntiradianceSolver<'a> {
    /// Makes the hierarchy, links and form factors.
    pub fn new(patches: &'a [Patch], settings: &SolverSettings, workers: &dyn Workers) -> Self {
        let bins = Bins::new(settings.bins);
        let hierarchy = Hierarchy::new(patches);
        let links = Links::new(patches, &hierarchy, &bins, settings.width);
        let senders = SenderTables::new(patches, &hierarchy, &bins);
        let spreading = settings.spreading;
        let exchange = Exchange { bins: &bins, patches, hierarchy: &hierarchy, senders: &senders, spreading };
        let transfers = Transfers::new(&exchange, &links, workers);
        let normalisations = senders.normalisations;
        let lobes = Lobes::new(patches, &bins, &normalisations);
        Self::linked(patches, (hierarchy, bins), (transfers, links.count()), (normalisations, lobes))
    }

    /// Of elements, bins, form factors and the number of their links, and the normalisations and lobes of the patches.
    pub fn linked(
        patches: &'a [Patch],
        (hierarchy, bins): (Hierarchy, Bins),
        (transfers, links): (Transfers, usize),
        (normalisations, lobes): (Vec<f32>, Lobes),
    ) -> Self {
        let spread = Spread::new(&bins);
        let ordered = OnceLock::new();
        Self { patches, hierarchy, bins, links, transfers, spread, normalisations, lobes, ordered }
    }

    /// Bytes of the tables of an iteration, of the form factors, and of what orders them.
    pub fn bytes(&self, iteration: Iteration) -> usize {
        let cells = self.hierarchy.elements.len() * self.bins.count();
        let transfers = self.transfers.transfers.len();
        let tables = 2 * cells * size_of::<Vec3>() + transfers * size_of::<Transfer>();
        // Order and offset of each cell; sender and factor of each transfer.
        let ordered = 2 * cells * size_of::<u32>() + transfers * (size_of::<u32>() + size_of::<f32>());
        if iteration == Iteration::Ordered { tables + ordered } else { tables }
    }

    /// Direct light of this irradiance by patch; to metals it comes evenly from all sides.
    pub fn even_light(&self, irradiance: Vec<Vec3>) -> DirectLight {
        let mut by_bin = Vec::with_capacity(self.lobes.gains.len());
        for patch in &self.lobes.patches {
            let patch = *patch as usize;
            let local = self.sweep_scene().local(patch);
            let radiance = FRAC_1_PI * irradiance[patch];
            by_bin.extend((0..self.bins.count()).map(|bin| local.irradiance_of(bin) * radiance));
        }
        DirectLight { irradiance, by_bin }
    }

    /// Irradiance of the patches that bounced from others, for the `direct` irradiance of each. The direct light makes no
    /// antiradiance: its shadows are in it (section 3.3).
    pub fn solve(
        &self,
        direct: &DirectLight,
        settings: &SolverSettings,
        workers: &dyn Workers,
        observer: &mut dyn Observer,
    ) -> (Vec<Vec3>, AntiradianceFigures) {
        let ordered = (settings.iteration == Iteration::Ordered)
            .then(|| self.ordered.get_or_init(|| Sweep::new(&self.sweep_scene(), &self.transfers)));
        let mut state = self.state(direct, ordered.is_some(), workers);
        let mut figures = AntiradianceFigures::default();
        let mut reflected: Option<Vec<Vec3>> = None;
        for step in 0..settings.iterations {
            let before = state.irradiance.clone();
            let reflects = settings.iteration.reflects(step);
            match ordered {
                Some(sweep) => self.sweep(sweep, &mut state, direct, workers, observer),
                None => self.step(&mut state, direct, reflects, workers, observer),
            }
            figures.changes.push(self.difference(&before, &state.irradiance));
            figures.iterations = step + 1;
            if !observer.stepped(&state.irradiance) {
                break;
            }
            if reflects {
                let before = reflected.replace(state.irradiance.clone());
                let change = before.map_or(1.0, |before| self.difference(&before, &state.irradiance));
                if change < settings.tolerance {
                    break;
                }
            }
        }
        (state.irradiance, figures)
    }

    /// Root mean square of the difference of irradiances as a share of the second's, by area.
    pub fn difference(&self, before: &[Vec3], after: &[Vec3]) -> f32 {
        let (mut difference, mut whole) = (0.0f64, 0.0f64);
        for ((patch, before), after) in self.patches.iter().zip(before).zip(after) {
            let area = f64::from(patch.area());
            difference += area * f64::from((*after - *before).length_squared());
            whole += area * f64::from(after.length_squared());
        }
        if whole > 0.0 { (difference / whole).sqrt() as f32 } else { 0.0 }
    }

    /// Direct light has come to the patches, and nothing else.
    fn state(&self, direct: &DirectLight, is_ordered: bool, workers: &dyn Workers) -> State {
        let cells = self.hierarchy.elements.len() * self.bins.count();
        let mut state = State {
            incident: vec![Vec3::ZERO; if is_ordered { 2 * cells } else { cells }],
            exitant: vec![Vec3::ZERO; if is_ordered { 0 } else { cells }],
            irradiance: vec![Vec3::ZERO; self.patches.len()],
            radiance: vec![Vec3::ZERO; self.patches.len()],
            lobes: vec![Vec3::ZERO; self.lobes.gains.len()],
        };
        self.reflect(&mut state, direct);
        self.reflect_lobes(&mut state.lobes, direct, workers, &|_, out| out.fill(Vec3::ZERO));
        if !is_ordered {
            self.leave(&mut state, workers, &mut ());
        }
        state
    }

    fn sweep_scene(&self) -> SweepScene<'_> {
        SweepScene {
            patches: self.patches,
            hierarchy: &self.hierarchy,
            bins: &self.bins,
            normalisations: &self.normalisations,
        }
    }

    /// A sweep of all bins, and K.
    fn sweep(
        &self,
        sweep: &Sweep,
        state: &mut State,
        direct: &DirectLight,
        workers: &dyn Workers,
        observer: &mut dyn Observer,
    ) {
        let scene = self.sweep_scene();
        let leaving = self.leaving(&state.radiance, &state.lobes);
        sweep.run(&scene, &leaving, &mut state.incident, workers);
        observer.passed(Pass::Global);
        Sweep::irradiance(&scene, &state.incident, &mut state.irradiance, workers);
        self.reflect(state, direct);
        let table = &state.incident;
        self.reflect_lobes(&mut state.lobes, direct, workers, &|patch, out| {
            scene.local(patch).irradiance_by_bin(Sweep::incident(&scene, table, patch), out);
        });
        observer.passed(Pass::Local);
    }

    /// Global pass, push, local pass, pull.
    fn step(
        &self,
        state: &mut State,
        direct: &DirectLight,
        reflects: bool,
        workers: &dyn Workers,
        observer: &mut dyn Observer,
    ) {
        let bins = self.bins.count();
        let State { incident, exitant, irradiance, .. } = state;
        global_pass(&self.transfers, &self.spread, bins, exitant, incident, workers);
        observer.passed(Pass::Global);
        push(self.patches, &self.hierarchy, &self.bins, incident, workers);
        observer.passed(Pass::Push);
        let (scene, incident) = (self.sweep_scene(), &*incident);
        let row = |patch: usize| {
            incident[self.hierarchy.element_of[patch] as usize * bins..][..bins].iter().copied()
        };
        workers.rows(irradiance, 1, &|patch, out| out[0] = scene.local(patch).irradiance(row(patch)));
        if reflects {
            let by_bin =
                |patch: usize, out: &mut [Vec3]| scene.local(patch).irradiance_by_bin(row(patch), out);
            self.reflect_lobes(&mut state.lobes, direct, workers, &by_bin);
            self.reflect(state, direct);
        }
        self.leave(state, workers, observer);
    }

    fn leaving<'s>(&self, matt: &'s [Vec3], lobes: &'s [Vec3]) -> Leaving<'s> {
        Leaving { matt, lobes, bins: self.bins.count() }
    }

    /// K of metals: radiance by bin. `bounced` writes the irradiance by bin of a patch that has bounced.
    fn reflect_lobes(
        &self,
        lobes: &mut [Vec3],
        direct: &DirectLight,
        workers: &dyn Workers,
        bounced: &(dyn Fn(usize, &mut [Vec3]) + Sync),
    ) {
        let bins = self.bins.count();
        workers.rows(lobes, bins, &|number, out| {
            let mut arriving = vec![Vec3::ZERO; bins];
            bounced(self.lobes.patches[number] as usize, &mut arriving);
            let direct = &direct.by_bin[number * bins..][..bins];
            arriving.iter_mut().zip(direct).for_each(|(sum, direct)| *sum += *direct);
            self.lobes.reflect(number, self.patches, &self.bins, &arriving, out);
        });
    }

    /// K: radiance of matt patches.
    fn reflect(&self, state: &mut State, direct: &DirectLight) {
        let arriving = state.irradiance.iter().zip(&direct.irradiance);
        for ((radiance, patch), (bounced, direct)) in
            state.radiance.iter_mut().zip(self.patches).zip(arriving)
        {
            let is_matt = patch.roughness.is_none();
            *radiance = if is_matt { FRAC_1_PI * patch.albedo * (*direct + *bounced) } else { Vec3::ZERO };
        }
    }

    /// Exitant intensity of the patches, and of the clusters.
    fn leave(&self, state: &mut State, workers: &dyn Workers, observer: &mut dyn Observer) {
        let bins = self.bins.count();
        let State { incident, exitant, radiance, lobes, .. } = state;
        let leaving = self.leaving(radiance, lobes);
        let scene = self.sweep_scene();
        workers.rows(exitant, bins, &|element, row| {
            let own = &self.hierarchy.elements[element];
            if own.is_patch() {
                let local = scene.local(own.first as usize);
                local.exitant(own, &leaving, &incident[element * bins..][..bins], row);
            }
        });
        observer.passed(Pass::Local);
        pull(&self.hierarchy, bins, exitant, workers);
        observer.passed(Pass::Pull);
    }
}

/// Tables of a solution.
struct State {
    /// Incident radiance by element and bin; of the ordered iteration, the table of its sweeps.
    incident: Vec<Vec3>,
    /// Exitant intensity I_L − I_A by element and bin.
    exitant: Vec<Vec3>,
    /// Bounced irradiance by patch.
    irradiance: Vec<Vec3>,
    /// Exitant radiance by matt patch.
    radiance: Vec<Vec3>,
    /// Exitant radiance by glossy patch and bin.
    lobes: Vec<Vec3>,
}
