//! Effects that pictures add to Lambertian surfaces: normal maps, highlights, emission, tone mapping.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;

use rebounce_shared::baked::BakedScene;
use rebounce_shared::glam::Vec3;
use rebounce_shared::light::Light;
use rebounce_shared::link::Link;
use rebounce_shared::rbn::LinkMatrix;
use rebounce_shared::rbn::meta::{DetailTexture, Texture};
use rebounce_viewer::gpu::Gpu;
use rebounce_viewer::renderer::Renderer;
use rebounce_viewer::scene::GpuScene;
use rebounce_viewer::settings::{Display, Mode, ToneMapping};

const SIZE: u32 = 33;
/// The wall in the middle of the picture: inward normal +z, u along x, v along y.
const WALL: usize = 4;

/// Adds a texture of one colour to the scene; returns its index.
fn add_texture(scene: &mut BakedScene, rgb: [u8; 3], data: bool) -> u32 {
    let mut png = std::io::Cursor::new(Vec::new());
    image::RgbImage::from_pixel(4, 4, image::Rgb(rgb)).write_to(&mut png, image::ImageFormat::Png).unwrap();
    let (offset, png) = (scene.texture_bytes.len() as u64, png.into_inner());
    scene.texture_bytes.extend(&png);
    scene.meta.textures.push(Texture {
        mime: "image/png".into(),
        offset,
        len: png.len() as u64,
        width: 4,
        height: 4,
        linear_filter: true,
        data,
        ..Texture::default()
    });
    scene.meta.textures.len() as u32 - 1
}

fn detail(texture: u32) -> Option<DetailTexture> {
    Some(DetailTexture { texture, uv_from_vertex: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] })
}

/// The room with this normal, in the tangent space of a glTF normal map, on the entire wall.
fn bumped(scene: &BakedScene, normal: Vec3) -> BakedScene {
    let mut scene = scene.clone();
    let texel = ((normal.normalize() * 0.5 + 0.5) * 255.0).round();
    let texture = add_texture(&mut scene, texel.to_array().map(|x| x as u8), true);
    scene.meta.materials[WALL].normal_texture = detail(texture);
    scene
}

fn renderer(gpu: &Gpu, scene: &BakedScene, mode: Mode) -> Renderer {
    let mut renderer = Renderer::new(gpu.clone()).unwrap();
    let loaded =
        pollster::block_on(GpuScene::upload(gpu, renderer.pipelines().loaders(), scene.clone())).unwrap();
    renderer.install(loaded).unwrap();
    renderer.set_tone_mapping(ToneMapping::Neutral);
    renderer.set_auto_exposure(false);
    renderer.set_mode(mode);
    renderer
}

/// The smallest channel of the middle pixel, before Khronos PBR Neutral and sRGB; tone mapping and encoding
/// preserve the smallest channel.
fn middle(renderer: &mut Renderer) -> f32 {
    let pixels = pollster::block_on(renderer.read_pixels(SIZE, SIZE).unwrap().wait()).unwrap();
    let at = 4 * ((SIZE / 2) * SIZE + SIZE / 2) as usize;
    let rgb = &pixels[at..at + 3];
    let least = *rgb.iter().min().unwrap() as f32 / 255.0;
    // 225 is 0.75: from 0.76 on, colours are compressed.
    assert!(least > 0.05 && rgb.iter().all(|c| *c < 225), "badly exposed: {rgb:?}");
    let linear = if least <= 0.04045 { least / 12.92 } else { ((least + 0.055) / 1.055).powf(2.4) };
    if linear < 0.04 { (linear / 6.25).sqrt() } else { linear + 0.04 }
}

fn value(gpu: &Gpu, scene: &BakedScene, mode: Mode) -> f32 {
    middle(&mut renderer(gpu, scene, mode))
}

/// The bounced light, computed by this way.
fn bounced(gpu: &Gpu, scene: &BakedScene, way: Display) -> f32 {
    let mut renderer = renderer(gpu, scene, Mode::Indirect);
    renderer.set_display(way);
    middle(&mut renderer)
}

