//! A .glb file of meshes with light: nodes, meshes, materials and textures.

use super::develop::Developed;
use super::glb::Buffer;
use super::materials;
use super::meshes::ExportMesh;
use super::unwrap::{UnwrappedMesh, UvAtlas};
use super::vertices::VertexLight;
use super::{ExportError, ExportSettings, Form};
use crate::geometry::mesh::TriangleSurfaces;
use crate::geometry::mesh::geometry::Surface;
use glam::{Affine3A, Mat4, Vec2, Vec3, Vec4Swizzles};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::camera::Camera;
use rebounce_shared::rbn::meta::Alpha;
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};

/// Alpha below which a texel of light cuts out, where the material cuts out: half of the texel is there.
const HALF: f32 = 0.5;
/// Least mean colour by which light is divided.
const LEAST: f32 = 1.0 / 255.0;

/// Builder of the file.
pub(super) struct ExportDocument<'a> {
    scene: &'a BakedScene,
    form: Form,
    buffer: Buffer,
    meshes: Vec<Value>,
    nodes: Vec<Value>,
    cameras: Vec<Value>,
    images: Vec<Value>,
    textures: Vec<Value>,
    samplers: Vec<Value>,
    materials: Vec<Value>,
    used: BTreeSet<&'static str>,
    /// The file's number of each texture of the scene so far.
    texture_numbers: BTreeMap<u32, usize>,
    extras: Value,
}

impl<'a> ExportDocument<'a> {
    /// A file without meshes.
    pub fn new(scene: &'a BakedScene, settings: &ExportSettings, camera: Option<&Camera>) -> Self {
        let (form, unit) = match settings.form {
            Form::Unlit => ("unlit", "displayed colour"),
            Form::LightmapTexture => ("lightmap texture", "irradiance"),
            Form::VertexColours => ("vertex colours", "displayed colour"),
        };
        let mut extras = json!({ "form": form, "light": unit });
        if settings.form != Form::LightmapTexture {
            extras["exposure"] = settings.exposure.into();
        }
        let mut out = Self {
            scene,
            form: settings.form,
            buffer: Buffer::default(),
            meshes: Vec::new(),
            nodes: Vec::new(),
            cameras: Vec::new(),
            images: Vec::new(),
            textures: Vec::new(),
            samplers: Vec::new(),
            materials: Vec::new(),
            used: BTreeSet::new(),
            texture_numbers: BTreeMap::new(),
            extras,
        };
        if let Some(camera) = camera {
            let frame = camera.frame(scene.meta.origin);
            let view = [frame.right, frame.up, -frame.forward].map(|axis| axis.extend(0.0));
            let matrix = Mat4::from_cols(view[0], view[1], view[2], frame.eye.extend(1.0));
            out.cameras.push(json!({ "type": "perspective", "perspective": {
                "yfov": camera.yfov_deg.to_radians(), "znear": near(scene)
            } }));
            out.nodes.push(json!({ "name": "camera", "camera": 0, "matrix": matrix.to_cols_array() }));
        }
        out
    }

    /// Adds the texture of displayed colours, a PNG; before the meshes.
    pub fn set_atlas(&mut self, png: &[u8]) {
        let view = self.buffer.view(png, None);
        self.images.push(json!({ "name": "light", "mimeType": "image/png", "bufferView": view }));
        self.samplers.push(materials::light_sampler());
        self.textures.push(json!({ "source": self.images.len() - 1, "sampler": self.samplers.len() - 1 }));
    }

    /// Adds meshes with coordinates in a texture of light as TEXCOORD_1.
    pub fn add_unwrapped(&mut self, meshes: &[ExportMesh], atlas: &UvAtlas, emission: &[[f32; 3]]) {
        for (i, strength) in emission.iter().enumerate() {
            let material = match self.form {
                Form::Unlit if !self.scene.meta.materials[i].extras.unlit => self.atlas_material(i),
                _ => self.original(i, *strength),
            };
            self.materials.push(material);
        }
        for (mesh, unwrapped) in meshes.iter().zip(&atlas.meshes) {
            let UnwrappedMesh { vertices, triangles, rects } = unwrapped;
            let of = |source: u32| source as usize;
            let positions: Vec<[f32; 3]> = vertices.iter().map(|v| mesh.positions[of(v.source)]).collect();
            let normals: Vec<[f32; 3]> =
                vertices.iter().map(|v| mesh.normals[of(v.source)].to_array()).collect();
            let uvs: Vec<[f32; 2]> = vertices.iter().map(|v| mesh.uvs[of(v.source)]).collect();
            let mut attributes = json!({
                "POSITION": self.buffer.vectors(&positions, true),
                "NORMAL": self.buffer.vectors(&normals, false),
                "TEXCOORD_0": self.buffer.vectors(&uvs, false),
            });
            let runs = self.runs(mesh, triangles);
            for (rect, place) in rects.iter().zip(&mesh.local_from_model) {
                let uvs: Vec<[f32; 2]> = vertices.iter().map(|v| rect.place(v.uv)).collect();
                attributes["TEXCOORD_1"] = self.buffer.vectors(&uvs, false).into();
                self.add_mesh(mesh, place, &attributes, &runs);
            }
        }
    }

