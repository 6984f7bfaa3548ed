//! One scene put into another.

use super::brep::Brep;
use super::{InstancedMesh, Scene, SceneError, rig};
use glam::{DAffine3, DVec3, Vec3, Vec3A};
use rebounce_shared::light::Light;
use rebounce_shared::rbn::MAX_MATERIALS;
use rebounce_shared::rbn::groups::MAX_GROUPS;
use rebounce_shared::rbn::meta::{DetailTexture, Material, Property};
use std::sync::Arc;

impl Scene {
    /// Puts another scene into this one, its world's origin at `at`, world space: surfaces, lamps, groups,
    /// animations and what they deform. Its
    /// cameras come along where this scene has none. An environment stays behind, with a note: that of this scene counts.
    ///
    /// # Errors
    /// [`SceneError`] if materials or reconstruction groups are too many together.
    pub fn add(&mut self, mut other: Self, at: DVec3) -> Result<(), SceneError> {
        let (materials, textures) = (self.materials.len(), self.textures.len() as u32);
        if let Some(first) = self.materials.iter().chain(&other.materials).nth(MAX_MATERIALS) {
            return Err(SceneError::TooManyMaterials {
                file: other.name,
                count: materials + other.materials.len(),
                limit: MAX_MATERIALS,
                name: first.name.clone(),
            });
        }
        self.add_groups(&mut other, at)?;
        self.light_groups.resize(materials, None);
        self.light_groups.append(&mut other.light_groups);
        self.materials.extend(other.materials.drain(..).map(|material| renumbered(material, textures)));
        self.textures.append(&mut other.textures);
        let shift = DVec3::from(other.origin) + at - DVec3::from(self.origin);
        let own = self.models.first().map_or(self.positions.len() as u32, |model| model.vertices.start);
        rig::add(&mut self.rig, std::mem::take(&mut other.rig), shift, own);
        self.add_triangles(&other, shift, materials as u32);
        if let Some(brep) = &other.brep {
            let mut all = self.brep.take().map(Arc::unwrap_or_clone).unwrap_or_default();
            append_brep(&mut all, brep, shift, materials as u32);
            self.brep = Some(Arc::new(all));
        }
        self.add_lights(&mut other, at);
        if self.cameras.is_empty() {
            let moved = |place: [f64; 3]| (DVec3::from(place) + at).to_array();
            for camera in &mut other.cameras {
                camera.position = moved(camera.position);
                camera.target = moved(camera.target);
            }
            self.cameras = other.cameras;
            self.camera_names = other.camera_names;
        }
        let told = |sentence: String| format!("{}: {sentence}", other.name);
        self.left_out.extend(other.left_out.into_iter().map(told));
        self.notes.extend(other.notes.into_iter().map(told));
        self.degenerate_triangles += other.degenerate_triangles;
        Ok(())
    }

    /// Adds vertices and triangles; models stay at the end of both.
    fn add_triangles(&mut self, other: &Self, shift: DVec3, materials: u32) {
        // Where the models of either begin.
        let starts = |scene: &Self| {
            let first = scene.models.first();
            let end = (scene.positions.len() as u32, scene.triangles.len() as u32);
            first.map_or(end, |model| (model.vertices.start, model.triangles.start))
        };
        let ((own_vertices, own_triangles), (vertices, triangles)) = (starts(self), starts(other));
        let (all_vertices, all_triangles) = (self.positions.len() as u32, self.triangles.len() as u32);
        // This scene's triangles, the other's, this scene's models, the other's.
        let position = |p: &Vec3| (p.as_dvec3() + shift).as_vec3();
        let [lone, modelled] = [0..vertices as usize, vertices as usize..other.positions.len()];
        let at = own_vertices as usize;
        insert(&mut self.positions, at, other.positions[lone.clone()].iter().map(position));
        insert(&mut self.normals, at, other.normals[lone.clone()].iter().copied());
        insert(&mut self.uvs, at, other.uvs[lone].iter().copied());
        self.positions.extend_from_slice(&other.positions[modelled.clone()]);
        self.normals.extend_from_slice(&other.normals[modelled.clone()]);
        self.uvs.extend_from_slice(&other.uvs[modelled]);
        for index in self.triangles[own_triangles as usize..].iter_mut().flatten() {
            *index += vertices;
        }
        let [lone, modelled] = [0..triangles as usize, triangles as usize..other.triangles.len()];
        let at = own_triangles as usize;
        let moved = |by: u32| move |t: &[u32; 3]| t.map(|index| index + by);
        insert(&mut self.triangles, at, other.triangles[lone.clone()].iter().map(moved(own_vertices)));
        // Vertices of the other's models follow all of this scene's and the other's lone ones.
        self.triangles.extend(other.triangles[modelled.clone()].iter().map(moved(all_vertices)));
        let number = |material: &u32| material + materials;
        let colors = (!self.corner_colors.is_empty() || !other.corner_colors.is_empty()).then(|| {
            let [mut own, mut more] = [(&*self, all_triangles), (other, other.triangles.len() as u32)]
                .map(|(scene, count)| colors_of(scene, count as usize));
            let rest = own.split_off(at);
            let last = more.split_off(triangles as usize);
            [own, more, rest, last].concat()
        });
        insert(&mut self.triangle_material, at, other.triangle_material[lone].iter().map(number));
        self.triangle_material.extend(other.triangle_material[modelled].iter().map(number));
        self.corner_colors = colors.unwrap_or_default();
        for model in &mut self.models {
            model.vertices = model.vertices.start + vertices..model.vertices.end + vertices;
            model.triangles = model.triangles.start + triangles..model.triangles.end + triangles;
        }
        self.models.extend(other.models.iter().map(|model| {
            let mut local_from_model = model.local_from_model.clone();
            for place in &mut local_from_model {
                place.translation = Vec3A::from((place.translation.as_dvec3() + shift).as_vec3());
            }
            InstancedMesh {
                vertices: model.vertices.start + all_vertices..model.vertices.end + all_vertices,
                triangles: model.triangles.start + all_triangles..model.triangles.end + all_triangles,
                local_from_model,
                bounds: model.bounds,
            }
        }));
    }

