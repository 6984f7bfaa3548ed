//! Selection of one scene of the file.

use super::notes::Told;
use super::source::Source;
use crate::scene::SceneError;
use gltf::json::Index;

/// Returns the scene with the name or number `wanted`, or the file's default scene, and its root nodes. If the default
/// scene has no mesh and exactly one scene has, that scene replaces the default. Without scenes, returns `None` and all nodes
/// without a parent. `told` gets a message about a replaced default and about skipped scenes.
pub(super) fn roots(
    source: &Source,
    wanted: Option<&str>,
    told: &mut Told,
) -> Result<(Option<usize>, Vec<usize>), SceneError> {
    let root = &source.root;
    let mut taken = match wanted {
        Some(wanted) => named(source, wanted)?,
        None => root.scene.map_or(0, |scene| scene.value()),
    };
    if taken >= root.scenes.len() {
        if root.scene.is_some() {
            told.notes.push(format!(
                "all nodes are taken: there is no scene {taken}, which should be the file's default"
            ));
        }
        return Ok((None, without_parent(source)));
    }
    if wanted.is_some() {
        return Ok((Some(taken), nodes(source, taken)));
    }
    let has_mesh = reaching(source, |node| root.nodes[node].mesh.is_some());
    let with_mesh = |has_mesh: &[bool]| -> Vec<usize> {
        let has = |scene: &usize| nodes(source, *scene).iter().any(|node| has_mesh.get(*node) == Some(&true));
        (0..root.scenes.len()).filter(has).collect()
    };
    let able = with_mesh(&has_mesh);
    if !able.contains(&taken) {
        match able[..] {
            [] => {}
            [other] => {
                let (empty, other_name) = (name(source, taken), name(source, other));
                told.notes.push(format!("{other_name} is taken: {empty}, the file's default, has no mesh"));
                taken = other;
            }
            _ => {
                let file = source.file.clone();
                return Err(SceneError::EmptyScene {
                    file,
                    scene: name(source, taken),
                    known: listed(source, &able),
                });
            }
        }
    }
    let mut below = vec![false; root.nodes.len()];
    let mut stack = nodes(source, taken);
    while let Some(node) = stack.pop() {
        if below.get(node) == Some(&false) {
            below[node] = true;
            stack.extend(root.nodes[node].children.iter().flatten().map(Index::value));
        }
    }
    let elsewhere = reaching(source, |node| root.nodes[node].mesh.is_some() && !below[node]);
    for other in with_mesh(&elsewhere).into_iter().filter(|other| *other != taken) {
        told.left_out.push(format!(
            "{}: {} is taken; --scene takes another",
            name(source, other),
            name(source, taken)
        ));
    }
    Ok((Some(taken), nodes(source, taken)))
}

/// Index of the scene named `wanted`, or else numbered `wanted`.
fn named(source: &Source, wanted: &str) -> Result<usize, SceneError> {
    let scenes = &source.root.scenes;
    let by_name = scenes.iter().position(|scene| scene.name.as_deref() == Some(wanted));
    let by_number = || wanted.parse().ok().filter(|number| *number < scenes.len());
    by_name.or_else(by_number).ok_or_else(|| {
        let advice = match scenes.len() {
            0 => "leave --scene out, as it has none".to_owned(),
            count => {
                let known = listed(source, &(0..count).collect::<Vec<_>>());
                format!("give --scene one of its own, by number or name; they are {known}")
            }
        };
        SceneError::NoScene { file: source.file.clone(), wanted: wanted.to_owned(), advice }
    })
}

/// Name of a scene in errors.
fn name(source: &Source, scene: usize) -> String {
    match source.root.scenes.get(scene).and_then(|scene| scene.name.as_deref()) {
        Some(name) => format!("scene {scene} ({name:?})"),
        None => format!("scene {scene}"),
    }
}

fn listed(source: &Source, scenes: &[usize]) -> String {
    let known: Vec<String> = scenes.iter().take(20).map(|scene| name(source, *scene)).collect();
    known.join(", ")
}

fn nodes(source: &Source, scene: usize) -> Vec<usize> {
    source.root.scenes[scene].nodes.iter().map(Index::value).collect()
}

fn without_parent(source: &Source) -> Vec<usize> {
    let nodes = &source.root.nodes;
    let mut is_child = vec![false; nodes.len()];
    for child in nodes.iter().flat_map(|node| node.children.iter().flatten()) {
        if let Some(slot) = is_child.get_mut(child.value()) {
            *slot = true;
        }
    }
    (0..nodes.len()).filter(|&i| !is_child[i]).collect()
}

/// For each node, whether `is` holds for the node or a descendant.
fn reaching(source: &Source, is: impl Fn(usize) -> bool) -> Vec<bool> {
    let nodes = &source.root.nodes;
    let mut parents: Vec<Vec<usize>> = vec![Vec::new(); nodes.len()];
    for (parent, node) in nodes.iter().enumerate() {
        for child in node.children.iter().flatten().map(Index::value) {
            if let Some(above) = parents.get_mut(child) {
                above.push(parent);
            }
        }
    }
    let mut out = vec![false; nodes.len()];
    let mut stack: Vec<usize> = (0..nodes.len()).filter(|&node| is(node)).collect();
    while let Some(node) = stack.pop() {
        if !std::mem::replace(&mut out[node], true) {
            stack.extend(&parents[node]);
        }
    }
    out
}
