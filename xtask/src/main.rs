//! Development commands of the workspace: `cargo xtask demo`, `web`, `package`, `site`, `test`, `fidelity`,
//! `bench-web`, `bench-bake`, `bench-kernels`, `bench-cad`, `bench-wavelet`, `bench-radiosity`, `bench-antiradiance`, `bench-scale`, `bench-gloss`, `fuzz`, `fuzz-step`, `audit`, `damage`, `soak`,
//! `kill-bake`, `plot-estimate`, `refine`, `check`, `docs`, `layers`, `names`, `light-kinds`, `install`.

mod audit;
mod bench_antiradiance;
mod bench_bake;
mod bench_cad;
mod bench_kernels;
mod bench_radiosity;
mod bench_scale;
mod bench_wavelet;
mod bench_web;
mod bindgen;
mod bundle_size;
mod damage;
mod demo;
mod docs;
mod fidelity;
mod film;
mod function_order;
mod fuzz;
mod fuzz_step;
mod gate;
mod gloss;
mod install;
mod installed;
mod integrity;
mod kill_bake;
mod layers;
mod light_kinds;
mod names;
mod npm;
mod package;
mod plot_estimate;
mod plot_jacobian;
mod process;
mod refine;
mod report;
mod site;
mod soak;
mod sources;
mod test;
mod toolchain;
mod web;

use anyhow::{Result, bail};
use std::process::ExitCode;

const USAGE: &str = "\
cargo xtask demo [--scene FILE] [--port N] [--screenshot OUT.png]
                     bakes a scene (builtin:cornell-box), builds the viewer, serves it on 127.0.0.1;
                     with --screenshot: takes a picture in headless Chromium instead, and ends
cargo xtask film [--scene FILE] [--out OUT.webp]
                     bakes a scene (builtin:apartment), moves a lamp in headless Chromium, and makes an animated
                     picture (docs/relight.webp) of at most 3 MB; installs webp
cargo xtask check    format, lints, rustdoc, layers, names, docs, and the library for wasm; part of all tests
cargo xtask test [--long] [check|native|wasm|page|package|site|install|mpi [NAME]]
                     runs every test, those in the browser and of bakes over several processes included; or
                     one part. install, only by name: of the command, installed from its packages.
                     native NAME: tests whose path has NAME in it; page NAME: one of the files of web/test/page
cargo xtask web [--quick]
                     builds the viewer and its page into web/dist; --quick: for a test, without link-time optimisation
cargo xtask site [--preset NAME] [--samples N] [--quick] [--serve] [--port N]
                     builds the site of web/site into target/site, and serves it on 127.0.0.1;
                     N samples a pixel for its path-traced pictures; --quick: coarse scenes, small pictures
cargo xtask npm      builds the npm package of the command, without the native program, into baker/npm/dist
cargo xtask package  packs the npm packages, the native program among them, into target/package
cargo xtask fidelity [--presets draft,standard,fine] [--scenes DIR]
                     measures bakes against path-traced pictures and writes docs/reports/fidelity.md; DIR holds
                     scenes of yours in the same way: shots/NAME.shot.json, references/NAME.indirect.{a,b}.exr
cargo xtask bench-web [--scenes DIR] [--shot NAME]
                     times frames in headless Chromium beside three.js, same scene and light; DIR as above
cargo xtask bench-bake [--scene FILE] [--preset NAME] [--rounds N]
                     times bakes beside the rays that they cast, and with one thread; Sponza at standard, three times
cargo xtask bench-kernels
                     counts the instructions of a bake's kernels; installs valgrind
cargo xtask bench-radiosity [--functions N] [SCENE ...]
                     solves scenes in several ways on CPU and GPU, and bakes a vase with and without a group of its own
cargo xtask bench-antiradiance [--spp N | --page]
                     antiradiance against the path tracer, by bins, elements and iterations; writes docs/reports/antiradiance.md
                     with plots. Half an hour. --page: in headless Chromium; writes docs/reports/antiradiance-page.md
cargo xtask bench-cad [--rays N] [FILE.step ...]
                     exact faces beside triangles: lost hits of 10 million rays, rays a second; writes docs/reports/cad.md
cargo xtask bench-wavelet [--quick] [SCENE ...]
                     wavelet radiosity on exact faces and on triangles, with errors against the path tracer; writes
                     docs/reports/wavelet.md. Hours; --quick: noisier errors, half an hour
cargo xtask bench-scale [--scene FILE] [--preset NAME]
                     bakes a scene whose triangles are split into 1, 16 and 81: time and memory
