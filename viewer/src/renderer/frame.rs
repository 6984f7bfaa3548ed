//! The passes of a frame, in order; a pass runs only after a change of its inputs.

use super::Renderer;
use super::target::Target;
use crate::controls::gizmo;
#[cfg(feature = "radiosity")]
use crate::controls::node_gizmo;
use crate::gpu::readback::Readback;
use crate::gpu::scope::Scope;
use crate::passes::composite::{self, Shading};
use crate::passes::settings::{Mode, Overlay, ToneMapping};
use crate::passes::timing::Pass;
use crate::scene::GpuScene;
use crate::scene::blended_fit;
use crate::scene::relight::Parts;
use crate::scene::sky::MOST_SKIES;
use crate::scene::view::{Frame, Sample, frame};
use rebounce_shared::lighting::Background;
use wgpu::TextureFormat;

impl Renderer {
    /// Updates shadow maps and bounced light after changes of the lights, and of where nodes are. For a picture of this size with direct
    /// light, also updates the cascades after changes of the camera.
    pub(super) fn update_lights(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        scene: &GpuScene,
        picture: Option<[u32; 2]>,
        mode: Mode,
    ) {
        #[cfg(feature = "radiosity")]
        if let Some(moving) = &scene.moving {
            moving.upload(&self.gpu, &scene.upload);
        }
        #[cfg(feature = "radiosity")]
        if let Some((rig, pipelines)) = scene.rig.as_ref().zip(self.pipelines.rig.get()) {
            rig.encode(&self.gpu, encoder, pipelines);
        }
        let parts = Parts { bounced: mode != Mode::Direct, from_sources: mode != Mode::Indirect };
        let is_other = scene.relight.has_sources() && self.parts != parts;
        if is_other {
            scene.relight.set_parts(&self.gpu, parts);
            self.parts = parts;
        }
        let moved = std::mem::take(&mut self.dirty.lights) || is_other;
        let mut changed = Vec::new();
        if moved {
            let (near, glass) = (0.1 * scene.near, !scene.upload.glass_runs.is_empty());
            changed = self.shadows.set_lights(&self.gpu, self.lit.lamps(), &scene.extent, near, glass);
        }
        if let Some(size) = picture {
            let camera = self.camera.frame(scene.meta.origin);
            changed.extend(self.shadows.follow(&self.gpu, &camera, size, &scene.extent));
        }
        self.draw_shadows(encoder, scene, &changed);
        if moved {
            self.dirty.display = true;
            self.update_relight(encoder, scene);
            #[cfg(feature = "radiosity")]
            self.update_gloss(encoder, scene);
        }
    }

    fn draw_shadows(&mut self, encoder: &mut wgpu::CommandEncoder, scene: &GpuScene, changed: &[u32]) {
        for (i, &layer) in changed.iter().enumerate() {
            let stamps = self.timing.as_mut().filter(|_| i == 0 || i + 1 == changed.len());
            let stamps = stamps.and_then(|t| t.stamps(Pass::Shadows));
            let stamps = stamps.map(|s| s.render(i == 0, i + 1 == changed.len()));
            self.shadows.draw(&self.gpu, encoder, &scene.upload, &scene.materials.groups, layer, stamps);
        }
    }

