//! Meshes that deform, on the GPU: vertices and points follow the pose ([`rebounce_shared::rig`]).
//!
//! * here: buffers, and the pose;
//! * `pipelines` – the compute pipelines.
//!
//! Pictures and shadow maps draw the deformed vertices. Points ride on their triangles, so that direct light at them is that of
//! the pose. A pixel of a mesh that deforms looks up the functions where the file has it ([`crate::passes::rest_places`]): bounced
//! light is computed with links of the pose at rest.

mod pipelines;

pub use pipelines::RigPipelines;

use super::upload::Upload;
use crate::gpu::Gpu;
use crate::gpu::bindings::{WORKGROUP, buffer, empty_buffer, grid, group};
use crate::gpu::scope::Scope;
use crate::scene::draw_batch::DrawBatch;
use bytemuck::{Pod, Zeroable};
use rebounce_shared::baked::BakedScene;
#[cfg(feature = "antiradiance")]
use rebounce_shared::glam::Vec3;
use rebounce_shared::rbn::bulk::Instance;
#[cfg(feature = "antiradiance")]
use rebounce_shared::rig::RigPoint;
use rebounce_shared::rig::pose::Pose;
#[cfg(feature = "antiradiance")]
use rebounce_shared::rig::skin::{ridden, skinned};
use rebounce_shared::rig::{Rig, RigAnimation};
use std::cell::{Cell, RefCell};
#[cfg(feature = "antiradiance")]
use std::collections::{HashMap, HashSet};
use wgpu::BufferUsages;

/// `RigPass` in rig.wgsl.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
struct RigPass {
    first: u32,
    count: u32,
    first_delta: u32,
    targets: u32,
    first_weight: u32,
    first_matrix: u32,
    pad: [u32; 2],
}

/// The rig of a scene.
pub struct GpuRig {
    /// Vertices where the file has them: section `VERT`.
    pub rest_vertices: wgpu::Buffer,
    /// Points where they are in the pose: direct light is that of these.
    pub points: wgpu::Buffer,
    /// Points where the nodes of their groups are.
    moved: wgpu::Buffer,
    /// Draw calls with triangles that deform, without those of blended materials.
    pub runs: Vec<DrawBatch>,
    rig: Rig,
    /// What is on the GPU, once [`Self::encode`] has been called.
    pose: RefCell<Pose>,
    /// Animation of the pose, and its time in seconds; `None` at rest.
    moment: Cell<Option<(usize, f64)>>,
    is_stale: Cell<bool>,
    matrices: wgpu::Buffer,
    weights: wgpu::Buffer,
    /// By mesh: its bind group and number of vertices.
    meshes: Vec<(wgpu::BindGroup, u32)>,
    /// Bind group of the points, if any ride.
    riders: Option<(wgpu::BindGroup, u32)>,
    own: Scope,
}

impl GpuRig {
    /// Prepares the rig of a scene; `moved` are the points where the nodes of their groups are. `None` where nothing deforms.
    pub fn new(
        gpu: &Gpu,
        pipelines: impl FnOnce() -> RigPipelines,
        upload: &Upload,
        moved: &wgpu::Buffer,
        scene: &BakedScene,
    ) -> Option<Self> {
        let rig = &scene.rig;
        if rig.is_empty() {
            return None;
        }
        let pipelines = pipelines();
        let own = Scope::new(gpu);
        let stored = |label, content: &[u8]| buffer(&own, label, BufferUsages::STORAGE, content);
        let points = super::moving::points(&own, scene);
        let binds = stored("RIGV", bytemuck::cast_slice(&rig.vertices));
        let deltas = stored("RIGM", bytemuck::cast_slice(&rig.deltas));
        let storage = BufferUsages::STORAGE | BufferUsages::COPY_DST;
        let pose = Pose::rest(rig);
        let matrices = empty_buffer(&own, "joint matrices", storage, size_of_val(&pose.matrices[..]) as u64);
        let weights = empty_buffer(&own, "morph weights", storage, size_of_val(&pose.weights[..]) as u64);
        let uniform = |pass: RigPass| buffer(&own, "rig", BufferUsages::UNIFORM, bytemuck::bytes_of(&pass));
        let (mut first_matrix, mut first_weight) = (0, 0);
        let mut meshes = Vec::with_capacity(rig.layout.meshes.len());
        for mesh in &rig.layout.meshes {
            let pass = RigPass {
                first: mesh.first_vertex,
                count: mesh.vertex_count,
                first_delta: mesh.first_delta,
                targets: mesh.weights.len() as u32,
                first_weight,
                first_matrix,
                pad: [0; 2],
            };
            let resources = [&uniform(pass), &binds, &deltas, &matrices, &weights, &upload.vertices];
            let resources = resources.map(wgpu::Buffer::as_entire_binding);
            meshes.push((group(gpu, "skin", &pipelines.skin.0, &resources), mesh.vertex_count));
            first_matrix += mesh.matrix_count() as u32;
            first_weight += mesh.weights.len() as u32;
        }
        let riders = (!rig.points.is_empty()).then(|| {
            let count = rig.points.len() as u32;
            let records = stored("RIGP", bytemuck::cast_slice(&rig.points));
            let resources = [
                &uniform(RigPass { count, ..RigPass::default() }),
                &binds,
                &records,
                &upload.vertices,
                &points,
            ];
            let resources = resources.map(wgpu::Buffer::as_entire_binding);
            (group(gpu, "ride", &pipelines.ride.0, &resources), count)
        });
        Some(Self {
            rest_vertices: buffer(
                &own,
                "VERT at rest",
                BufferUsages::VERTEX,
                bytemuck::cast_slice(&scene.vertices),
            ),
            runs: runs(scene, upload),
            points,
            moved: moved.clone(),
            rig: rig.clone(),
            pose: pose.into(),
            moment: None.into(),
            is_stale: false.into(),
            matrices,
            weights,
            meshes,
            riders,
            own,
        })
    }

