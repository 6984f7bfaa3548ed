//! Surfaces of one's own: two metaballs and a quadric on a floor, without a triangle in the light transport.
//!
//! `cargo run --release --example implicit [FOLDER]` bakes the surfaces, renders them, and measures the error of the
//! bounced light against the path tracer, which meets the same surfaces.

use glam::{Vec2, Vec3};
use rebounce::geometry::{Gloss, Hit, Ray, Surfaces, Tessellate};
use rebounce::io::picture::Only;
use rebounce::light::illumination::Illumination;
use rebounce::prelude::*;
use rebounce::scene::TriangleMesh;
use rebounce::shared::rbn::meta::Material;
use rebounce::transport::direct_to_indirect::DirectToIndirect;
use rebounce::verify::compare::compare;
use rebounce::verify::expose::Exposure;
use rebounce::verify::path_trace::{Settings, path_trace};
use rebounce::verify::render::render;
use std::error::Error;
use std::path::Path;

/// Half the side of the floor.
const FLOOR: f32 = 3.0;
/// Centres and radii of influence of the metaballs.
const BALLS: [(Vec3, f32); 2] = [(Vec3::new(-1.1, 0.75, 0.1), 1.3), (Vec3::new(-0.2, 0.65, -0.3), 1.1)];
/// The metaballs' surface is where their fields sum to this.
const LEVEL: f32 = 0.3;
/// Centre and half axes of the ellipsoid.
const ELLIPSOID: (Vec3, Vec3) = (Vec3::new(1.3, 0.8, 0.2), Vec3::new(0.6, 0.8, 0.5));
/// Reflectance of floor, metaballs and ellipsoid: also the materials.
const ALBEDOS: [Vec3; 3] = [Vec3::splat(0.7), Vec3::new(0.8, 0.3, 0.2), Vec3::new(0.2, 0.5, 0.8)];
/// Steps of the search for a root within the metaballs' bounds.
const STEPS: u32 = 96;

/// The scene's surfaces.
struct Implicit;

/// Field of the metaballs less [`LEVEL`], and its gradient: positive inside.
fn metaballs(p: Vec3) -> (f32, Vec3) {
    let (mut field, mut gradient) = (-LEVEL, Vec3::ZERO);
    for (centre, radius) in BALLS {
        let offset = p - centre;
        let rest = 1.0 - offset.length_squared() / (radius * radius);
        if rest > 0.0 {
            field += rest * rest;
            gradient -= offset * (4.0 * rest / (radius * radius));
        }
    }
    (field, gradient)
}

/// Distances at which a ray enters and leaves a box.
fn slab(ray: &Ray, low: Vec3, high: Vec3) -> Option<(f32, f32)> {
    let inverse = ray.direction.recip();
    let (a, b) = ((low - ray.origin) * inverse, (high - ray.origin) * inverse);
    let (near, far) = (a.min(b).max_element().max(0.0), a.max(b).min_element().min(ray.max_distance));
    (near < far).then_some((near, far))
}

/// Nearest distance to the metaballs from outside: the first change of sign, bisected.
fn cast_metaballs(ray: &Ray) -> Option<f32> {
    let (low, high) = bounds_of_balls();
    let (near, far) = slab(ray, low, high)?;
    let field = |t: f32| metaballs(ray.origin + ray.direction * t).0;
    let step = (far - near) / STEPS as f32;
    let mut before = near;
    if field(before) > 0.0 {
        return None;
    }
    for k in 1..=STEPS {
        let after = near + step * k as f32;
        if field(after) > 0.0 {
            let (mut outside, mut inside) = (before, after);
            for _ in 0..24 {
                let middle = 0.5 * (outside + inside);
                if field(middle) > 0.0 { inside = middle } else { outside = middle }
            }
            return Some(outside);
        }
        before = after;
    }
    None
}

/// Nearest distance to the ellipsoid from outside: the smaller root of a quadratic.
fn cast_ellipsoid(ray: &Ray) -> Option<f32> {
    let (centre, axes) = ELLIPSOID;
    let (o, d) = ((ray.origin - centre) / axes, ray.direction / axes);
    let (a, b, c) = (d.length_squared(), o.dot(d), o.length_squared() - 1.0);
    let root = (b * b - a * c).max(0.0).sqrt();
    let distance = (-b - root) / a;
    (b * b > a * c && c > 0.0 && distance > 0.0 && distance < ray.max_distance).then_some(distance)
}

