//! Direct light at places that are not the file's points, by the same kernel and of the same lights.

use super::plan::{Kernel, Step};
use super::{Dispatch, Relight, RelightPipelines};
use crate::gpu::bindings::{buffer, empty_buffer, group, part};
use crate::gpu::scope::Scope;
use rebounce_shared::rbn::bulk::Point;
use wgpu::BufferUsages;

/// Direct light at some places.
pub struct DirectElsewhere {
    /// The places, as points with footprints.
    pub points: wgpu::Buffer,
    /// Irradiance from lamps, RGB.
    pub irradiance: wgpu::Buffer,
    group: wgpu::BindGroup,
    groups: [u32; 2],
}

impl DirectElsewhere {
    /// For these places; of a point with radius 0 the light is not of use.
    pub fn new(own: &Scope, pipelines: &RelightPipelines, relight: &Relight, points: &[Point]) -> Self {
        let storage = BufferUsages::STORAGE | BufferUsages::COPY_DST;
        let place = buffer(own, "places", storage, bytemuck::cast_slice(points));
        let colours = |label| empty_buffer(own, label, storage, 16 * points.len() as u64);
        let (still, irradiance) = (colours("still"), colours("irradiance"));
        let dispatch = Dispatch::threads(Kernel::Direct, 0, points.len());
        let step = buffer(own, "step", BufferUsages::UNIFORM, bytemuck::bytes_of(&dispatch.step));
        let mut resources = vec![part(&step, size_of::<Step>() as u64)];
        let buffers = [&place, &relight.choice, &still, &irradiance];
        resources.extend(buffers.iter().map(|buffer| buffer.as_entire_binding()));
        let group = group(own, "direct", &pipelines.direct.0, &resources);
        Self { points: place, irradiance, group, groups: dispatch.groups }
    }

    /// Evaluates the lights that [`Relight::set_lights`] has set: after every evaluation at the points, as what lights give
    /// that stand still is kept.
    pub fn encode(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        pipelines: &RelightPipelines,
        lights: &wgpu::BindGroup,
    ) {
        pass.set_pipeline(&pipelines.direct.1);
        pass.set_bind_group(0, &self.group, &[0]);
        pass.set_bind_group(1, lights, &[]);
        pass.dispatch_workgroups(self.groups[0], self.groups[1], 1);
    }

    /// Sets the light to zero: no lamp is on.
    pub fn clear(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.clear_buffer(&self.irradiance, 0, None);
    }
}