#[test]
fn a_flat_normal_map_changes_nothing() {
    let Some(gpu) = common::gpu() else { return };
    let mut plain = common::room(&[3, 6]);
    plain.meta.lights =
        vec![Light::Point { position: [0.3, 0.4, 0.2], intensity: 0.7, color: [1.0; 3], radius: 0.0 }];
    let flat = bumped(&plain, Vec3::Z);
    let direct = [&plain, &flat].map(|scene| value(&gpu, scene, Mode::Direct));
    let [lookup, splat] =
        [Display::Lookup, Display::Splat].map(|way| [&plain, &flat].map(|scene| bounced(&gpu, scene, way)));
    for [plain, flat] in [direct, lookup, splat] {
        assert!((plain - flat).abs() < 0.02 * plain, "{plain} {flat}");
    }
    gpu.check().unwrap();
}

/// The place on the wall at the middle of the picture.
fn place(renderer: &Renderer) -> Vec3 {
    let camera = renderer.camera();
    let [eye, target] = [camera.position, camera.target].map(|p| Vec3::from(p.map(|x| x as f32)));
    let ahead = (target - eye).normalize();
    eye + ahead * ((-1.0 - eye.z) / ahead.z)
}

/// Deviations of the wall's normal: as in a normal map, and in the room. Red is along u, here x; green against v,
/// here y.
fn bends() -> impl Iterator<Item = (Vec3, Vec3)> {
    [[0.3, 0.0], [-0.3, 0.0], [0.0, 0.4], [0.1, -0.5]]
        .into_iter()
        .map(|[x, y]| (Vec3::new(x, y, 1.0), Vec3::new(x, -y, 1.0).normalize()))
}

#[test]
fn bounced_light_follows_bent_normals_to_where_it_comes_from() {
    let Some(gpu) = common::gpu() else { return };
    for sides in [&[8][..], &[3, 8]] {
        let mut scene = common::room(sides);
        // A single sender emits light, in the middle of a wall perpendicular to the wall in the picture.
        let beside = Vec3::new(1.0, 0.3, 0.2);
        let nearest = |a: &u32, b: &u32| {
            let distance = |i: &u32| scene.points[*i as usize].position().distance(beside);
            distance(a).total_cmp(&distance(b))
        };
        let sender = (0..scene.meta.levels[0].count).min_by(nearest).unwrap();
        let rows: Vec<_> =
            (0..scene.points.len())
                .map(|i| {
                    if i < scene.meta.levels[0].count as usize {
                        vec![Link::pack(sender, 0.5)]
                    } else {
                        vec![]
                    }
                })
                .collect();
        scene.links = LinkMatrix::from_rows(&rows);
        scene.later = LinkMatrix::from_rows(&[]);
        scene.meta.later_levels = 0;
        let mut plain = renderer(&gpu, &scene, Mode::Indirect);
        let way = (scene.points[sender as usize].position() - place(&plain)).normalize();
        let flat = middle(&mut plain);
        for ((texel, bent), display) in bends().zip([Display::Lookup, Display::Splat].into_iter().cycle()) {
            let expected = way.dot(bent) / way.z;
            let ratio = bounced(&gpu, &bumped(&scene, texel), display) / flat;
            if sides.len() == 1 {
                assert!((ratio - expected).abs() < 0.06 * expected, "{bent}: {ratio}, expected {expected}");
            } else {
                // Parents contribute light at their own positions, here far from their children.
                let share = (ratio - 1.0) / (expected - 1.0);
                assert!((0.15..1.5).contains(&share), "{bent}: {ratio}, expected about {expected}");
            }
        }
    }
    gpu.check().unwrap();
}

#[test]
fn direct_light_follows_bent_normals_by_the_cosine() {
    let Some(gpu) = common::gpu() else { return };
    let scene = common::room(&[3]);
    let mut plain = renderer(&gpu, &scene, Mode::Direct);
    let to_light = (Vec3::new(0.3, 0.4, 0.2) - place(&plain)).normalize();
    let flat = middle(&mut plain);
    for (texel, bent) in bends() {
        let expected = to_light.dot(bent) / to_light.z;
        let ratio = value(&gpu, &bumped(&scene, texel), Mode::Direct) / flat;
        assert!((ratio - expected).abs() < 0.04 * expected, "{bent}: {ratio}, expected {expected}");
    }
    gpu.check().unwrap();
}