    fn update_relight(&mut self, encoder: &mut wgpu::CommandEncoder, scene: &GpuScene) {
        let shines = self.light_sources(scene);
        #[cfg(feature = "radiosity")]
        if let Some(moving) = &scene.moving {
            moving.relit();
        }
        #[cfg(feature = "antiradiance")]
        if let Some(own) = scene.own_antiradiance() {
            own.relit(scene.is_at_rest());
        }
        if !shines && !self.shadows.lights().iter().any(|light| light.shines()) {
            scene.relight.clear(encoder);
            #[cfg(feature = "antiradiance")]
            if let Some(own) = scene.own_antiradiance() {
                own.darken(encoder);
            }
            #[cfg(feature = "radiosity")]
            self.light_cube_maps(encoder, scene, None);
            return;
        }
        let choice = self.still.choose(self.shadows.lights());
        scene.relight.set_lights(&self.gpu, &choice);
        self.lights_evaluated += choice.count() as u64;
        let stamps = self.timing.as_mut().and_then(|timing| timing.stamps(Pass::Relight));
        #[cfg(feature = "antiradiance")]
        let is_done = {
            let with = (&*self.pipelines, &self.shadows, &self.lit);
            let both = [true, false].map(|begins| stamps.as_ref().map(|s| s.compute(begins, !begins)));
            super::moving::relight_beside(&self.gpu, encoder, scene, with, both)
        };
        #[cfg(not(feature = "antiradiance"))]
        let is_done = false;
        if !is_done {
            let stamps = stamps.map(|stamps| stamps.compute(true, true));
            scene.relight.encode(encoder, &self.pipelines.relight, Some(self.shadows.group()), stamps);
        }
        self.relights += 1;
        #[cfg(feature = "radiosity")]
        self.light_cube_maps(encoder, scene, Some(self.shadows.group()));
        #[cfg(feature = "radiosity")]
        if let Some((moving, pipelines)) = super::moving::solving(&self.pipelines, scene) {
            moving.show(&self.gpu, encoder, pipelines, &scene.relight);
        }
    }

    /// Draws the changed parts of the interactive picture, or a further picture for its average.
    pub(super) fn update_picture(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        scene: &GpuScene,
        target: &mut Target,
    ) {
        let moved = self.dirty.view || self.dirty.display;
        if moved || self.dirty.shade || self.dirty.key {
            // After averaging, the G-buffer holds a shifted picture.
            if self.dirty.view || self.pictures > 1 {
                self.draw_view(encoder, scene, target, Sample::of(0), true);
            } else if self.dirty.display {
                self.gather(encoder, scene, target, true);
            }
            let blended = self.update_key(encoder, scene, target, true);
            self.shade(encoder, scene, target, 0, !blended, true);
            self.pictures = 1;
        } else if !self.dirty.present && self.pictures < self.still_pictures {
            self.draw_view(encoder, scene, target, Sample::of(self.pictures), true);
            self.shade(encoder, scene, target, self.pictures, true, true);
            self.pictures += 1;
        }
    }

    /// Measures the automatic exposure from the G-buffer, if the exposure is in use and may have changed. Submits
    /// the commands in `encoder`: the picture's own settings must come later. Returns true if the blended surfaces
    /// were drawn with the picture's settings.
    pub(super) fn update_key(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        scene: &GpuScene,
        target: &Target,
        timed: bool,
    ) -> bool {
        if !std::mem::take(&mut self.dirty.key) || !self.auto_exposure {
            return false;
        }
        let shading = Shading { direct: 1.0, indirect: 1.0, ..self.shading(1.0) };
        self.pipelines.composite.set_shading(&self.gpu, &target.picture, &shading);
        self.draw_blended(encoder, scene, target, timed);
        self.pipelines.composite.measure(encoder, &target.picture, self.shadows.group());
        let fresh = self.gpu.device.create_command_encoder(&Default::default());
        self.gpu.queue.submit([std::mem::replace(encoder, fresh).finish()]);
        if self.key_wanted {
            self.measured = Some(Readback::buffer(&self.gpu, &self.key.0));
        }
        self.mode == Mode::All
    }