fn cast_floor(ray: &Ray) -> Option<f32> {
    let distance = -ray.origin.y / ray.direction.y;
    let at = ray.origin + ray.direction * distance;
    let is_hit = distance > 0.0 && distance < ray.max_distance && at.x.abs().max(at.z.abs()) < FLOOR;
    is_hit.then_some(distance)
}

fn bounds_of_balls() -> (Vec3, Vec3) {
    // The reach of the field is a little more than the surface.
    let low = BALLS.iter().map(|(centre, radius)| centre - *radius).reduce(Vec3::min);
    let high = BALLS.iter().map(|(centre, radius)| centre + *radius).reduce(Vec3::max);
    (low.unwrap_or_default(), high.unwrap_or_default())
}

/// Unit normal of a surface, by number: floor, metaballs, ellipsoid.
fn normal(surface: usize, p: Vec3) -> Vec3 {
    let (centre, axes) = ELLIPSOID;
    match surface {
        0 => Vec3::Y,
        1 => -metaballs(p).1.normalize(),
        _ => ((p - centre) / (axes * axes)).normalize(),
    }
}

impl Surfaces for Implicit {
    fn cast(&self, ray: &Ray, _seed: u32) -> Option<Hit> {
        let casts = [cast_floor, cast_metaballs, cast_ellipsoid].into_iter().enumerate();
        let hits = casts.filter_map(|(surface, cast)| Some((surface, cast(ray)?)));
        let (surface, distance) = hits.min_by(|a, b| a.1.total_cmp(&b.1))?;
        let position = ray.origin + ray.direction * distance;
        let front = normal(surface, position);
        // The floor has a back, which reflects nothing.
        let is_front = front.dot(ray.direction) < 0.0;
        Some(Hit {
            distance,
            position,
            geometric_normal: if is_front { front } else { -front },
            normal: front,
            albedo: if is_front { ALBEDOS[surface] } else { Vec3::ZERO },
            emission: Vec3::ZERO,
            emitter: None,
            is_unlit: false,
            group: 0,
            lightmap: None,
            gloss: Gloss::MATT,
        })
    }

    fn see(&self, ray: &Ray, seed: u32) -> Option<Hit> {
        // The floor's back is invisible; nothing is below it.
        self.cast(ray, seed).filter(|hit| hit.faces(ray.direction))
    }

    fn transmittance(&self, from: Vec3, to: Vec3) -> Vec3 {
        let way = to - from;
        let (direction, distance) = (way.normalize(), way.length());
        let ray = Ray { origin: from, direction, max_distance: distance, spread: Ray::VISIBILITY };
        let is_hidden = self.cast(&ray, 0).is_some_and(|hit| hit.distance < distance - self.epsilon());
        if is_hidden { Vec3::ZERO } else { Vec3::ONE }
    }

    fn bounds(&self) -> (Vec3, Vec3) {
        (Vec3::new(-FLOOR, 0.0, -FLOOR), Vec3::new(FLOOR, 1.6, FLOOR))
    }

    fn epsilon(&self) -> f32 {
        1e-4
    }
}

impl Tessellate for Implicit {
    /// The blobs are seen as from a point within: each is star-shaped about it.
    fn tessellate(&self, tolerance: f32) -> TriangleMesh {
        let mut mesh = TriangleMesh::default();
        let corners = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)];
        mesh.positions.extend(corners.map(|(x, z)| FLOOR * Vec3::new(x, 0.0, z)));
        mesh.normals.extend([Vec3::Y; 4]);
        mesh.triangles.extend([[0, 1, 2], [0, 2, 3]]);
        mesh.triangle_material.extend([0, 0]);
        let middle = 0.5 * (BALLS[0].0 + BALLS[1].0);
        let of_balls = |direction: Vec3| {
            let (mut inside, mut outside) = (0.0, 3.0);
            for _ in 0..32 {
                let at = 0.5 * (inside + outside);
                if metaballs(middle + direction * at).0 > 0.0 { inside = at } else { outside = at }
            }
            middle + direction * inside
        };
        let (centre, axes) = ELLIPSOID;
        let of_ellipsoid = |direction: Vec3| centre + direction / (direction / axes).length();
        // The sagitta of a chord of a circle of radius 1.
        let rows = (std::f32::consts::PI / (8.0 * tolerance).sqrt()).ceil() as u32;
        globe(&mut mesh, 1, rows, of_balls);
        globe(&mut mesh, 2, rows, of_ellipsoid);
        mesh
    }
}

