//! Figures of exact surfaces as tables of Markdown:
//!
//! `cad [--rays N] [FILE.step ...]`, for `cargo xtask bench-cad`: rays against exact faces and against tessellations;
//! `cad --wavelets SCENE,SCENE [--quick]`, for `cargo xtask bench-wavelet`: wavelet radiosity on exact faces and on triangles of
//! generated scenes, in the columns of Alonso et al. 2001, with errors against a path tracer;
//! `cad --coarse COUNT OUT.rbn FILE.step` bakes a file as about COUNT triangles.

mod coarse;
mod rays;
mod wavelets;

use anyhow::{Context, Result};
use rebounce::scene::Scene;

/// Generated scenes.
const SCENES: [&str; 4] = ["teapot", "tori", "chess", "opera"];
/// Rays of all scenes together.
const RAYS: u64 = 10_000_000;
/// Chord error of the tessellations, a share of the scene's diagonal.
const CHORD: f32 = 1e-4;

fn main() -> Result<()> {
    let (mut files, mut rays, mut is_quick) = (Vec::new(), RAYS, false);
    let (mut coarse, mut tables) = (None, None);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--rays" => rays = arguments.next().context("--rays needs a number")?.parse()?,
            "--quick" => is_quick = true,
            "--wavelets" => tables = Some(arguments.next().context("--wavelets needs names of scenes")?),
            "--coarse" => {
                let count = arguments.next().context("--coarse needs a number")?.parse()?;
                coarse = Some((count, arguments.next().context("which file is written?")?));
            }
            _ => files.push(argument),
        }
    }
    if let Some((count, out)) = coarse {
        return coarse::write(files.first().context("which file?")?, count, out.as_ref());
    }
    if let Some(names) = tables {
        return wavelets::tables(&names.split(',').collect::<Vec<_>>(), is_quick);
    }
    let builtin = SCENES.iter().map(|name| format!("builtin:{name}"));
    let load = |spec: String| {
        let scene = rebounce::io::load(&spec)?;
        let name = spec.rsplit(['/', ':']).next().unwrap_or(&spec).to_owned();
        Ok((name, scene))
    };
    let scenes: Vec<(String, Scene)> = builtin.chain(files).map(load).collect::<Result<_>>()?;
    println!("## Lost hits\n");
    println!(
        "Random rays through each scene, against exact faces and against their tessellation (chord error\n\
         a {:.0}th of the diagonal). *Lost*: faces let a ray pass where the triangles go on around it;\n\
         *lost by triangles*: the reverse, mostly at cracks between tessellations of neighbouring faces.\n\
         *At rims*: they differ where either ends or turns away from the ray.\n",
        1.0 / CHORD
    );
    rays::lost_hits(&scenes, rays / scenes.len() as u64, CHORD)?;
    println!("\n## Rays a second\n");
    println!("One thread, rays that leave surfaces, against the triangles that look alike.\n");
    rays::speed(&scenes)
}