    /// Draws the G-buffer and bounced light of a picture of a series.
    pub(super) fn draw_view(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        scene: &GpuScene,
        target: &mut Target,
        sample: Sample,
        timed: bool,
    ) {
        // Pictures for reading back may have any size.
        let way = if timed { self.choice.of_size(target.screen_pixels()) } else { self.choice.way() };
        target.set_way(&self.gpu, &self.pipelines, scene, way);
        self.way = target.display.way();
        self.viewed |= timed;
        let camera = frame(&self.camera, scene.meta.origin, target.size);
        let open_reach = if self.detail { scene.open_reach } else { 0.0 };
        let frame = Frame { open_reach, ..Frame::new(&camera, scene.near, target.size, sample) };
        self.gpu.queue.write_buffer(&target.frame, 0, bytemuck::bytes_of(&frame));
        let timing = self.timing.as_mut().filter(|_| timed);
        let stamps = timing.and_then(|t| t.stamps(Pass::GBuffer)).map(|s| s.render(true, true));
        self.pipelines.gbuffer.draw(
            &self.gpu,
            encoder,
            &target.gbuffer,
            &target.frame_group,
            &scene.upload,
            &scene.materials.groups,
            stamps,
        );
        #[cfg(feature = "radiosity")]
        if let Some(rig) = &scene.rig {
            let frame = (&target.frame_group, &self.pipelines.gbuffer.frame_layout);
            self.pipelines.rest_places.draw(&self.gpu, encoder, &target.gbuffer, frame, &scene.upload, rig);
        }
        if shows_points(scene) {
            let timing = self.timing.as_mut().filter(|_| timed);
            let stamps = timing.and_then(|t| t.stamps(Pass::Find));
            self.pipelines.display.find(&self.gpu, encoder, &target.display, stamps);
        }
        self.gather(encoder, scene, target, timed);
    }

    fn gather(&mut self, encoder: &mut wgpu::CommandEncoder, scene: &GpuScene, target: &Target, timed: bool) {
        if shows_points(scene) {
            let timing = self.timing.as_mut().filter(|_| timed);
            let stamps = timing.and_then(|t| t.stamps(Pass::Gather));
            self.pipelines.display.gather(&self.gpu, encoder, &target.display, stamps);
        }
        #[cfg(feature = "radiosity")]
        if let Some((lightmap, to)) = scene.lightmap.as_ref().zip(target.lightmap.as_ref()) {
            let (upload, gbuffer) = (&scene.upload, &target.gbuffer);
            let frame = (&target.frame_group, &self.pipelines.gbuffer.frame_layout);
            self.pipelines.lightmap.draw(&self.gpu, encoder, to, gbuffer, frame, upload, lightmap);
        }
        #[cfg(feature = "radiosity")]
        self.draw_reflections(encoder, scene, target);
    }

    /// Draws the layers of blended surfaces with the picture's settings; no effect without blended surfaces.
    pub(super) fn draw_blended(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        scene: &GpuScene,
        target: &Target,
        timed: bool,
    ) {
        let Some(blended) = &target.blended else { return };
        let timing = self.timing.as_mut().filter(|_| timed);
        let stamps = timing.and_then(|t| t.stamps(Pass::Blended));
        self.pipelines.blended.draw(&self.gpu, encoder, blended, scene, self.shadows.group(), stamps);
        self.blended_layers += scene.upload.blended_layers as u64;
    }

    /// Shades picture `picture` of a series and averages the result with the earlier pictures; `blended` draws
    /// blended surfaces first.
    pub(super) fn shade(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        scene: &GpuScene,
        target: &Target,
        picture: u32,
        blended: bool,
        timed: bool,
    ) {
        let shading = Shading { enlarge: target.enlarge, ..self.shading(1.0 / (picture + 1) as f32) };
        self.pipelines.composite.set_shading(&self.gpu, &target.picture, &shading);
        if blended {
            self.draw_blended(encoder, scene, target, timed);
        }
        let timing = self.timing.as_mut().filter(|_| timed);
        let stamps = timing.and_then(|t| t.stamps(Pass::Composite)).map(|s| s.render(true, true));
        self.pipelines.composite.shade(encoder, &target.picture, self.shadows.group(), stamps);
    }

