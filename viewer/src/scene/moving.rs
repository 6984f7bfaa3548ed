//! A scene whose nodes move: where they are, and the radiosity that follows them.

use super::Loaders;
use super::radiosity::{Radiosity, RadiosityPipelines};
use super::relight::Relight;
use super::upload::Upload;
use crate::error::ViewerError;
use crate::gpu::Gpu;
use crate::gpu::bindings::buffer;
use crate::gpu::scope::Scope;
use glam::{DAffine3, DVec3, Vec3};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::motion::{Motions, NodeMotion, world_motions};
use rebounce_shared::radiosity::RadiositySettings;
use rebounce_shared::rbn::bulk::Instance;
use rebounce_shared::rbn::groups::{Groups, Node};
use rebounce_shared::rbn::node_tracks::NodeAnimation;
use std::cell::{Cell, RefCell};
use wgpu::BufferUsages;

/// The moving part of a scene.
pub struct Moving {
    /// What of the file motions and rays take, without vertices and textures.
    file: BakedScene,
    nodes: RefCell<Vec<NodeMotion>>,
    /// Middle of what each node moves, where the file has it; world space.
    middles: Vec<DVec3>,
    solver: RefCell<Radiosity>,
    /// The light or a node has changed since the solution began.
    is_stale: Cell<bool>,
    /// Nodes have moved since their motions were uploaded.
    is_unplaced: Cell<bool>,
    own: Scope,
}

/// Whether a scene has what radiosity takes: reflectances, and direct light at all points.
pub fn is_solvable(scene: &BakedScene) -> bool {
    !scene.is_solved() && !scene.reflectance.is_empty() && scene.direct_count() == scene.points.len()
}

/// Points of a scene where their groups are.
pub fn points(scope: &Scope, scene: &BakedScene) -> wgpu::Buffer {
    let storage = BufferUsages::STORAGE | BufferUsages::COPY_DST | BufferUsages::COPY_SRC;
    buffer(scope, "moved points", storage, bytemuck::cast_slice(&scene.points))
}

/// Returns the middle of the surfaces of each node and of those below it, world space; of a node without any its origin.
fn middles(scene: &BakedScene) -> Vec<DVec3> {
    let Groups { nodes, .. } = &scene.groups;
    let mut bounds = vec![[Vec3::INFINITY, Vec3::NEG_INFINITY]; nodes.len()];
    for (i, draw) in scene.meta.draws.iter().enumerate() {
        let Some(node) = scene.groups.node_of(scene.groups.of_material(draw.material)) else { continue };
        let first = draw.first_index as usize;
        let indices = &scene.indices[first..first + draw.index_count as usize];
        for copy in scene.copies_of(i) {
            let place = scene.instances[copy].local_from_model();
            for &index in indices {
                let at = place.transform_point3(scene.vertices[index as usize].position.into());
                let [low, high] = &mut bounds[node as usize];
                (*low, *high) = (low.min(at), high.max(at));
            }
        }
    }
    // Parents come before children.
    for i in (0..nodes.len()).rev() {
        if let Some(parent) = nodes[i].parent {
            let [low, high] = bounds[i];
            let above = &mut bounds[parent as usize];
            *above = [above[0].min(low), above[1].max(high)];
        }
    }
    let middle = |(node, [low, high]): (&Node, [Vec3; 2])| match low.cmple(high).all() {
        true => (0.5 * (low + high)).as_dvec3() + DVec3::from(scene.meta.origin),
        false => node.origin.into(),
    };
    nodes.iter().zip(bounds).map(middle).collect()
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
            #[cfg(feature = "antiradiance")]
            reflectance: scene.reflectance.clone(),
            ..BakedScene::default()
        };
        let nodes = RefCell::new(vec![NodeMotion::default(); file.groups.nodes.len()]);
        let middles = middles(scene);
        let (is_stale, is_unplaced) = (true.into(), false.into());
        Ok(Self { file, nodes, middles, solver: solver.into(), is_stale, is_unplaced, own })
    }

    /// Whether a node is elsewhere than the file has it.
    pub fn is_moved(&self) -> bool {
        self.nodes.borrow().iter().any(|node| *node != NodeMotion::default())
    }

    /// What of the file motions and rays take; with reflectances.
    #[cfg(feature = "antiradiance")]
    pub fn file(&self) -> &BakedScene {
        &self.file
    }

    /// Position and normal of a point where its node is; local space.
    #[cfg(feature = "antiradiance")]
    pub fn placed_point(&self, motions: &Motions, point: usize) -> [Vec3; 2] {
        let point = self.file.moved_point(point, motions);
        [point.position(), point.normal()]
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.own.bytes() + self.solver.borrow().bytes()
    }

    /// Names of the nodes that may move.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.file.groups.nodes.iter().map(|node| node.name.as_str())
    }

    /// Keyframes of the nodes.
    pub fn animations(&self) -> &[NodeAnimation] {
        &self.file.groups.animations
    }

    /// Motions of the nodes, in the order of their names.
    pub fn nodes(&self) -> Vec<NodeMotion> {
        self.nodes.borrow().clone()
    }

    /// Returns the middle of what each node moves, and its origin, where they are; world space.
    pub fn places(&self) -> Vec<[DVec3; 2]> {
        let groups = &self.file.groups;
        let world = world_motions(groups, &self.nodes.borrow());
        let placed = groups.nodes.iter().zip(&self.middles).zip(&world);
        let place = |((node, middle), world): ((&Node, &DVec3), &DAffine3)| {
            [*middle, node.origin.into()].map(|place: DVec3| world.transform_point3(place))
        };
        placed.map(place).collect()
    }

    /// Puts the nodes where `motions` have them, for rays on the CPU. Pictures and points follow with [`Self::upload`]: a script,
    /// an animation or a hand may set several nodes before the next picture.
    pub fn place(&self, upload: &Upload, motions: &[NodeMotion]) {
        self.nodes.borrow_mut().iter_mut().zip(motions).for_each(|(node, motion)| *node = *motion);
        upload.triangles.set_instances(&self.file.moved_instances(&self.motions()));
        self.is_stale.set(true);
        self.is_unplaced.set(true);
    }

    /// Uploads where the nodes are, if they have moved: pictures, points, and what ends supports around them.
    pub fn upload(&self, gpu: &Gpu, upload: &Upload) {
        if !self.is_unplaced.take() {
            return;
        }
        let motions = self.motions();
        let instances = self.file.moved_instances(&motions);
        let offset = size_of::<Instance>() as u64;
        gpu.queue.write_buffer(&upload.instances, offset, bytemuck::cast_slice(&instances));
        let of_group = |group: u32| Instance::from(&motions.of(group).rest_from_local);
        let rest: Vec<Instance> = (0..=self.file.groups.groups.len() as u32).map(of_group).collect();
        gpu.queue.write_buffer(&upload.rest, 0, bytemuck::cast_slice(&rest));
        self.solver.borrow().place(gpu, upload, &self.file, &motions);
    }

    /// Motions of the groups.
    pub fn motions(&self) -> Motions {
        Motions::new(&self.file.groups, &self.nodes.borrow(), self.file.meta.origin)
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
