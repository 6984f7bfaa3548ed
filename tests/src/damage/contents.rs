//! Damage to contents: well-formed sections with wrong numbers.

use super::container::sealed;
use super::{Damaged, Outcome, Random, Sections};
use bytemuck::Pod;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::light::Light;
use rebounce_shared::rbn::codec::{columns, links};
use rebounce_shared::rbn::meta;
use rebounce_shared::rbn::meta::{Alpha, DetailTexture, Level};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Changes parts of a scene and packs the scene unchecked.
pub fn lie(scene: &BakedScene, random: &mut Random) -> Option<Damaged> {
    let mut scene = scene.clone();
    let mut what = Vec::new();
    for _ in 0..1 + random.below(2) {
        what.push(match random.below(14) {
            0 => words("vertex", &mut scene.vertices, random),
            1 => words("index", &mut scene.indices, random),
            2 | 3 => words("point", &mut scene.points, random),
            4 => words("cut", &mut scene.cuts, random),
            5 => words("link", &mut scene.links.links, random),
            6 => words("later link", &mut scene.later.links, random),
            7 => crowd(&mut scene, random),
            8 => levels(&mut scene, random),
            9 => place(&mut scene, random),
            10 => look(&mut scene, random),
            11 => words("place of a copy", &mut scene.instances, random),
            12 => words("copies of a draw call", &mut scene.copies, random),
            _ => light(&mut scene, random),
        });
    }
    // Contents that cannot be packed give no file.
    let sections = catch_unwind(AssertUnwindSafe(|| packed(&scene))).ok()??;
    let what = format!("{}, checksums right", what.join("; "));
    Some(Damaged { what, outcome: Outcome::Any, bytes: sealed(&sections) })
}

/// Packs the sections of a scene without validation.
fn packed(scene: &BakedScene) -> Option<Sections> {
    let mut sections = vec![
        (*b"META", meta::encode(&scene.meta).ok()?),
        (*b"VERT", columns::encode(&scene.vertices)),
        (*b"INDX", columns::encode(&scene.indices)),
        (*b"PNTS", columns::encode(&scene.points)),
        (*b"CUTS", columns::encode(&scene.cuts)),
        (*b"LINK", links::encode(&scene.links.offsets, &scene.links.links)),
        (*b"LATL", links::encode(&scene.later.offsets, &scene.later.links)),
        (*b"TEXD", scene.texture_bytes.clone()),
    ];
    if !(scene.instances.is_empty() && scene.copies.is_empty()) {
        sections.push((*b"INST", columns::encode(&scene.instances)));
        sections.push((*b"COPY", columns::encode(&scene.copies)));
    }
    Some(sections)
}

/// Puts a hostile number into words of the records, or removes or adds records.
fn words<T: Pod>(name: &str, records: &mut Vec<T>, random: &mut Random) -> String {
    match random.below(6) {
        0 => {
            records.truncate(random.below(records.len()));
            return format!("{} of {name}", records.len());
        }
        1 if !records.is_empty() => {
            let last = records[records.len() - 1];
            records.resize(records.len() + 1 + random.below(999), last);
            return format!("{} of {name}, the last repeated", records.len());
        }
        _ => {}
    }
    let width = size_of::<T>() / 4;
    let words: &mut [u32] = bytemuck::cast_slice_mut(records);
    if words.is_empty() {
        return format!("no {name}");
    }
    // One word, or the corresponding word of every record.
    let (at, all) = (random.below(words.len()), random.below(3) == 0);
    let value = match random.below(2) {
        0 => random.float().to_bits(),
        _ => random.number(words[at] as u64) as u32,
    };
    for i in (at % width..words.len()).step_by(width).filter(|&i| all || i == at) {
        words[i] = value;
    }
    format!("word {} of {} {name} is {value:#x}", at % width, if all { "each" } else { "a" })
}

/// Moves every function to one place, or gives every support the same radius.
fn crowd(scene: &mut BakedScene, random: &mut Random) -> String {
    let first = scene.points[0];
    let radius = random.float();
    let is_place = random.below(2) == 0;
    for point in &mut scene.points {
        if is_place {
            point.position = first.position;
        } else {
            point.radius = radius;
        }
    }
    if is_place { "all points in one place".to_owned() } else { format!("all radii {radius}") }
}

fn levels(scene: &mut BakedScene, random: &mut Random) -> String {
    let m = &mut scene.meta;
    let l = random.below(m.levels.len());
    let Level { first, count, .. } = m.levels[l];
    let level = &mut m.levels[l];
    match random.below(7) {
        0 => level.first = random.number(first as u64) as u32,
        1 => level.count = random.number(count as u64) as u32,
        2 => level.disk_radius = random.float(),
        3 => level.support_radius = random.float(),
        4 => m.sender_levels = random.number(m.sender_levels as u64) as u32,
        5 => m.direct_levels = random.number(m.direct_levels as u64) as u32,
        _ => m.later_levels = random.number(m.later_levels as u64) as u32,
    }
    format!("levels {:?}, {}, {}, {}", m.levels[l], m.later_levels, m.sender_levels, m.direct_levels)
}

