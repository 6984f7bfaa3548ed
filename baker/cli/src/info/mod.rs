//! `rebounce info`: what is inside a baked file, or a scene that is not yet baked.

mod rig;
mod scene;

use super::draft::scene_kind;
use super::read_baked;
use anyhow::Result;
use clap::Args;
use glam::Vec3;
use rebounce_args::escape::escape_controls;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::light::{KINDS, Light};
use rebounce_shared::rbn::container::{self, Section};
use rebounce_shared::rbn::groups::{Group, Node};
use rebounce_shared::rbn::meta::{Alpha, Material, Texture};
use rebounce_shared::rbn::node_tracks::NodeAnimation;
use serde_json::{Value, json};
use std::io::Write;
use std::path::PathBuf;

/// Arguments of `rebounce info`.
#[derive(Args, Debug)]
pub struct InfoArgs {
    /// A baked scene; or a .gltf, .glb or .step file or builtin:NAME, and what it holds
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Prints JSON
    #[arg(long)]
    json: bool,
}

/// Runs the command. Reading a baked file checks every checksum and every rule of the format.
pub fn run(args: &InfoArgs) -> Result<()> {
    let file = args.file.display().to_string();
    let text = if scene_kind(&args.file).is_some() {
        scene::describe(&file, args.json)?
    } else {
        let (bytes, scene) = read_baked(&args.file)?;
        let sections = container::read(&bytes)?;
        match args.json {
            true => format!("{:#}\n", as_json(&file, &bytes, &sections, &scene)),
            false => as_text(&file, &bytes, &sections, &scene),
        }
    };
    match std::io::stdout().write_all(escape_controls(&text).as_bytes()) {
        // A reader may close the pipe early, as `head` does.
        Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => Err(e.into()),
        _ => Ok(()),
    }
}

fn as_json(file: &str, bytes: &[u8], sections: &[Section], scene: &BakedScene) -> Value {
    let m = &scene.meta;
    let (version, bytes) = (container::version(bytes), bytes.len());
    let names: Vec<&str> = m.shown.names().collect();
    let mut out = json!({
        "file": file,
        "bytes": bytes,
        "version": version,
        "generator": m.generator,
        "scene": m.scene_name,
        "sections": sections.iter().map(|s| json!({
            "name": s.name(), "offset": s.offset, "bytes": s.len, "share": s.len as f64 / bytes as f64,
        })).collect::<Vec<_>>(),
        "origin": m.origin,
        "bounds": [m.bounds_min, m.bounds_max],
        "triangles": scene.indices.len() / 3,
        "instances": scene.instances.len(),
        "placed_triangles": scene.triangles_placed(),
        "vertices": scene.vertices.len(),
        "points": scene.points.len(),
        "senders": scene.sender_count(),
        "direct_points": scene.direct_count(),
        "links": scene.link_count(),
        "later_links": scene.later.links.len(),
        "potential_links": m.bake.potential_links,
        "levels": m.levels.iter().map(|l| json!({
            "points": l.count, "disk_radius": l.disk_radius, "support_radius": l.support_radius,
        })).collect::<Vec<_>>(),
        "sender_levels": m.sender_levels,
        "direct_levels": m.direct_levels,
        "later_levels": m.later_levels,
        "materials": m.materials.iter().map(material_json).collect::<Vec<_>>(),
        "textures": m.textures.iter().map(|t| json!({
            "name": t.name, "mime": t.mime, "bytes": t.len, "width": t.width, "height": t.height,
        })).collect::<Vec<_>>(),
        "cameras": m.cameras,
        "camera_names": names.get(m.lights.len()..),
        "lights": m.lights,
        "light_names": names.get(..m.lights.len()),
        "sky": scene.sources.has_sky,
        "emissive_groups": scene.sources.groups.iter().map(|group| json!({
            "name": group.name, "materials": group.materials, "coloured": group.is_coloured,
        })).collect::<Vec<_>>(),
        "source_links": scene.source_links.links.len(),
        "is_solved": scene.is_solved(),
        "light_groups": scene.light_groups.groups.iter().zip(&m.lights).map(|(group, light)| json!({
            "kind": KINDS[light.kind() as usize].name, "has_direct": group.has_direct,
        })).collect::<Vec<_>>(),
        "ground": !m.shown.ground.is_empty(),
        "bake": {
            "preset": m.bake.preset, "seed": m.bake.seed, "epsilon": m.bake.epsilon,
            "bounces": m.bake.bounces, "rays": m.bake.rays,
        },
    });
    out["by_radiosity"] = scene.is_unlinked().into();
    out["is_for_environment"] = scene.is_for_environment().into();
    out["groups"] = groups_with_points(scene).map(group_json).collect();
    out["nodes"] = scene.groups.nodes.iter().map(node_json).collect();
    out["rig"] = rig::as_json(&scene.rig);
    out["node_animations"] = scene.groups.animations.iter().map(animation_json).collect();
    out
}