    /// Adds meshes with light by vertex as COLOR_0. A colour is that of the light on the material, without the texture,
    /// whose mean is divided out.
    pub fn add_coloured(
        &mut self,
        meshes: &[ExportMesh],
        light: &[Vec<VertexLight>],
        surfaces: &TriangleSurfaces,
        developed: Developed,
    ) {
        for i in 0..self.scene.meta.materials.len() {
            let material = match self.scene.meta.materials[i].extras.unlit {
                true => self.original(i, [1.0; 3]),
                false => self.coloured_material(i),
            };
            self.materials.push(material);
        }
        for (mesh, copies) in meshes.iter().zip(light) {
            let mut material_of = vec![0; mesh.positions.len()];
            for (triangle, material) in mesh.triangles.iter().zip(&mesh.materials) {
                triangle.iter().for_each(|vertex| material_of[*vertex as usize] = *material);
            }
            let normals: Vec<[f32; 3]> = mesh.normals.iter().map(|normal| normal.to_array()).collect();
            let mut attributes = json!({
                "POSITION": self.buffer.vectors(&mesh.positions, true),
                "NORMAL": self.buffer.vectors(&normals, false),
                "TEXCOORD_0": self.buffer.vectors(&mesh.uvs, false),
            });
            let runs = self.runs(mesh, &mesh.triangles);
            for (light, place) in copies.iter().zip(&mesh.local_from_model) {
                let colour = |v: usize| {
                    let (value, surface) = (light[v], surfaces.material(material_of[v]));
                    let shown = developed.colour(value.xyz()) / mean_colour(surface, mesh.uvs[v].into());
                    let alpha = if surface.texture.is_some() { 1.0 } else { value.w };
                    let shown = if surface.is_unlit { Vec3::ONE } else { shown.clamp(Vec3::ZERO, Vec3::ONE) };
                    shown.extend(if surface.is_opaque() || surface.is_unlit { 1.0 } else { alpha }).to_array()
                };
                let colours: Vec<[f32; 4]> = (0..mesh.positions.len()).map(colour).collect();
                attributes["COLOR_0"] = self.buffer.vectors(&colours, false).into();
                self.add_mesh(mesh, place, &attributes, &runs);
            }
        }
    }

    /// Returns materials and index accessors of a mesh's primitives.
    fn runs(&mut self, mesh: &ExportMesh, triangles: &[[u32; 3]]) -> Vec<(u32, usize)> {
        let runs = mesh.runs().into_iter();
        runs.map(|(material, range)| (material, self.buffer.triangles(&triangles[range]))).collect()
    }

    fn add_mesh(&mut self, mesh: &ExportMesh, place: &Affine3A, attributes: &Value, runs: &[(u32, usize)]) {
        let primitive = |(material, indices): &(u32, usize)| json!({ "attributes": attributes, "indices": indices, "material": material });
        let primitives: Vec<Value> = runs.iter().map(primitive).collect();
        self.meshes.push(json!({ "primitives": primitives }));
        let mut node = json!({ "mesh": self.meshes.len() - 1 });
        if mesh.is_model {
            node["matrix"] = json!(Mat4::from(*place).to_cols_array());
        }
        self.nodes.push(node);
    }

    /// Returns a material that shows the texture of light.
    fn atlas_material(&mut self, number: usize) -> Value {
        let material = &self.scene.meta.materials[number];
        let alpha = match material.alpha {
            Alpha::Mask { .. } => Alpha::Mask { cutoff: HALF },
            _ if material.is_glass() => Alpha::Blend,
            alpha => alpha,
        };
        self.used.insert("KHR_materials_unlit");
        let texture = json!({ "index": 0, "texCoord": 1 });
        materials::unlit(&material.name, [1.0; 4], Some(texture), alpha)
    }