fn place(scene: &mut BakedScene, random: &mut Random) -> String {
    let m = &mut scene.meta;
    let (axis, value) = (random.below(3), random.float());
    let wide = if random.below(4) == 0 { 1e300 } else { value as f64 };
    let what = random.one(&["origin", "bounds", "eye", "target", "up", "angle", "no camera", "view"]);
    match what {
        "origin" => m.origin[axis] = wide,
        "bounds" => m.bounds_max[axis] = value,
        "eye" => m.cameras[0].position[axis] = wide,
        "target" => m.cameras[0].target[axis] = wide,
        "up" => m.cameras[0].up = [wide; 3],
        "angle" => m.cameras[0].yfov_deg = wide,
        "view" => m.cameras[0].target = m.cameras[0].position,
        _ => m.cameras.clear(),
    }
    format!("{what} {value}")
}

/// Damages materials, textures or draw calls.
fn look(scene: &mut BakedScene, random: &mut Random) -> String {
    let m = &mut scene.meta;
    let value = random.float();
    let k = random.below(m.materials.len());
    let material = &mut m.materials[k];
    let d = random.below(m.draws.len());
    let (detail, index) = (DetailTexture::default(), random.number(0) as u32);
    let what = random.one(&[
        "colour",
        "emission",
        "metallic",
        "roughness",
        "normals",
        "cutoff",
        "picture",
        "detail",
        "matrix",
        "offset",
        "length",
        "size",
        "pixels",
        "type",
        "first",
        "count",
        "material",
        "draws",
    ]);
    match (what, m.textures.first_mut()) {
        ("colour", _) => material.base_color[random.below(4)] = value,
        ("emission", _) => material.emission[random.below(3)] = value,
        ("metallic", _) => material.metallic = value,
        ("roughness", _) => material.roughness = value,
        ("normals", _) => material.normal_scale = value,
        ("cutoff", _) => material.alpha = Alpha::Mask { cutoff: value },
        ("picture", _) => material.base_color_texture = Some(index),
        ("detail", _) => material.normal_texture = Some(DetailTexture { texture: index, ..detail }),
        ("matrix", _) => {
            material.emission_texture = Some(DetailTexture { uv_from_vertex: [[value; 3]; 2], ..detail })
        }
        ("offset", Some(texture)) => texture.offset = random.number(texture.offset),
        ("length", Some(texture)) => texture.len = random.number(texture.len),
        ("size", Some(texture)) => texture.width = random.number(texture.width as u64) as u32,
        ("type", Some(texture)) => texture.mime = "image/svg+xml".to_owned(),
        ("pixels", _) => {
            let at = random.below(scene.texture_bytes.len());
            scene.texture_bytes[at] ^= 1 << random.below(8);
        }
        ("first", _) => m.draws[d].first_index = random.number(m.draws[d].first_index as u64) as u32,
        ("count", _) => m.draws[d].index_count = random.number(m.draws[d].index_count as u64) as u32,
        ("material", _) => m.draws[d].material = random.number(m.draws[d].material as u64) as u32,
        _ => m.draws = m.draws.repeat(2000),
    }
    format!("{what} {value} {index}")
}

/// Damages lights or animations.
fn light(scene: &mut BakedScene, random: &mut Random) -> String {
    let m = &mut scene.meta;
    let value = if random.below(4) == 0 { 1e300 } else { random.float() as f64 };
    let what =
        random.one(&["place", "strength", "colour", "cone", "many", "track", "time", "key", "duration"]);
    let animation = m.animations.first_mut();
    match (what, m.lights.first_mut(), animation) {
        ("place", Some(Light::Point { position, .. } | Light::Spot { position, .. }), _) => {
            *position = [value; 3]
        }
        ("strength", Some(Light::Point { intensity, .. } | Light::Spot { intensity, .. }), _) => {
            *intensity = value
        }
        ("colour", Some(Light::Point { color, .. } | Light::Spot { color, .. }), _) => {
            *color = [value, 1.0, 1.0]
        }
        ("track", _, Some(animation)) => animation.tracks[0].light = random.number(0) as u32,
        ("time", _, Some(animation)) => animation.tracks[0].times[0] = value as f32,
        ("key", _, Some(animation)) => animation.tracks[0].values[0] = value as f32,
        ("duration", _, Some(animation)) => animation.duration = value as f32,
        ("many", Some(first), _) => m.lights = vec![first.clone(); 3 + random.below(3000)],
        _ => m.lights.push(Light::Spot {
            position: [0.0, 1.0, 0.0],
            direction: [0.0, value, 0.0],
            outer_cone_deg: value,
            inner_cone_deg: Some(random.float() as f64),
            intensity: 1.0,
            color: [1.0; 3],
            radius: 0.0,
        }),
    }
    format!("{what} {value}")
}