fn group_json((group, points): (&Group, usize)) -> Value {
    json!({ "name": group.name, "density": group.density, "node": group.node, "points": points })
}

fn node_json(node: &Node) -> Value {
    json!({ "name": node.name, "parent": node.parent, "origin": node.origin })
}

fn animation_json(animation: &NodeAnimation) -> Value {
    json!({
        "name": animation.name, "seconds": animation.duration,
        "tracks": animation.tracks.iter().map(|track| json!({
            "node": track.node, "property": track.property.name(), "keys": track.times.len(),
        })).collect::<Vec<_>>(),
    })
}

/// The reconstruction groups besides group 0, with their numbers of points.
fn groups_with_points(scene: &BakedScene) -> impl Iterator<Item = (&Group, usize)> {
    let mut counts = vec![0; 1 + scene.groups.groups.len()];
    scene.point_groups.iter().for_each(|group| counts[*group as usize] += 1);
    scene.groups.groups.iter().zip(counts.into_iter().skip(1))
}

fn material_json(m: &Material) -> Value {
    let (mode, cutoff) = match m.alpha {
        Alpha::Opaque => ("OPAQUE", None),
        Alpha::Mask { cutoff } => ("MASK", Some(cutoff)),
        Alpha::Blend => ("BLEND", None),
    };
    json!({
        "name": m.name, "base_color": m.base_color, "base_color_texture": m.base_color_texture,
        "alpha_mode": mode, "alpha_cutoff": cutoff, "double_sided": m.double_sided, "emission": m.emission,
        "unlit": m.extras.unlit, "transmission": m.extras.transmission,
        "diffuse_transmission": m.extras.scattered,
    })
}