cargo xtask bench-gloss [--quick] [--scenes DIR]
                     a metal trophy under two environments beside the path tracer, with glossy transfer of several kinds
                     and sizes, and shots of a folder of scenes; writes docs/reports/gloss.md, --quick only prints
cargo xtask fuzz [TARGET ...] [--runs N]
                     feeds damaged files to what reads them: file, section, scene, links, gltf, shot, checkpoint, simplify
cargo xtask fuzz-step [--files N] [--seed S] [--from DIR]
                     reads damaged STEP files, of the reader's tests and of DIR: each is read or refused within a second
                     and 256 MB; 1,000,000 when absent. Files at fault stay in target/fuzz-step
cargo xtask layers   which module uses which: fails where an arrow runs against the order, or in a circle
cargo xtask names    names that were replaced by the field's, and types that are defined twice: fails if any
cargo xtask docs     dead links and long lines of the documentation: fails if any
cargo xtask light-kinds
                     writes the kinds of light and their fields for the page: web/src/wire/light-kinds.ts
cargo xtask audit [--offline]
                     vulnerabilities, licences, doubled versions and sources of all dependencies
cargo xtask damage [--files N | --scenes N] [--seed S]
                     opens damaged files in headless Chromium: each is refused or gives a picture; 2,000 when absent.
                     --scenes: bakes N damaged copies of each scene with the native program and as WebAssembly: the same
cargo xtask soak [--minutes N]
                     moves lights and camera in headless Chromium and watches memory; an hour when absent
cargo xtask kill-bake [--times N] [--each] [--scene SCENE] [-- OPTIONS OF THE BAKE]
                     kills bakes at many times, lets them go on, compares the files; a hundred times when absent
cargo xtask plot-estimate [--record] [[--preset NAME] SCENE or LOG.jsonl ...]
                     bakes, and draws into docs/reports/estimate.svg how right the time left was; a log of
                     `rebounce bake --json-progress` is read instead. Ten bakes when nothing is named.
                     --record: writes the courses that the estimate's tests replay
cargo xtask plot-jacobian
                     draws the unit square on surfaces by natural parameters and by the virtual mesh:
                     docs/method/jacobian.svg
cargo xtask refine   compares both ways to refine the operator, at equal bytes and at equal seconds, and writes
                     docs/reports/refine.md; a quarter of an hour
cargo xtask install  installs what the others need, and says what";

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    match dispatch(&args) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn dispatch(args: &[String]) -> Result<()> {
    match args.first().map(String::as_str) {
        Some("demo") => demo::run(&args[1..]),
        Some("film") => film::run(&args[1..]),
        Some("test") => test::run(&args[1..]),
        Some("fidelity") => fidelity::run(&args[1..]),
        Some("bench-kernels") => bench_kernels::run(&args[1..]),
        Some("bench-cad") => bench_cad::run(&args[1..]),
        Some("bench-wavelet") => bench_wavelet::run(&args[1..]),
        Some("bench-antiradiance") => bench_antiradiance::run(&args[1..]),
        Some("bench-radiosity") => bench_radiosity::run(&args[1..]),
        Some("bench-scale") => bench_scale::run(&args[1..]),
        Some("bench-gloss") => gloss::run(&args[1..]),
        Some("bench-web") => bench_web::run(&args[1..]),
        Some("bench-bake") => bench_bake::run(&args[1..]),
        Some("audit") => audit::run(&args[1..]),
        Some("check") => gate::run(),
        Some("docs") => docs::run(),
        Some("layers") => layers::run(),
        Some("names") => names::run(),
        Some("light-kinds") => light_kinds::run(),
        Some("fuzz") => fuzz::run(&args[1..]),
        Some("fuzz-step") => fuzz_step::run(&args[1..]),
        Some("damage") => damage::run(&args[1..]),
        Some("soak") => soak::run(&args[1..]),
        Some("kill-bake") => kill_bake::run(&args[1..]),
        Some("plot-estimate") => plot_estimate::run(&args[1..]),
        Some("plot-jacobian") => plot_jacobian::run(),
        Some("refine") => refine::run(&args[1..]),
        Some("install") => install::all(),
        Some("web") => web::build(web::Purpose::of(&args[1..])?),
        Some("npm") => npm::build(web::Purpose::Publish),
        Some("package") => package::run(),
        Some("site") => site::run(&args[1..]),
        Some("help" | "--help" | "-h") => {
            println!("{USAGE}");
            Ok(())
        }
        Some(other) => bail!("there is no command {other}\n{USAGE}"),
        None => bail!("which command?\n{USAGE}"),
    }
}
