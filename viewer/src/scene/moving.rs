//! A scene whose nodes move: where they are, and the radiosity that follows them.

use super::Loaders;
use super::radiosity::{Radiosity, RadiosityPipelines};
use super::relight::Relight;
use super::upload::Upload;
use crate::error::ViewerError;
use crate::gpu::Gpu;
use crate::gpu::bindings::buffer;
use crate::gpu::scope::Scope;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::motion::{Motions, NodeMotion};
use rebounce_shared::radiosity::RadiositySettings;
use rebounce_shared::rbn::bulk::Instance;
use std::cell::{Cell, RefCell};
use wgpu::BufferUsages;

/// The moving part of a scene.
pub struct Moving {
    /// What of the file motions and rays take, without vertices and textures.
    file: BakedScene,
    nodes: RefCell<Vec<NodeMotion>>,
    solver: RefCell<Radiosity>,
    /// The light or a node has changed since the solution began.
    is_stale: Cell<bool>,
    own: Scope,
}

/// Points of a scene where their groups are.
pub fn points(scope: &Scope, scene: &BakedScene) -> wgpu::Buffer {
    let storage = BufferUsages::STORAGE | BufferUsages::COPY_DST;
    buffer(scope, "moved points", storage, bytemuck::cast_slice(&scene.points))
}

impl Moving {
    /// Prepares a scene; `own` has the `points` where their groups are.
    ///
    /// # Errors
    /// [`ViewerError::TooLarge`] where something is larger than a binding.
    pub fn new(
        gpu: &Gpu,
        loaders: &Loaders<'_>,
        (upload, relight): (&Upload, &Relight),
        (own, points): (Scope, &wgpu::Buffer),
        scene: &BakedScene,
    ) -> Result<Self, ViewerError> {
        let pipelines = loaders.radiosity.get_or_init(|| RadiosityPipelines::new(gpu));
        let buffers = [points, &relight.irradiance, &relight.display];
        let solver = Radiosity::new(gpu, pipelines, upload, scene, buffers, RadiositySettings::default())?;
        let file = BakedScene {
            meta: scene.meta.clone(),
            instances: scene.instances.clone(),
            copies: scene.copies.clone(),
            points: scene.points.clone(),
            cuts: scene.cuts.clone(),
            parent_weights: scene.parent_weights,
            relations: scene.relations.clone(),
            groups: scene.groups.clone(),
            point_groups: scene.point_groups.clone(),
            ..BakedScene::default()
        };
        let nodes = RefCell::new(vec![NodeMotion::default(); file.groups.nodes.len()]);
        Ok(Self { file, nodes, solver: solver.into(), is_stale: true.into(), own })
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.own.bytes() + self.solver.borrow().bytes()
    }

    /// Names of the nodes that may move.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.file.groups.nodes.iter().map(|node| node.name.as_str())
    }

    /// Motions of the nodes, in the order of their names.
    pub fn nodes(&self) -> Vec<NodeMotion> {
        self.nodes.borrow().clone()
    }

    /// Puts the nodes where `motions` have them: pictures, points, rays.
    pub fn place(&self, gpu: &Gpu, upload: &Upload, motions: &[NodeMotion]) {
        let groups = &self.file.groups;
        self.nodes.borrow_mut().iter_mut().zip(motions).for_each(|(node, motion)| *node = *motion);
        let motions = Motions::new(groups, &self.nodes.borrow(), self.file.meta.origin);
        let instances = self.file.moved_instances(&motions);
        let offset = size_of::<Instance>() as u64;
        gpu.queue.write_buffer(&upload.instances, offset, bytemuck::cast_slice(&instances));
        upload.triangles.set_instances(&instances);
        let of_group = |group: u32| Instance::from(&motions.of(group).rest_from_local);
        let rest: Vec<Instance> = (0..=groups.groups.len() as u32).map(of_group).collect();
        gpu.queue.write_buffer(&upload.rest, 0, bytemuck::cast_slice(&rest));
        self.solver.borrow().place(gpu, upload, &self.file, &motions);
        self.is_stale.set(true);
    }

    /// Notes that the direct light at the points has changed.
    pub fn relit(&self) {
        self.is_stale.set(true);
    }

    /// Whether the displayed light is not yet that of lights and nodes as they are.
    pub fn is_solving(&self) -> bool {
        self.is_stale.get() || !self.solver.borrow().progress().is_done
    }

    /// Encodes the next slice of the solution, of at most so many receivers. Returns whether the displayed light has changed.
    /// A solution that has nothing to show yet goes on when something changes, so that light follows a node that is dragged.
    pub fn solve(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        pipelines: &RadiosityPipelines,
        relight: &Relight,
        receivers: u32,
    ) -> bool {
        let mut solver = self.solver.borrow_mut();
        let progress = solver.progress();
        if self.is_stale.get() && (progress.is_shown || progress.passes[0] == 0) {
            solver.restart();
            self.is_stale.set(false);
        }
        let before = solver.progress();
        if before.is_done {
            return false;
        }
        solver.encode(gpu, encoder, pipelines, receivers);
        let progress = solver.progress();
        let has_more = progress.is_shown && progress.passes[0] > before.passes[0] || progress.is_done;
        if has_more {
            solver.show(gpu, encoder, pipelines);
            relight.show_sources(encoder);
        }
        has_more
    }

    /// Shows the solution so far again: after a change of what is shown.
    pub fn show(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        pipelines: &RadiosityPipelines,
        relight: &Relight,
    ) {
        let solver = self.solver.borrow();
        if solver.progress().is_shown {
            solver.show(gpu, encoder, pipelines);
            relight.show_sources(encoder);
        }
    }
}