#[test]
fn emission_shines_by_its_texture_without_any_lamp() {
    let Some(gpu) = common::gpu() else { return };
    let mut scene = common::room(&[3]);
    scene.meta.lights.clear();
    scene.meta.materials[WALL].emission = [0.4; 3];
    let whole = value(&gpu, &scene, Mode::Direct);
    assert!((whole - 0.4).abs() < 0.01, "{whole}");
    // sRGB 188 is half the light.
    let texture = add_texture(&mut scene, [188; 3], false);
    scene.meta.materials[WALL].emission_texture = detail(texture);
    let half = value(&gpu, &scene, Mode::Direct);
    assert!((half - 0.2).abs() < 0.01, "{half}");
    gpu.check().unwrap();
}

#[test]
fn a_polished_wall_shines_where_it_mirrors_the_lamp_and_a_rough_one_all_over() {
    let Some(gpu) = common::gpu() else { return };
    let with = |roughness: f32, metallic: f32, lamp: [f64; 3]| {
        let mut scene = common::room(&[3]);
        scene.meta.lights = vec![common::lamp(lamp)];
        let wall = &mut scene.meta.materials[WALL];
        (wall.roughness, wall.metallic, wall.specular) = (roughness, metallic, 1.0);
        wall.base_color = [0.5, 0.5, 0.5, 1.0];
        let mut renderer = renderer(&gpu, &scene, Mode::Direct);
        renderer.set_exposure(-2.0).unwrap();
        let pixels = pollster::block_on(renderer.read_pixels(SIZE, SIZE).unwrap().wait()).unwrap();
        let at = 4 * ((SIZE / 2) * SIZE + SIZE / 2) as usize;
        pixels[at] as i32
    };
    // The eye is at (0.2, 0.1, 0.9) and looks at (-0.1, -0.2, -1): its way goes on to (-0.37, -0.47, 0.7).
    let (mirrored, aside) = ([-0.37, -0.47, 0.7], [0.6, 0.5, 0.7]);
    assert!(with(0.3, 0.0, mirrored) > with(1.0, 0.0, mirrored) + 10, "a varnish");
    assert!(with(0.3, 1.0, mirrored) > with(0.3, 0.0, mirrored) + 10, "metal more than varnish");
    let (polished, rough) = (with(0.1, 1.0, aside), with(1.0, 1.0, aside));
    assert!(
        polished < 5 && rough > 15,
        "a polished metal is dark beside, a rough one is not: {polished}, {rough}"
    );
    gpu.check().unwrap();
}

#[test]
fn tone_curves_rise_and_stay_in_range() {
    let Some(gpu) = common::gpu() else { return };
    let mut renderer = renderer(&gpu, &common::room(&[3]), Mode::Direct);
    let mut pictures = Vec::new();
    for tone_mapping in [ToneMapping::Neutral, ToneMapping::Agx] {
        renderer.set_tone_mapping(tone_mapping);
        let mut before = -1.0;
        for stops in [-8.0, -4.0, 0.0, 4.0, 8.0] {
            renderer.set_exposure(stops).unwrap();
            let pixels = pollster::block_on(renderer.read_pixels(SIZE, SIZE).unwrap().wait()).unwrap();
            let mean = pixels.iter().map(|&x| x as f64).sum::<f64>() / pixels.len() as f64;
            assert!(mean > before, "{tone_mapping:?} at {stops}: {mean} after {before}");
            before = mean;
            pictures.push(pixels);
        }
    }
    assert!(pictures[2] != pictures[7]);
    gpu.check().unwrap();
}

