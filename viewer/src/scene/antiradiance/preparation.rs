//! Patches of a scene at rest and their first links, made piece by piece while frames are drawn.

use crate::scene::moving::Moving;
use crate::scene::rig::GpuRig;
use crate::scene::upload::Upload;
use rebounce_shared::antiradiance::{
    Linking, MovingElements, PartTables, PointPatches, SceneTriangle, SolverSettings,
};
use rebounce_shared::rbn::meta::Material;
use std::collections::{HashMap, HashSet};

/// Greatest number of patches: of static surfaces, and of moving ones.
const MOST: [usize; 2] = [4_096, 128];
/// Bins of scenes with at most [`MOST`] patches, and of scenes with more patches.
const BINS: usize = 256;
const FEWER_BINS: usize = 128;

/// Patches and unfinished links of a scene at rest.
pub struct Preparation {
    patches: PointPatches,
    linking: Box<Linking>,
}

/// Patches of a scene with all links.
pub struct Prepared {
    pub(super) patches: PointPatches,
    pub(super) elements: MovingElements,
    /// Tables of what stands.
    pub(super) still: PartTables,
}

impl Preparation {
    /// Chooses the patches.
    pub fn new((moving, rig): (&Moving, Option<&GpuRig>), upload: &Upload) -> Self {
        let scene = moving.file();
        let riders = rig.map_or(HashMap::new(), GpuRig::ridden);
        let moves = |i: usize| riders.contains_key(&i) || scene.groups.node_of(scene.group_of(i)).is_some();
        let deforming = rig.map_or(HashSet::new(), GpuRig::deforming);
        let each = |call: &mut dyn FnMut(SceneTriangle)| {
            upload.triangles.each(|run, vertices, corners| {
                let roughness = metal_roughness(&scene.meta.materials[run.material as usize]);
                let group = scene.groups.of_material(run.material);
                let moves = scene.groups.node_of(group).is_some() || deforming.contains(&vertices[0]);
                call(SceneTriangle { corners, is_two_sided: !run.one_sided, roughness, moves });
            });
        };
        let motions = moving.motions();
        // The triangles on the CPU are where the nodes are, and in no pose.
        let placed = |point| moving.placed_point(&motions, point);
        let patches = PointPatches::new(scene, &moves, MOST, (&each, &placed));
        let at_rest = |point: usize| [scene.points[point].position(), scene.points[point].normal()];
        let is_small = patches.points.len() <= MOST.iter().sum();
        let bins = if is_small { BINS } else { FEWER_BINS };
        let settings = SolverSettings { bins, ..SolverSettings::default() };
        let linking = Linking::new(patches.patches(&at_rest), patches.still, settings);
        Self { patches, linking }
    }

    /// Computes about `work` links ([`Linking::advance`]). Returns the patches with complete links.
    ///
    /// # Errors
    /// The unfinished preparation.
    pub fn advance(self, work: usize) -> Result<Prepared, Self> {
        let Self { patches, linking } = self;
        match linking.advance(work) {
            Ok((elements, still)) => Ok(Prepared { patches, elements, still }),
            Err(linking) => Err(Self { patches, linking }),
        }
    }
}

/// Roughness of a material that is metal everywhere.
fn metal_roughness(material: &Material) -> Option<f32> {
    let is_metal = material.metallic > 0.5 && material.metallic_roughness_texture.is_none();
    is_metal.then_some(material.roughness)
}