    /// Returns a material that shows the base-colour texture times COLOR_0.
    fn coloured_material(&mut self, number: usize) -> Value {
        let material = &self.scene.meta.materials[number];
        let texture = material.base_color_texture.map(|texture| json!({ "index": self.texture(texture) }));
        let alpha = if material.is_glass() { Alpha::Blend } else { material.alpha };
        self.used.insert("KHR_materials_unlit");
        let factor = if texture.is_some() { material.base_color[3] } else { 1.0 };
        materials::unlit(&material.name, [1.0, 1.0, 1.0, factor], texture, alpha)
    }

    fn original(&mut self, number: usize, strength: [f32; 3]) -> Value {
        let material = &self.scene.meta.materials[number];
        let mut used = std::mem::take(&mut self.used);
        let out = materials::original(material, strength, |texture| self.texture(texture), &mut used);
        self.used.append(&mut used);
        out
    }

    /// Returns the file's number of a texture of the scene, which is added if need be.
    fn texture(&mut self, number: u32) -> usize {
        if let Some(known) = self.texture_numbers.get(&number) {
            return *known;
        }
        let meta = &self.scene.meta.textures[number as usize];
        let view = self.buffer.view(self.scene.texture(number as usize), None);
        self.images.push(json!({ "name": meta.name, "mimeType": meta.mime, "bufferView": view }));
        self.samplers.push(materials::sampler(meta));
        let (source, sampler) = (self.images.len() - 1, self.samplers.len() - 1);
        self.textures.push(match meta.mime.as_str() {
            "image/webp" => {
                self.used.insert("EXT_texture_webp");
                json!({ "sampler": sampler, "extensions": { "EXT_texture_webp": { "source": source } } })
            }
            _ => json!({ "source": source, "sampler": sampler }),
        });
        self.texture_numbers.insert(number, self.textures.len() - 1);
        self.textures.len() - 1
    }

    /// Returns the bytes of the file.
    ///
    /// # Errors
    /// [`ExportError::TooLarge`].
    pub fn finish(mut self) -> Result<Vec<u8>, ExportError> {
        let children: Vec<usize> = (0..self.nodes.len()).collect();
        let mut root = json!({ "name": self.scene.meta.scene_name, "children": children });
        if self.scene.meta.origin != [0.0; 3] {
            root["translation"] = json!(self.scene.meta.origin);
        }
        self.nodes.push(root);
        let generator = concat!("rebounce ", env!("CARGO_PKG_VERSION"));
        let mut out = json!({
            "asset": { "version": "2.0", "generator": generator, "extras": { "rebounce": self.extras } },
            "scene": 0,
            "scenes": [{ "nodes": [self.nodes.len() - 1] }],
            "nodes": self.nodes,
            "meshes": self.meshes,
            "materials": self.materials,
            "accessors": self.buffer.accessors,
            "bufferViews": self.buffer.views,
            "buffers": [{ "byteLength": self.buffer.len() }],
        });
        let lists = [
            ("cameras", self.cameras),
            ("images", self.images),
            ("textures", self.textures),
            ("samplers", self.samplers),
        ];
        // Empty lists are not allowed.
        for (name, list) in lists.into_iter().filter(|(_, list)| !list.is_empty()) {
            out[name] = list.into();
        }
        if !self.used.is_empty() {
            out["extensionsUsed"] = json!(self.used);
        }
        if self.used.contains("EXT_texture_webp") {
            out["extensionsRequired"] = json!(["EXT_texture_webp"]);
        }
        self.buffer.file(&out)
    }
}

/// Distance from which on a camera sees, scene units: a thousandth of the scene.
fn near(scene: &BakedScene) -> f32 {
    let size = Vec3::from(scene.meta.bounds_max) - Vec3::from(scene.meta.bounds_min);
    (1e-3 * size.length()).max(f32::MIN_POSITIVE)
}

/// Returns the mean of a base-colour texture around a vertex; white without one.
fn mean_colour(surface: &Surface, uv: Vec2) -> Vec3 {
    if surface.texture.is_none() {
        return Vec3::ONE;
    }
    surface.albedo(Vec3::ONE, uv, 1.0).max(Vec3::splat(LEAST))
}