    /// Adds lamps and their animations.
    fn add_lights(&mut self, other: &mut Self, at: DVec3) {
        self.light_names.resize(self.lights.len(), String::new());
        let names = std::mem::take(&mut other.light_names);
        let mut numbers = vec![None; other.lights.len()];
        for (number, mut light) in other.lights.drain(..).enumerate() {
            match &mut light {
                Light::Point { position, .. }
                | Light::Spot { position, .. }
                | Light::Rectangle { position, .. }
                | Light::Disk { position, .. }
                | Light::Sphere { position, .. } => *position = (DVec3::from(*position) + at).to_array(),
                Light::Environment { .. } => {
                    let problem = "its environment is left out: that of the scene counts, or --environment";
                    other.left_out.push(problem.to_owned());
                    continue;
                }
                Light::Directional { .. } | Light::Emissive { .. } => {}
            }
            numbers[number] = Some(self.lights.len() as u32);
            self.lights.push(light);
            self.light_names.push(names.get(number).cloned().unwrap_or_default());
        }
        for mut animation in other.animations.drain(..) {
            animation.tracks.retain_mut(|track| {
                if track.property == Property::Position {
                    let values = track.values.as_chunks_mut::<3>().0;
                    values
                        .iter_mut()
                        .for_each(|p| *p = (DVec3::from(p.map(f64::from)) + at).as_vec3().to_array());
                }
                let number = numbers.get(track.light as usize).copied().flatten();
                track.light = number.unwrap_or(track.light);
                number.is_some()
            });
            self.animations.push(animation);
        }
    }

    /// Adds reconstruction groups, and the nodes that may move.
    fn add_groups(&mut self, other: &mut Self, at: DVec3) -> Result<(), SceneError> {
        if self.groups.is_empty() && other.groups.is_empty() {
            return Ok(());
        }
        let (nodes, groups) = (self.groups.nodes.len() as u32, self.groups.groups.len() as u32);
        let count = self.groups.groups.len() + other.groups.groups.len();
        if count > MAX_GROUPS {
            let (file, what) = (other.name.clone(), "reconstruction groups");
            return Err(SceneError::TooLarge { file, what, count, limit: MAX_GROUPS });
        }
        let all = &mut self.groups;
        all.of_material.resize(self.materials.len(), 0);
        let of_material = (0..other.materials.len() as u32).map(|m| other.groups.of_material(m));
        all.of_material.extend(of_material.map(|group| if group > 0 { group + groups } else { 0 }));
        all.nodes.extend(other.groups.nodes.drain(..).map(|mut node| {
            node.origin = (DVec3::from(node.origin) + at).to_array();
            node.parent = node.parent.map(|parent| parent + nodes);
            node
        }));
        all.groups.extend(other.groups.groups.drain(..).map(|mut group| {
            group.node = group.node.map(|node| node + nodes);
            group
        }));
        all.animations.extend(other.groups.animations.drain(..).map(|mut animation| {
            animation.tracks.iter_mut().for_each(|track| track.node += nodes);
            animation
        }));
        Ok(())
    }
}

/// Inserts items at a place.
fn insert<T>(all: &mut Vec<T>, at: usize, more: impl Iterator<Item = T>) {
    all.splice(at..at, more);
}

/// Vertex colours of a scene; without any, those of the materials.
fn colors_of(scene: &Scene, count: usize) -> Vec<[Vec3; 3]> {
    if !scene.corner_colors.is_empty() {
        return scene.corner_colors.clone();
    }
    let color = |material: &u32| {
        let [r, g, b, _] = scene.materials[*material as usize].base_color;
        [Vec3::new(r, g, b); 3]
    };
    scene.triangle_material[..count].iter().map(color).collect()
}

/// A material whose textures have numbers from `textures` on.
fn renumbered(mut material: Material, textures: u32) -> Material {
    let Material {
        base_color_texture,
        emission_texture,
        metallic_roughness_texture,
        normal_texture,
        extras,
        ..
    } = &mut material;
    *base_color_texture = base_color_texture.map(|texture| texture + textures);
    let details: [&mut Option<DetailTexture>; 4] =
        [emission_texture, metallic_roughness_texture, normal_texture, &mut extras.transmission_texture];
    details.into_iter().flatten().for_each(|detail| detail.texture += textures);
    material
}

/// Adds the faces and instances of a boundary representation, moved by `shift`.
fn append_brep(all: &mut Brep, more: &Brep, shift: DVec3, materials: u32) {
    let faces = all.faces.len() as u32;
    all.faces.extend(more.faces.iter().cloned().map(|mut face| {
        face.material += materials;
        face
    }));
    all.instances.extend(more.instances.iter().cloned().map(|mut instance| {
        instance.faces = instance.faces.start + faces..instance.faces.end + faces;
        instance.local_from_part = DAffine3::from_translation(shift) * instance.local_from_part;
        instance
    }));
}
