//! `cargo xtask test`: runs the tests, without duplicate compilation.

use crate::package::{self, Tarballs};
use crate::toolchain::{self, Toolchain};
use crate::{bindgen, gate, install, installed, npm, process, site, sources, web};
use anyhow::{Context, Result, bail};
use std::panic::resume_unwind;
use std::path::PathBuf;
use std::process::Stdio;

/// Parts: checks of the sources, tests of the crates, of the viewer as wasm, of the page of `rebounce view`, of the npm package, of the
/// site, of the installed command (`cargo install`), and of bakes under mpirun.
const PARTS: [&str; 8] = ["check", "native", "wasm", "page", "package", "site", "install", "mpi"];

/// Feature of the command with MPI.
const MPI: &str = "rebounce-cli/mpi";

/// Runs every test, or one part, or the tests of one name in the parts `native` and `page`; with `--long` those, too, that take
/// minutes of processor time, as those of a name do, and the checks that compile the sources. A failed part does not stop later parts; the test of the installed command
/// recompiles everything and runs only by name.
///
/// # Errors
/// If a dependency is missing, code does not compile, or a test fails.
pub fn run(args: &[String]) -> Result<()> {
    let (long, args): (Vec<&String>, Vec<&String>) = args.iter().partition(|arg| *arg == "--long");
    let part = args.first().map(|part| part.as_str());
    if part.is_some_and(|part| !PARTS.contains(&part)) || args.len() > 2 {
        bail!("there are these parts: {}; without a name all of them are run", PARTS.join(", "));
    }
    let name = args.get(1).map(|name| name.as_str());
    let long = !long.is_empty() || name.is_some();
    if name.is_some() && !matches!(part, Some("native" | "page")) {
        bail!("the tests of one name can be run of the parts native and page alone");
    }
    if part == Some("check") {
        return gate::run();
    }
    if part == Some("mpi") {
        return over_mpi();
    }
    let purpose = if part.is_none() && !long { web::Purpose::Test } else { web::Purpose::Publish };
    let wanted = |name| part.is_none() || part == Some(name);
    let in_page = ["page", "package", "site", "install"].map(wanted).contains(&true);
    install::ensure(&install::BROWSER)?;
    install::ensure(&install::NODE)?;
    web::npm()?;
    if in_page || wanted("wasm") {
        // Before the threads: only one may install it.
        toolchain::find()?;
    }
    let checked = std::thread::scope(|scope| {
        // Beside the page, which links with one core for minutes.
        let checks = if long { gate::run } else { gate::text };
        let checked = part.is_none().then(|| scope.spawn(checks));
        // The page comes first: the tests build the binary with the embedded page.
        let built = if in_page { web::build(purpose) } else { Ok(()) };
        let checked = checked.map(|checked| checked.join().unwrap_or_else(|panic| resume_unwind(panic)));
        built.map(|()| checked.unwrap_or(Ok(())))
    })?;
    if part == Some("install") {
        return installed::test();
    }
    if let Err(error) = &checked {
        println!("{error:#}");
    }
    let native = match part {
        None => install::ensure(&install::MPI).and_then(|()| native(&["--features", MPI], long)),
        Some("native") => native(name.as_slice(), long),
        Some("wasm") => Ok(()),
        Some(_) => native(&["--no-run"], false),
    };
    if let Err(error) = &native {
        println!("{error:#}");
    }
    if part == Some("native") {
        return native;
    }
    let wasm = if wanted("wasm") {
        toolchain::find().and_then(|toolchain| wasm_tests(toolchain, purpose))
    } else {
        Ok(Vec::new())
    };
    if let Err(error) = &wasm {
        println!("{error:#}");
    }
    let browser = browser(wasm.as_deref().unwrap_or_default(), wanted, purpose, (name, long));
    if let Err(error) = &browser {
        println!("{error:#}");
    }
    checked.and(native).and(wasm.map(drop)).and(browser)
}

