//! Bakes of a fraction of a second.

use anyhow::Result;
use glam::{Vec2, Vec3};
use rebounce::bake::{BakeSettings, FixedSolver, Preset, SolveSettings, bake, solve};
use rebounce::sampling::cube_maps::CubeMapSettings;
use rebounce::scene::Scene;
use rebounce::transport::radiosity::RadiositySettings;
use rebounce::transport::wavelet::WaveletSettings;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::environment::Environment;
use rebounce_shared::light::Light;
use rebounce_shared::rbn::bulk::{Copies, Instance};
use rebounce_shared::rbn::meta::{
    Animation, DetailTexture, Interpolation, Material, Property, Texture, Track,
};
use std::sync::Arc;

/// Four pixels.
const PICTURE: &[u8] = include_bytes!("small.png");

/// Returns settings of a fast bake with about this number of functions.
pub fn settings(functions: usize) -> BakeSettings {
    let mut settings = BakeSettings::new(Preset::Draft);
    (settings.place.levels, settings.place.functions) = (3, functions);
    settings.operator.rays = vec![64];
    settings.operator.later_levels = 1;
    settings.normalised()
}

/// Bakes a scene with a few functions; sections are shorter than 64 kB.
///
/// # Errors
/// Errors of the bake.
pub fn small(name: &str, functions: usize) -> Result<BakedScene> {
    Ok(bake(&rebounce::io::load(name)?, &settings(functions), &())?.0)
}

/// Bakes the Cornell box with every feature of a file: a picture as colour and normal map, animations, and a wall in
/// two places.
///
/// # Errors
/// Errors of the bake.
pub fn everything(functions: usize) -> Result<BakedScene> {
    let mut scene = small("builtin:cornell-box", functions)?;
    scene.texture_bytes = PICTURE.to_vec();
    let m = &mut scene.meta;
    m.textures = vec![Texture {
        name: "picture".to_owned(),
        mime: "image/png".to_owned(),
        len: PICTURE.len() as u64,
        width: 2,
        height: 2,
        linear_filter: true,
        ..Texture::default()
    }];
    m.materials[0].base_color_texture = Some(0);
    let uv_from_vertex = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    m.materials[0].normal_texture = Some(DetailTexture { texture: 0, uv_from_vertex });
    let track = Track {
        light: 0,
        property: Property::Intensity,
        interpolation: Interpolation::Linear,
        times: vec![0.0, 1.0],
        values: vec![1.0, 2.0],
    };
    let animation =
        |name: &str| Animation { name: name.to_owned(), duration: 1.0, tracks: vec![track.clone()] };
    m.animations = vec![animation("dim"), animation("bright")];
    let mut moved = Instance::IDENTITY;
    moved.rows[2][3] = -0.25;
    scene.instances = vec![Instance::IDENTITY, moved];
    scene.copies = vec![Copies::default(); scene.meta.draws.len()];
    if let Some(last) = scene.copies.last_mut() {
        *last = Copies { first: 0, count: 2 };
    }
    Ok(scene)
}

/// Returns the Cornell box, open in front, with a light of every kind that a file of version 10 has besides punctual ones:
/// a sky, a panel that shines, a rectangle, a disk and a sphere.
///
/// # Errors
/// Errors of loading.
pub fn all_lights() -> Result<Scene> {
    let mut scene = rebounce::io::load("builtin:cornell-box")?;
    let panel = Material { name: "panel".to_owned(), emission: [0.6, 0.5, 0.3], ..Material::default() };
    add_parallelogram(&mut scene, Vec3::new(0.0, 0.2, -0.9), [Vec3::X * 0.4, Vec3::Y * 0.3], panel);
    let pixels = (0..32).map(|i| Vec3::new(0.1, 0.2, 0.4) * (1 + i % 3) as f32).collect();
    scene.environment = Some(Arc::new(Environment { width: 8, height: 4, pixels }));
    let color = [1.0, 0.9, 0.8];
    let (down, up) = ([0.0, -1.0, 0.0], [0.0, 0.0, 1.0]);
    scene.lights.extend([
        Light::Environment { file: None, rotation_deg: 20.0, intensity: 2.0, color },
        Light::Rectangle {
            position: [1.0, 4.0, -2.0],
            direction: down,
            up,
            width: 0.5,
            height: 0.25,
            intensity: 9.0,
            color,
        },
        Light::Disk { position: [-1.0, 4.0, -2.0], direction: down, radius: 0.25, intensity: 8.0, color },
        Light::Sphere { position: [0.0, 2.5, -1.0], radius: 0.125, intensity: 7.0, color },
    ]);
    Ok(scene)
}

