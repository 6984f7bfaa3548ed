//! What a scene's file holds, before it is baked: the names that `--materials` and `--group` take, exact faces, what is left out.

use super::{material_json, rig, size_around};
use anyhow::Result;
use rebounce::io::load;
use rebounce::scene::Scene;
use rebounce_args::load::warnings;
use rebounce_shared::light::KINDS;
use rebounce_shared::rbn::meta::Material;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Describes a scene, as JSON or as text.
pub fn describe(spec: &str, is_json: bool) -> Result<String> {
    let scene = load(spec)?;
    Ok(if is_json { format!("{:#}\n", as_json(spec, &scene)) } else { as_text(spec, &scene) })
}

/// Number of exact faces by the kind of their surface, each once.
fn faces(scene: &Scene) -> BTreeMap<&'static str, usize> {
    let mut counts = BTreeMap::new();
    for face in scene.brep.iter().flat_map(|brep| &brep.faces) {
        *counts.entry(face.cast.surface().kind()).or_default() += 1;
    }
    counts
}

fn as_json(spec: &str, scene: &Scene) -> Value {
    let (low, high) = scene.bounds();
    let material = |m: &Material| {
        let mut out = material_json(m);
        out["metallic"] = m.metallic.into();
        out["roughness"] = m.roughness.into();
        out
    };
    json!({
        "file": spec,
        "scene": scene.name,
        "origin": scene.origin,
        "bounds": [low.to_array(), high.to_array()],
        "triangles": scene.triangles.len(),
        "placed_triangles": scene.triangles_placed(),
        "instances": scene.instances(),
        "exact_faces": faces(scene),
        "part_instances": scene.brep.as_ref().map_or(0, |brep| brep.instances.len()),
        "materials": scene.materials.iter().map(material).collect::<Vec<_>>(),
        "textures": scene.textures.len(),
        "rig": rig::as_json(&scene.rig),
        "lights": scene.lights,
        "cameras": scene.cameras,
        "left_out": scene.left_out,
        "notes": scene.notes,
    })
}

fn as_text(spec: &str, scene: &Scene) -> String {
    let mut out = String::new();
    let mut line = |label: &str, text: String| out += &format!("{label:13} {text}\n");
    line("file", format!("{spec}, not yet baked"));
    let (low, high) = scene.bounds();
    line("size", size_around(high - low, scene.origin));
    let copies = match scene.instances() {
        0 => String::new(),
        count => format!(", {} with {count} instances of models", scene.triangles_placed()),
    };
    line("geometry", format!("{} triangles{copies}", scene.triangles.len()));
    if let Some(brep) = &scene.brep {
        let kinds: Vec<String> = faces(scene).iter().map(|(kind, count)| format!("{count} {kind}")).collect();
        let parts = brep.instances.len();
        line("exact faces", format!("{} in {parts} placed parts: {}", brep.faces.len(), kinds.join(", ")));
    }
    for (i, text) in rig::as_text(&scene.rig).into_iter().enumerate() {
        line(if i == 0 { "deforms" } else { "" }, text);
    }
    for (i, m) in scene.materials.iter().enumerate() {
        let [r, g, b, _] = m.base_color;
        let texture = if m.base_color_texture.is_some() { " and a texture" } else { "" };
        let sides = if m.double_sided { ", two-sided" } else { "" };
        let shines =
            if m.emission == [0.0; 3] { String::new() } else { format!(", shines {:?}", m.emission) };
        let label = if i == 0 { "materials" } else { "" };
        line(label, format!("{:?}, color {r:.3} {g:.3} {b:.3}{texture}{sides}{shines}", m.name));
    }
    for (i, light) in scene.lights.iter().enumerate() {
        let name = scene.light_names.get(i).filter(|name| !name.is_empty());
        let name = name.map_or(String::new(), |name| format!(" {name:?}"));
        line(if i == 0 { "lights" } else { "" }, format!("{}{name}", KINDS[light.kind() as usize].name));
    }
    line("cameras", scene.cameras.len().to_string());
    for (i, warning) in warnings(scene).into_iter().enumerate() {
        line(if i == 0 { "notes" } else { "" }, warning);
    }
    out
}