    pub(super) fn shading(&self, blend: f32) -> Shading {
        let flag = |on: bool, bit| if on { bit } else { 0 };
        let scene = self.scene.as_deref();
        let detailed = scene.is_some_and(|scene| scene.materials.detailed);
        let unlit = self.mode == Mode::All && scene.is_some_and(|scene| scene.materials.unlit);
        let backdrop = self.backdrop
            && self.mode == Mode::All
            && self.lit.lighting.background.is_empty()
            && scene.is_some_and(|scene| !scene.meta.shown.ground.is_empty());
        // Direct light is then a part of what the points hold.
        let from_sources = scene.is_some_and(|scene| scene.relight.has_sources());
        let scale = self.lit.sky.as_ref().map_or(0.0, |sky| sky.scale);
        let skies = if self.mode == Mode::Indirect { Vec::new() } else { self.skies(scale) };
        #[cfg(feature = "radiosity")]
        let charted = flag(scene.is_some_and(|scene| scene.lightmap.is_some()), composite::CHARTED);
        #[cfg(feature = "radiosity")]
        let charted = charted
            | flag(
                self.mode == Mode::All && scene.and_then(GpuScene::reflecting).is_some(),
                composite::GLOSSY,
            );
        #[cfg(not(feature = "radiosity"))]
        let charted = 0;
        let veiled = scene.filter(|scene| scene.upload.blended_layers > 0);
        Shading {
            direct: (self.mode != Mode::Indirect) as u32 as f32,
            indirect: (self.mode != Mode::Direct || from_sources) as u32 as f32,
            lights: self.lit.lamps().len() as u32,
            exposure: self.exposure.exp2(),
            blend,
            scale: 1,
            flags: charted
                | flag(detailed, composite::DETAILED)
                | flag(self.tone_mapping == ToneMapping::Agx, composite::AGX)
                | flag(!self.auto_exposure, composite::MANUAL)
                | flag(veiled.is_some(), composite::VEILED)
                | flag(veiled.is_some_and(|scene| scene.upload.tinted), composite::TINTED)
                | flag(unlit, composite::UNLIT)
                | flag(backdrop, composite::BACKDROP)
                // A single picture, or the mean of two.
                | flag(self.antialias && blend > 0.4, composite::SMOOTH),
            enlarge: 1,
            unit: veiled
                .map_or(1.0, |scene| blended_fit::unit(&scene.meta, &self.lit.lighting, scene.extent.all)),
            skies: skies.len() as u32,
            sky_level: self.lit.sky.as_ref().map_or(0.0, |sky| sky.level(self.lit.blur)),
            pad: 0,
            sky: std::array::from_fn(|i| skies.get(i).copied().unwrap_or_default()),
        }
    }

    /// Factor of each sky for a texture of this scale, and its rotation in radians.
    pub(super) fn skies(&self, scale: f32) -> Vec<[f32; 4]> {
        let sky = |of: &Background| (of.factor * scale).extend(of.rotation_deg.to_radians()).to_array();
        self.lit.lighting.background.iter().take(MOST_SKIES).map(sky).collect()
    }

    pub(super) fn draw_overlay(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        scene: &GpuScene,
        target: &Target,
        view: &wgpu::TextureView,
        format: TextureFormat,
        size: [u32; 2],
    ) {
        // A sketch's depth has a size different from the screen's.
        let dots = self.overlay != Overlay::None && target.enlarge == 1;
        let handles = self.has_handles();
        if !dots && !handles {
            return;
        }
        let pass = self.pipelines.overlay(&self.gpu, format);
        let own = Scope::new(&self.gpu);
        if dots {
            let levels: Vec<_> = scene.levels.iter().cloned().enumerate().collect();
            let first = if self.overlay == Overlay::Points { levels.len().saturating_sub(1) } else { 0 };
            let depth = &target.gbuffer.depth;
            let points = &scene.upload.points;
            pass.draw_points(&own, encoder, view, depth, &target.frame, points, &levels[first..]);
        }
        if handles {
            let stage = self.stage(size);
            let shapes = gizmo::shapes(&stage, self.marks);
            #[cfg(feature = "radiosity")]
            let shapes = [node_gizmo::shapes(&stage, self.marks.node), shapes].concat();
            pass.draw_gizmos(&own, encoder, view, size, &shapes);
        }
        self.over = Some(own);
    }
}

/// Whether pixels of opaque surfaces show the light of points: not where a lightmap has all surfaces.
#[cfg(feature = "radiosity")]
fn shows_points(scene: &GpuScene) -> bool {
    scene.lightmap.as_ref().is_none_or(|lightmap| !lightmap.is_whole)
}

/// Without lightmaps all of them do.
#[cfg(not(feature = "radiosity"))]
fn shows_points(_: &GpuScene) -> bool {
    true
}