fn as_text(file: &str, bytes: &[u8], sections: &[Section], scene: &BakedScene) -> String {
    let m = &scene.meta;
    let (version, bytes) = (container::version(bytes).unwrap_or_default(), bytes.len());
    let mut out = String::new();
    let mut line = |label: &str, text: String| out += &format!("{label:13} {text}\n");
    line("file", format!("{file}, {}, format version {}", size(bytes), version));
    line("scene", format!("{:?}, by {}", m.scene_name, m.generator.escape_debug()));
    line("size", size_around(Vec3::from(m.bounds_max) - Vec3::from(m.bounds_min), m.origin));
    line("geometry", format!("{} triangles, {} vertices", scene.indices.len() / 3, scene.vertices.len()));
    if !scene.instances.is_empty() {
        let instances = scene.instances.len();
        line("instances", format!("{instances} of models, {} triangles in all", scene.triangles_placed()));
    }
    line(
        "points",
        format!(
            "{}, of which {} send and {} sample direct light",
            scene.points.len(),
            scene.sender_count(),
            scene.direct_count()
        ),
    );
    for (i, l) in m.levels.iter().enumerate() {
        let sends = if (i as u32) < m.sender_levels { ", senders" } else { "" };
        line(
            &format!("  level {i}"),
            format!("{} points, disk {:.4}, support {:.4}{sends}", l.count, l.disk_radius, l.support_radius),
        );
    }
    let (links, later) = (scene.link_count(), scene.later.links.len());
    let share = 100.0 * links as f64 / (m.bake.potential_links.max(1)) as f64;
    line(
        "links",
        if scene.is_unlinked() {
            "none; radiosity computes bounced light when the file is shown".to_owned()
        } else {
            format!(
                "{links}, {share:.2}% of {} potential ones; {later} for later bounces",
                m.bake.potential_links
            )
        },
    );
    line(
        "bake",
        format!(
            "preset {}, seed {}, epsilon {:e}, {} bounces, {} rays",
            m.bake.preset.escape_debug(),
            m.bake.seed,
            m.bake.epsilon,
            m.bake.bounces,
            m.bake.rays
        ),
    );
    let textured = m.materials.iter().filter(|m| m.base_color_texture.is_some()).count();
    line("materials", format!("{}, {textured} with a texture", m.materials.len()));
    let texture_bytes: u64 = m.textures.iter().map(|t| t.len).sum();
    line("textures", format!("{}, {}", m.textures.len(), size(texture_bytes as usize)));
    for Texture { name, mime, len, width, height, .. } in &m.textures {
        line(
            "",
            format!(
                "{width} x {height} {}, {}, {name:?}",
                mime.trim_start_matches("image/").escape_debug(),
                size(*len as usize)
            ),
        );
    }
    let names: Vec<&str> = m.shown.names().collect();
    let counted = |count: usize, names: Option<&[&str]>| match names {
        Some(names) if names.iter().any(|name| !name.is_empty()) => format!("{count}: {names:?}"),
        _ => count.to_string(),
    };
    line("cameras", counted(m.cameras.len(), names.get(m.lights.len()..)));
    line("lights", counted(m.lights.len(), names.get(..m.lights.len())));
    if scene.sources != Default::default() {
        let sky = if scene.sources.has_sky { "the sky and " } else { "" };
        let groups: Vec<&str> = scene.sources.groups.iter().map(|group| group.name.as_str()).collect();
        let links = scene.source_links.links.len();
        line(
            "sources",
            format!("{sky}{} groups of shining surfaces {groups:?}, {links} links", groups.len()),
        );
    }
    if scene.is_for_environment() {
        let vectors = scene.diffuse_transfer.stored();
        line(
            "transfer",
            format!("from the environment, {vectors} vectors for {} points", scene.points.len()),
        );
    }
    if scene.is_solved() {
        let group = |(number, light): (usize, &Light)| {
            let name = names.get(number).filter(|name| !name.is_empty());
            format!(
                "{}{}",
                KINDS[light.kind() as usize].name,
                name.map_or(String::new(), |name| format!(" {name:?}"))
            )
        };
        let groups: Vec<String> = m.lights.iter().enumerate().map(group).collect();
        line("light groups", format!("{}, in their places: {}", groups.len(), groups.join(", ")));
    }
    for (i, (group, points)) in groups_with_points(scene).enumerate() {
        let moves = if group.node.is_some() { ", may move" } else { "" };
        line(
            if i == 0 { "groups" } else { "" },
            format!("{:?}, {points} points, density {}{moves}", group.name, group.density),
        );
    }
    for (i, animation) in scene.groups.animations.iter().enumerate() {
        let NodeAnimation { name, duration, tracks } = animation;
        line(
            if i == 0 { "keyframes" } else { "" },
            format!("{name:?}, {duration} s, {} tracks of nodes", tracks.len()),
        );
    }
    for (i, text) in rig::as_text(&scene.rig).into_iter().enumerate() {
        line(if i == 0 { "deforms" } else { "" }, text);
    }
    line("sections", String::new());
    for s in sections {
        let share = 100.0 * s.len as f64 / bytes as f64;
        line(&format!("  {}", s.name()), format!("{:>12} bytes {share:5.1}%", s.len));
    }
    out
}

/// Extent of a scene, and where its origin is.
fn size_around(extent: Vec3, [ox, oy, oz]: [f64; 3]) -> String {
    let [x, y, z] = extent.to_array();
    format!("{x:.4} x {y:.4} x {z:.4} around ({ox:.3}, {oy:.3}, {oz:.3})")
}

fn size(bytes: usize) -> String {
    match bytes {
        0..10_000 => format!("{bytes} bytes"),
        10_000..10_000_000 => format!("{:.1} kB", bytes as f64 / 1e3),
        _ => format!("{:.1} MB", bytes as f64 / 1e6),
    }
}