/// `cargo test` of the workspace, in the development profile (optimised): the tests, then those in documentation. The build
/// includes the programs for the browser tests, and leaves out examples, which `cargo xtask check` looks at.
fn native(options: &[&str], long: bool) -> Result<()> {
    let run = |targets: &[&str]| {
        let mut command = process::cargo();
        command.args(["test", "--locked", "--workspace", "--features", sources::STEP, "--no-fail-fast"]);
        command.args(targets).args(options);
        if long && targets == ["--tests"] {
            command.args(["--", "--include-ignored"]);
        }
        if let Some(description) = install::lavapipe() {
            command.env("VK_DRIVER_FILES", description);
        }
        process::run(&mut command)
    };
    let tests = run(&["--tests"]);
    if options.contains(&"--no-run") { tests } else { tests.and(run(&["--doc"])) }
}

/// Tests bakes over several processes against bakes in a single process. Part of the native tests when all are run: another
/// set of features would compile the baker a second time.
fn over_mpi() -> Result<()> {
    install::ensure(&install::MPI)?;
    let mut command = process::cargo();
    process::run(command.args(["test", "--locked", "--workspace", "--features", MPI, "--test", "mpi"]))
}

/// Runs wasm tests, and the browser tests of the wanted parts, in headless Chromium.
fn browser(
    wasm: &[PathBuf],
    wanted: impl Fn(&'static str) -> bool,
    purpose: web::Purpose,
    (name, long): (Option<&str>, bool),
) -> Result<()> {
    let work = process::target().join("browser-tests");
    std::fs::create_dir_all(&work).with_context(|| work.display().to_string())?;
    let bin = |name: &str| process::target().join("debug").join(name);
    let mut node = web::node();
    node.arg("test/run.mjs");
    if long {
        node.arg("--long");
    }
    for file in wasm {
        let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let dir = work.join("wasm");
        bindgen::tests(file, &name, &dir)?;
        node.arg("--wasm").arg(dir.join(name));
    }
    if let Some(name) = name {
        node.args(["--only", name]);
    }
    if wanted("page") {
        web::packages("web/bench", "three.js")?;
        node.arg("--page").arg(&work).args(["rebounce", "compare", "damage"].map(bin));
    }
    if wanted("package") {
        npm::build(purpose)?;
        let Tarballs { viewer, command, native } = package::pack(&bin("rebounce"))?;
        node.arg("--package").arg(&work).arg(bin("rebounce")).args([viewer, command]);
        node.arg(native.unwrap_or_else(|| "none".into()));
    }
    if wanted("site") {
        let folder = work.join("site");
        site::build(&bin("rebounce"), &site::Quality::quick(), &folder)?;
        node.arg("--site").arg(folder);
    }
    process::run(&mut node)
}

/// Compiles the viewer's wasm tests with the profile and the flags of the bundle, to reuse its dependencies; returns the
/// paths of the programs.
fn wasm_tests(toolchain: Toolchain, purpose: web::Purpose) -> Result<Vec<PathBuf>> {
    let mut command = toolchain.cargo("test");
    let profile = purpose.profile(web::RENDERER_PROFILE);
    command.args(["--package", "rebounce-viewer", "--test", "web", "--profile", profile, "--no-run"]);
    command.arg("--message-format=json-render-diagnostics");
    web::renderer_flags(&mut command, purpose);
    println!("> {}", process::line(&command));
    let output = command.stdin(Stdio::null()).stderr(Stdio::inherit()).output().context("cargo")?;
    if !output.status.success() {
        bail!("the wasm tests do not compile");
    }
    let programs = executables(&String::from_utf8_lossy(&output.stdout));
    if programs.is_empty() {
        bail!("cargo named no wasm test");
    }
    Ok(programs)
}

/// Extracts the paths of wasm programs from Cargo's messages.
fn executables(messages: &str) -> Vec<PathBuf> {
    let key = "\"executable\":\"";
    messages
        .lines()
        .filter_map(|line| line.split_once(key))
        .filter_map(|(_, rest)| rest.split_once('"'))
        .map(|(path, _)| PathBuf::from(path))
        .filter(|path| path.extension().is_some_and(|e| e == "wasm"))
        .collect()
}