/// A rough wall under a polished clear layer, and under glass of a high index of refraction, in place of the lamp's mirror
/// image; lit by a point and by a sphere.
#[cfg(feature = "radiosity")]
#[test]
fn a_rough_wall_shines_under_a_clear_layer_and_by_its_index_of_refraction() {
    use rebounce_shared::rbn::specular::SpecularExtras;
    let Some(gpu) = common::gpu() else { return };
    let position = [-0.37, -0.47, 0.7];
    let lamps =
        [common::lamp(position), Light::Sphere { position, radius: 0.05, intensity: 80.0, color: [1.0; 3] }];
    for lamp in lamps {
        let with = |roughness: f32, specular: f32, extras: SpecularExtras| {
            let mut scene = common::room(&[3]);
            scene.meta.lights = vec![lamp.clone()];
            let wall = &mut scene.meta.materials[WALL];
            (wall.roughness, wall.specular, wall.specular_extras) = (roughness, specular, extras);
            wall.base_color = [0.5, 0.5, 0.5, 1.0];
            let mut renderer = renderer(&gpu, &scene, Mode::Direct);
            renderer.set_exposure(-2.0).unwrap();
            let pixels = pollster::block_on(renderer.read_pixels(SIZE, SIZE).unwrap().wait()).unwrap();
            let at = 4 * ((SIZE / 2) * SIZE + SIZE / 2) as usize;
            pixels[at..at + 3].iter().map(|c| i32::from(*c)).collect::<Vec<_>>()
        };
        let plain = SpecularExtras::default();
        let coat = SpecularExtras { clearcoat: 1.0, clearcoat_roughness: 0.3, ..plain };
        let rough = with(1.0, 1.0, plain)[0];
        assert!(with(1.0, 1.0, coat)[0] > rough + 10, "a clear layer");
        assert!(with(1.0, 0.0, coat)[0] > with(1.0, 0.0, plain)[0] + 10, "a clear layer over a matt wall");
        let half = SpecularExtras { clearcoat: 0.5, ..coat };
        let (all, half) = (with(1.0, 1.0, coat)[0], with(1.0, 1.0, half)[0]);
        assert!(rough < half && half < all, "half a layer: {rough} {half} {all}");
        let rougher = SpecularExtras { clearcoat_roughness: 1.0, ..coat };
        assert!(with(1.0, 1.0, rougher)[0] < all - 10, "a rough layer");
        let by_ior = [1.0, 1.5, 2.4].map(|ior| with(0.3, 1.0, SpecularExtras { ior, ..plain })[0]);
        assert!(by_ior[0] + 10 < by_ior[1] && by_ior[1] + 10 < by_ior[2], "{by_ior:?}");
        let white = with(0.3, 1.0, plain);
        let red = with(0.3, 1.0, SpecularExtras { specular_color: [1.0, 0.0, 0.0], ..plain });
        assert!(red[0] > white[0] - 5 && red[1] + 10 < white[1], "a coloured highlight: {red:?}, {white:?}");
    }
    gpu.check().unwrap();
}

/// Integrates the shader's own brdf over the hemisphere for every roughness and eye.
const FURNACE: &str = "
@group(0) @binding(0) var<storage, read_write> sums: array<f32>;
const STEPS = 192u;
const PI = 3.14159265358979;
@compute @workgroup_size(64)
fn furnace(@builtin(global_invocation_id) id: vec3u) {
    let roughness = 0.3 + 0.7 * f32(id.x % 8u) / 7.0;
    let cosine = 0.25 + 0.75 * f32(id.x / 8u % 4u) / 3.0;
    let metallic = f32(id.x / 32u);
    let to_eye = vec3f(sqrt(1.0 - cosine * cosine), 0.0, cosine);
    var sum = 0.0;
    for (var i = 0u; i < STEPS; i++) {
        for (var j = 0u; j < STEPS; j++) {
            // Even in the square of the sine: the density of the cosine.
            let sine2 = (f32(i) + 0.5) / f32(STEPS);
            let angle = (f32(j) + 0.5) / f32(STEPS) * 2.0 * PI;
            let to_light = vec3f(sqrt(sine2) * vec2f(cos(angle), sin(angle)), sqrt(1.0 - sine2));
            sum += PI * brdf(vec3f(1.0), LOOK, vec3f(0.0, 0.0, 1.0), to_light, to_eye, 0.0).x;
        }
    }
    sums[id.x] = sum / f32(STEPS * STEPS);
}";