/// Bakes [`all_lights`] with a few functions.
///
/// # Errors
/// Errors of loading and of the bake.
pub fn lit(functions: usize) -> Result<BakedScene> {
    Ok(bake(&all_lights()?, &settings(functions), &())?.0)
}

/// Bakes [`all_lights`] in metal, with glossy transfer and cube maps.
///
/// # Errors
/// Errors of loading and of the bake.
pub fn shining(functions: usize) -> Result<BakedScene> {
    let mut scene = all_lights()?;
    scene.materials.iter_mut().for_each(|material| (material.metallic, material.roughness) = (1.0, 0.4));
    let mut settings = settings(functions);
    if let Some(gloss) = &mut settings.gloss {
        gloss.cube_maps = CubeMapSettings { count: 2, side: 8, most_open: 1.0, ..gloss.cube_maps };
    }
    Ok(bake(&scene, &settings, &())?.0)
}

/// Bakes [`all_lights`] for an environment.
///
/// # Errors
/// Errors of loading and of the bake.
pub fn object(functions: usize) -> Result<BakedScene> {
    Ok(bake(&all_lights()?, &settings(functions).for_environment().normalised(), &())?.0)
}

/// Bakes the walking figure, which animations deform.
///
/// # Errors
/// Errors of loading and of the bake.
pub fn walking(functions: usize) -> Result<BakedScene> {
    let scene = rebounce::io::load("builtin:walker")?;
    Ok(bake(&scene, &settings(functions), &())?.0)
}

/// Solves [`all_lights`] with a few functions.
///
/// # Errors
/// Errors of loading and of the solver.
pub fn solved(functions: usize) -> Result<BakedScene> {
    let radiosity = RadiositySettings { rays: vec![64], ..RadiositySettings::default() };
    Ok(solve(
        &all_lights()?,
        &SolveSettings { bake: settings(functions), radiosity, solver: FixedSolver::Radiosity },
    )?
    .0)
}

/// Solves the Cornell box by wavelets, with a lightmap.
///
/// # Errors
/// Errors of loading and of the solver.
pub fn charted(functions: usize) -> Result<BakedScene> {
    let wavelets = WaveletSettings { max_level: 1, convergence: 0.5, ..WaveletSettings::default() };
    let solver = FixedSolver::Wavelet(wavelets);
    let radiosity = RadiositySettings::default();
    let scene = rebounce::io::load("builtin:cornell-box")?;
    Ok(solve(&scene, &SolveSettings { bake: settings(functions), radiosity, solver })?.0)
}

/// Returns the scene with `name` for every name.
pub fn named(scene: &BakedScene, name: &str) -> BakedScene {
    let mut scene = scene.clone();
    let m = &mut scene.meta;
    [&mut m.generator, &mut m.scene_name, &mut m.bake.preset]
        .into_iter()
        .for_each(|text| *text = name.to_owned());
    m.materials.iter_mut().for_each(|material| material.name = name.to_owned());
    m.textures.iter_mut().for_each(|texture| texture.name = name.to_owned());
    m.animations.iter_mut().for_each(|animation| animation.name.insert_str(0, name));
    scene
}

/// Adds a parallelogram with a material of its own. Its middle and half sides are shares of half the scene's size, from
/// the scene's middle.
pub fn add_parallelogram(scene: &mut Scene, at: Vec3, sides: [Vec3; 2], material: Material) {
    let (low, high) = scene.bounds();
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let [u, v] = sides;
    let [first, number] = [scene.positions.len() as u32, scene.materials.len() as u32];
    for (a, b) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
        scene.positions.push(middle + half * (at + a * u + b * v));
        scene.normals.push((half * u).cross(half * v).normalize());
        scene.uvs.push(Vec2::ZERO);
    }
    scene.triangles.extend([[0, 1, 2], [0, 2, 3]].map(|t| t.map(|i| first + i)));
    scene.triangle_material.extend([number; 2]);
    scene.materials.push(material);
}
