//! Reconstruction groups of a scene: which triangles have functions of their own, and which nodes may move.

use super::Scene;
use super::world_mesh::{WorldInstancedMesh, WorldMesh};
use glam::{DAffine3, DVec3};
use rebounce_shared::motion::Motions;
use rebounce_shared::rbn::groups::{Group, Groups, MAX_GROUPS, Node};

/// Groups of nodes, before materials are taken into account.
#[derive(Debug, Default)]
pub struct NodeGroups {
    /// Nodes that may move, parents before children.
    pub nodes: Vec<Node>,
    /// Groups 1, 2, …, each with its node; without, those of meshes that animations deform.
    pub groups: Vec<Group>,
    /// Origin of each group's triangles, world space.
    pub pivots: Vec<DVec3>,
}

/// Surfaces of a material that are a group of their own.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialGroup {
    /// Name of the material.
    pub name: String,
    /// Functions for an area, relative to other surfaces.
    pub density: f32,
}

/// Triangles of the groups of nodes, world space less the group's pivot.
#[derive(Default)]
pub struct GroupedMeshes {
    meshes: Vec<WorldMesh>,
}

impl GroupedMeshes {
    /// The mesh of a group, and its pivot.
    pub fn of<'m>(&'m mut self, groups: &NodeGroups, group: u32) -> (&'m mut WorldMesh, DVec3) {
        let place = group as usize - 1;
        if self.meshes.len() <= place {
            self.meshes.resize_with(place + 1, WorldMesh::default);
        }
        (&mut self.meshes[place], groups.pivots[place])
    }

    /// Adds a model for each group: its triangles, placed once.
    pub fn finish(self, groups: &NodeGroups, out: &mut WorldMesh) {
        for ((group, mesh), pivot) in (1..).zip(self.meshes).zip(&groups.pivots) {
            if !mesh.triangles.is_empty() {
                out.in_models.0 += mesh.positions.len();
                out.in_models.1 += mesh.triangles.len();
                let world_from_model = vec![DAffine3::from_translation(*pivot)];
                out.models.push(WorldInstancedMesh { mesh, world_from_model, group });
            }
        }
    }
}

impl Scene {
    /// The scene after these motions of its groups.
    pub fn moved(&self, motions: &Motions) -> Self {
        let mut out = self.clone();
        for model in &mut out.models {
            let material = self.triangle_material[model.triangles.start as usize];
            let motion = motions.of(self.groups.of_material(material));
            for place in model.local_from_model.iter_mut().filter(|_| motion.is_moved()) {
                *place = motion.local_from_rest * *place;
            }
        }
        out
    }
}

/// Gives each reconstruction group materials of its own, and the scene its groups. Groups without triangles are dropped.
/// Returns the names among `by_material` that no material has.
pub fn assign(
    scene: &mut Scene,
    mesh: &mut WorldMesh,
    nodes: NodeGroups,
    by_material: &[MaterialGroup],
) -> Vec<String> {
    if nodes.groups.is_empty() && by_material.is_empty() {
        return Vec::new();
    }
    let own = |name: &str| by_material.iter().position(|group| group.name == name);
    let own: Vec<Option<usize>> = scene.materials.iter().map(|material| own(&material.name)).collect();
    let is_lost = |i: &usize| !own.contains(&Some(*i));
    let lost = (0..by_material.len()).filter(is_lost).map(|i| by_material[i].name.clone()).collect();
    let mut out = Split { own: &own, by_material, nodes: &nodes, groups: Vec::new(), known: Vec::new() };
    // Of each material of the file, its groups, each with its own material.
    let mut placed: Vec<Vec<[u32; 2]>> = vec![Vec::new(); scene.materials.len()];
    let mut of_material = vec![0; scene.materials.len()];
    let WorldMesh { triangle_material, triangle_group, models, .. } = mesh;
    let alone = std::mem::take(triangle_group).into_iter().chain(std::iter::repeat(0));
    let alone = alone.zip(triangle_material.iter_mut());
    let modelled = models.iter_mut().flat_map(|model| {
        let group = model.group;
        model.mesh.triangle_material.iter_mut().map(move |material| (group, material))
    });
    for (node_group, material) in alone.chain(modelled) {
        let group = out.group(node_group, *material);
        let first = *material as usize;
        if let Some([_, own]) = placed[first].iter().find(|own| own[0] == group) {
            *material = *own;
            continue;
        }
        if placed[first].is_empty() {
            of_material[first] = group;
        } else {
            // What shone as one light goes on shining as one.
            let name = scene.materials[first].name.clone();
            scene.light_groups.resize(scene.materials.len(), None);
            let light_group = scene.light_groups[first].get_or_insert(name).clone();
            scene.light_groups.push(Some(light_group));
            *material = scene.materials.len() as u32;
            scene.materials.push(scene.materials[first].clone());
            of_material.push(group);
        }
        placed[first].push([group, *material]);
    }
    let groups = out.groups;
    if !groups.is_empty() {
        scene.groups = Groups { nodes: nodes.nodes, groups, of_material, ..Groups::default() };
    }
    lost
}

/// Groups made so far.
struct Split<'a> {
    /// Place of each material of the file in `by_material`.
    own: &'a [Option<usize>],
    by_material: &'a [MaterialGroup],
    nodes: &'a NodeGroups,
    groups: Vec<Group>,
    /// Of each group, its group of nodes and place in `by_material`.
    known: Vec<(u32, Option<usize>)>,
}

impl Split<'_> {
    /// Group of the triangles of a group of nodes and a material of the file.
    fn group(&mut self, node_group: u32, material: u32) -> u32 {
        let own = self.own[material as usize];
        if node_group == 0 && own.is_none() {
            return 0;
        }
        if let Some(place) = self.known.iter().position(|known| *known == (node_group, own)) {
            return place as u32 + 1;
        }
        if self.groups.len() == MAX_GROUPS {
            return 0;
        }
        let of_node = node_group.checked_sub(1).map(|place| &self.nodes.groups[place as usize]);
        let of_material = own.map(|place| &self.by_material[place]);
        let density = of_material.map(|group| group.density).or(of_node.map(|group| group.density));
        let names = [of_node.map(|group| group.name.as_str()), of_material.map(|group| group.name.as_str())];
        self.groups.push(Group {
            name: names.into_iter().flatten().collect::<Vec<_>>().join("/"),
            density: density.unwrap_or(1.0),
            node: of_node.and_then(|group| group.node),
        });
        self.known.push((node_group, own));
        self.groups.len() as u32
    }
}