/// Adds a closed surface, by its position in each direction from within.
fn globe(mesh: &mut TriangleMesh, surface: usize, rows: u32, position: impl Fn(Vec3) -> Vec3) {
    let (first, columns) = (mesh.positions.len() as u32, 2 * rows);
    for row in 0..=rows {
        for column in 0..=columns {
            let up = std::f32::consts::PI * row as f32 / rows as f32;
            let around = Vec2::from_angle(std::f32::consts::TAU * (column % columns) as f32 / columns as f32);
            let p = position(Vec3::new(up.sin() * around.x, up.cos(), up.sin() * around.y));
            mesh.positions.push(p);
            mesh.normals.push(normal(surface, p));
        }
    }
    for row in 0..rows {
        for column in 0..columns {
            let [a, b] = [row, row + 1].map(|row| first + row * (columns + 1) + column);
            if row > 0 {
                mesh.triangles.push([a, a + 1, b + 1]);
            }
            if row + 1 < rows {
                mesh.triangles.push([a, b + 1, b]);
            }
        }
    }
    mesh.triangle_material.resize(mesh.triangles.len(), surface as u32);
}

/// Materials, lamp and camera.
fn scene() -> Scene {
    let material =
        |albedo: Vec3| Material { base_color: albedo.extend(1.0).to_array(), ..Material::default() };
    Scene {
        name: "implicit".to_owned(),
        materials: ALBEDOS.map(material).to_vec(),
        lights: vec![Light::Point {
            position: [0.6, 2.6, 1.6],
            intensity: 20.0,
            color: [1.0; 3],
            radius: 0.0,
        }],
        cameras: vec![Camera {
            position: [0.2, 2.6, 4.6],
            target: [0.1, 0.4, 0.0],
            up: [0.0, 1.0, 0.0],
            yfov_deg: 45.0,
        }],
        ..Scene::default()
    }
}

/// Bakes the surfaces; returns the error of the bounced light in the camera's view against the path tracer's.
pub fn run(folder: Option<&Path>) -> Result<f64, Box<dyn Error>> {
    let scene = scene();
    let mut settings = BakeSettings::new(Preset::Draft);
    settings.place.functions = 16_000;
    let (baked, report) =
        Baker::new(&settings).bake_surfaces(&scene, &Implicit, &DirectToIndirect)?.ok_or("no file")?;
    let (camera, lights) = (&scene.cameras[0], &scene.lights[..]);
    let exposure = |samples, seed| Exposure { size: [120, 80], samples, seed };
    let illumination = Illumination::of(&Implicit, lights, scene.origin, 1.0);
    let truth = |seed| {
        let settings = Settings { only: Only::Indirect, ..Settings::default() };
        path_trace(&Implicit, scene.origin, camera, &illumination, exposure(256, seed), settings, || ())
    };
    let picture = render(&baked, &Implicit, camera, lights, exposure(16, 3), Only::Indirect, || ());
    let found = compare(&picture, &truth(1), Some(&truth(2)))?;
    let error = found.error.value.or(found.error.at_most).ok_or("the references are too noisy")?;
    println!(
        "{} functions, {} links; error {error:.3}, bias {:+.3}",
        report.functions, report.links, found.bias
    );
    if let Some(folder) = folder {
        save(folder.join("implicit.rbn"), &baked)?;
        let exposure = Exposure { size: [720, 480], samples: 16, seed: 1 };
        let picture = render(&baked, &Implicit, camera, lights, exposure, Only::All, || ());
        picture.write(&folder.join("implicit.png"), 1.0)?;
        println!("saved {0}/implicit.rbn and {0}/implicit.png", folder.display());
    }
    Ok(error)
}

#[allow(dead_code, reason = "tests call `run`")]
fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).map_or_else(std::env::temp_dir, Into::into);
    run(Some(&folder)).map(|_| ())
}