/// Returns the furnace's sums with this brdf and this expression of a `MaterialRecord`: by roughness (8, from 0.3 to 1), then
/// by eye (4), then by metalness (0 and 1).
fn furnace(gpu: &Gpu, brdf: &str, look: &str) -> Vec<f32> {
    let parts = [
        include_str!("../src/shaders/octahedral.wgsl"),
        include_str!("../src/shaders/surface.wgsl"),
        include_str!("../src/shaders/lobe.wgsl"),
        brdf,
        &FURNACE.replace("LOOK", look),
    ];
    let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(parts.concat().into()),
    });
    let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: None,
        module: &module,
        entry_point: Some("furnace"),
        compilation_options: Default::default(),
        cache: None,
    });
    let sums = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: 64 * 4,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: sums.as_entire_binding() }],
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(1, 1, 1);
    }
    gpu.queue.submit([encoder.finish()]);
    let readback = rebounce_viewer::readback::Readback::buffer(gpu, &sums);
    bytemuck::pod_collect_to_vec(&pollster::block_on(readback.wait()).unwrap())
}

const BRDF: &str = include_str!("../src/shaders/brdf.wgsl");
const BRDF_COATED: &str = include_str!("../src/shaders/radiosity/brdf_coated.wgsl");

#[test]
fn a_white_surface_gives_back_what_arrives() {
    let Some(gpu) = common::gpu() else { return };
    let plain = "MaterialRecord(vec3f(0.0), 1.0, metallic, roughness, 0.0, 0.0)";
    let coatless = "MaterialRecord(vec3f(0.0), 1.0, metallic, roughness, 0.0, 0.0, vec3f(0.04), 0.0)";
    let [plain, coatless] =
        [(BRDF, plain), (BRDF_COATED, coatless)].map(|(brdf, look)| furnace(&gpu, brdf, look));
    for (i, (sum, same)) in plain.iter().zip(coatless).enumerate() {
        let (roughness, eye, metal) = (i % 8, i / 8 % 4, i / 32 == 1);
        assert!((sum - 1.0).abs() < 0.05, "roughness {roughness}, eye {eye}, metal {metal}: {sum}");
        assert!((sum - same).abs() < 1e-4, "without a clear layer: {sum} {same}");
    }
    gpu.check().unwrap();
}

#[test]
fn a_white_surface_under_a_clear_layer_or_of_any_index_of_refraction_makes_no_light() {
    let Some(gpu) = common::gpu() else { return };
    // Strengths of the layer, its roughness, specular strength and reflectance head on.
    for (clearcoat, rough, specular, head_on) in [
        ("1.0", "0.3", "1.0", "0.04"),
        ("0.5", "0.3", "1.0", "0.04"),
        ("1.0", "0.6", "1.0", "0.04"),
        ("1.0", "1.0", "1.0", "0.04"),
        ("1.0", "roughness", "0.0", "0.0"),
        ("1.0", "roughness", "1.0", "0.17"),
        ("0.0", "0.0", "1.0", "0.0"),
        ("0.0", "0.0", "1.0", "0.17"),
        ("0.0", "0.0", "1.0", "0.5"),
        ("0.0", "0.0", "1.0", "1.0"),
    ] {
        let look = format!(
            "MaterialRecord(vec3f(0.0), {specular}, metallic, roughness, 0.0, {clearcoat}, vec3f({head_on}), {rough})"
        );
        let sums = furnace(&gpu, BRDF_COATED, &look);
        let (least, most) = (sums.iter()).fold((f32::MAX, 0.0f32), |(a, b), x| (a.min(*x), b.max(*x)));
        // Fits of a mirror under white add up.
        let bound = if head_on == "1.0" { 1.06 } else { 1.045 };
        assert!(least > 0.95 && most < bound, "{look}: {least} to {most}");
    }
    gpu.check().unwrap();
}
