use rebounce::transport::antiradiance::Pool;
use rebounce_shared::antiradiance::*;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::glam::Vec3;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let scene = BakedScene::from_bytes(&std::fs::read(&args[1]).unwrap()).unwrap();
    let most: usize = args[2].parse().unwrap();
    let bins: usize = args[3].parse().unwrap();
    let each = |call: &mut dyn FnMut(SceneTriangle)| {
        for draw in &scene.meta.draws {
            let first = draw.first_index as usize;
            for c in scene.indices[first..first + draw.index_count as usize].as_chunks::<3>().0 {
                let corners = c.map(|i| Vec3::from(scene.vertices[i as usize].position));
                call(SceneTriangle {
                    corners,
                    is_two_sided: scene.meta.materials[draw.material as usize].double_sided,
                    roughness: None,
                });
            }
        }
    };
    let at = |i: usize| [scene.points[i].position(), scene.points[i].normal()];
    let moves = |_: usize| false;
    let pp = PointPatches::new(&scene, &moves, [most, 256], (&each, &at));
    let patches = pp.patches(&at);
    let mut areas: Vec<f32> = patches.iter().map(|p| p.area()).collect();
    areas.sort_by(f32::total_cmp);
    println!(
        "{} patches, area {} median {} max {} least {}",
        patches.len(),
        areas.iter().sum::<f32>(),
        areas[areas.len() / 2],
        areas[areas.len() - 1],
        areas[0]
    );
    let origin = Vec3::from(scene.meta.origin.map(|x| x as f32));
    let lamp = Vec3::new(1.9, 2.2, 4.5) - origin;
    for iteration in [Iteration::Ordered, Iteration::Symmetric] {
        let settings = SolverSettings { bins, iteration, iterations: 12, ..SolverSettings::default() };
        let solver = AntiradianceSolver::new(&patches, &settings, &Pool);
        let direct: Vec<Vec3> = patches
            .iter()
            .map(|p| {
                let o = lamp - p.position();
                if o.length() > 4.0 {
                    return Vec3::ZERO;
                }
                Vec3::splat(o.normalize().dot(p.normal).max(0.0) / o.length_squared().max(0.05))
            })
            .collect();
        let sum_direct: f32 = patches.iter().zip(&direct).map(|(p, d)| p.area() * d.x).sum();
        let (found, figures) = solver.solve(&solver.even_light(direct), &settings, &Pool, &mut ());
        let sum: f32 = patches.iter().zip(&found).map(|(p, d)| p.area() * d.x).sum();
        let worst = found.iter().map(|v| v.abs().max_element()).fold(0.0, f32::max);
        println!("{iteration:?}: links {} direct {sum_direct} bounced {sum} worst {worst}", solver.links);
        println!("{:?}", figures.changes);
    }
}