    /// Animations of the rig.
    pub fn animations(&self) -> &[RigAnimation] {
        &self.rig.layout.animations
    }

    /// Poses the rig as an animation has it at a time, seconds; at rest without one. Returns whether that is another pose.
    pub fn pose(&self, animation: Option<usize>, time: f64) -> bool {
        self.moment.set(animation.map(|number| (number, time)));
        let animation = animation.and_then(|number| self.animations().get(number));
        let pose =
            animation.map_or_else(|| Pose::rest(&self.rig), |found| Pose::of(&self.rig, found, time as f32));
        let changes = *self.pose.borrow() != pose;
        if changes {
            self.pose.replace(pose);
            self.is_stale.set(true);
        }
        changes
    }

    /// Animation of the pose, and its time in seconds; `None` at rest.
    pub fn moment(&self) -> Option<(usize, f64)> {
        self.moment.get()
    }

    /// Positions and normals in the pose of the points that ride, by their numbers; local space.
    #[cfg(feature = "antiradiance")]
    pub fn ridden(&self) -> HashMap<usize, [Vec3; 2]> {
        let at = skinned(&self.rig, &self.pose.borrow());
        let place = |rider: &RigPoint| {
            let on = ridden(rider, &at);
            (rider.point as usize, [on.position, on.normal])
        };
        self.rig.points.iter().map(place).collect()
    }

    /// Numbers of the vertices that deform.
    #[cfg(feature = "antiradiance")]
    pub fn deforming(&self) -> HashSet<u32> {
        self.rig.vertices.iter().map(|vertex| vertex.vertex).collect()
    }

    /// Lets points follow again: nodes have moved.
    pub fn renew(&self) {
        self.is_stale.set(true);
    }

    /// Encodes what follows the pose, if it has changed: vertices, then points.
    pub fn encode(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, pipelines: &RigPipelines) {
        if !self.is_stale.take() {
            return;
        }
        let pose = self.pose.borrow();
        gpu.queue.write_buffer(&self.matrices, 0, bytemuck::cast_slice::<Instance, u8>(&pose.matrices));
        if !pose.weights.is_empty() {
            gpu.queue.write_buffer(&self.weights, 0, bytemuck::cast_slice(&pose.weights));
        }
        encoder.copy_buffer_to_buffer(&self.moved, 0, &self.points, 0, self.points.size());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        let mut dispatch = |pipeline: &wgpu::ComputePipeline, group: &wgpu::BindGroup, count: u32| {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, group, &[]);
            let [x, y] = grid(count.div_ceil(WORKGROUP));
            pass.dispatch_workgroups(x, y, 1);
        };
        for (group, count) in &self.meshes {
            dispatch(&pipelines.skin.1, group, *count);
        }
        if let Some((group, count)) = &self.riders {
            dispatch(&pipelines.ride.1, group, *count);
        }
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.own.bytes()
    }
}

/// Draw calls with a triangle that deforms.
fn runs(scene: &BakedScene, upload: &Upload) -> Vec<DrawBatch> {
    let numbers = scene.rig.numbers(scene.vertices.len());
    let has_one = |run: &&DrawBatch| {
        let indices = &scene.indices[run.indices.start as usize..run.indices.end as usize];
        indices.iter().any(|index| numbers[*index as usize].is_some())
    };
    upload.runs.iter().filter(has_one).cloned().collect()
}
