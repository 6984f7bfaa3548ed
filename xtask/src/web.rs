//! `cargo xtask web`: the viewer as wasm, its page and its npm package, in web/dist.

use crate::bindgen;
use crate::bundle_size;
use crate::function_order;
use crate::install;
use crate::integrity;
use crate::process;
use crate::toolchain::{self, Toolchain};
use anyhow::{Context, Result};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The names of the generated JavaScript and wasm files.
const NAME: &str = "rebounce_viewer";
/// As [`NAME`], of the renderer of all files.
const RADIOSITY: &str = "rebounce_radiosity";
/// As [`NAME`], of the baker.
pub const BAKER: &str = "rebounce_baker";
/// As [`NAME`], of the baker that reads STEP files, too.
pub const BAKER_STEP: &str = "rebounce_baker_step";
/// Features of the baker of the npm package.
pub const COMMAND_STEP: &str = "command,step";
/// As [`NAME`], of bounced light for three.js.
const THREE: &str = "rebounce_three";
/// Cargo's profile of the renderer as it is published.
pub const RENDERER_PROFILE: &str = "web";
/// Panic locations and `{:?}` output are left out of the renderer: a tenth of a bundle, never visible on a page.
const RENDERER_FLAGS: &str = "-Zlocation-detail=none -Zfmt-debug=none";
/// Every browser with WebGPU has the instructions for four lanes, and so has Node.js.
const BAKER_FLAGS: &str = "-Ctarget-feature=+simd128 -Zlocation-detail=none";
/// The modules with the fetch of the wasm files, before the modules are bundled.
const FETCHES: [(&str, &str); 5] = [
    ("engine/module.js", NAME),
    ("radiosity.js", RADIOSITY),
    ("bake/module.js", BAKER),
    ("bake/step-module.js", BAKER_STEP),
    ("three/module.js", THREE),
];
/// Files of web/ copied unchanged into the site.
const STATIC: [&str; 2] = ["index.html", "page.css"];

/// What the modules of WebAssembly are compiled for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// To be published: link-time optimisation takes minutes for each of them.
    Publish,
    /// For a run of all tests: they share compiled crates, and are too large to be published.
    Test,
}

impl Purpose {
    /// That of a command with these arguments: with `--quick`, tests.
    ///
    /// # Errors
    /// For other arguments.
    pub fn of(args: &[String]) -> Result<Self> {
        match args {
            [] => Ok(Self::Publish),
            [quick] if quick == "--quick" => Ok(Self::Test),
            _ => anyhow::bail!("there is --quick, and nothing else"),
        }
    }

    /// The profile, where `published` is that of what is published.
    pub fn profile(self, published: &'static str) -> &'static str {
        match self {
            Self::Publish => published,
            Self::Test => "wasm-test",
        }
    }

    /// The compiler's flags, where `published` are those of what is published.
    fn flags(self, published: &'static str) -> &'static str {
        match self {
            Self::Publish => published,
            Self::Test => BAKER_FLAGS,
        }
    }
}

/// Builds web/dist: the site, and the contents of the npm package. The command serves a copy of what browsers ask for,
/// baker/cli/viewer. The limits on sizes hold for what is published.
///
/// # Errors
/// If a tool is missing or fails, or the bundle is over its limit.
pub fn build(purpose: Purpose) -> Result<()> {
    install::ensure(&install::NODE)?;
    let toolchain = toolchain::find()?;
    npm()?;
    let pkg = process::root().join("web/pkg");
    // As they are published, each has a profile of its own, and links with one core.
    std::thread::scope(|scope| {
        let bakers = scope.spawn(|| bakers(toolchain, purpose, &pkg));
        let renderers = renderers(toolchain, purpose, &pkg);
        renderers.and(bakers.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
    })?;
    let files = assemble(&pkg)?;
    let dist = process::root().join("web/dist");
    mirror(&files, &dist)?;
    let is_served = |name: &str| !name.ends_with(".d.ts") && !is_of_baker(name) && !is_of_three(name);
    let served = files.iter().filter(|(name, _)| is_served(name));
    let served: BTreeMap<_, _> = served.map(|(name, bytes)| (name.clone(), bytes.clone())).collect();
    mirror(&served, &process::root().join("baker/cli/viewer"))?;
    bundle_size::check(&files, purpose)?;
    println!("built {}", dist.display());
    Ok(())
}

/// Builds the modules of the renderer.
fn renderers(toolchain: Toolchain, purpose: Purpose, pkg: &Path) -> Result<()> {
    let element = |features| ["--no-default-features", "--features", features];
    for (package, library, name, options) in [
        ("rebounce-viewer", NAME, NAME, &element("element")[..]),
        ("rebounce-viewer", NAME, RADIOSITY, &element("element,radiosity,antiradiance")),
        ("rebounce-three", THREE, THREE, &[]),
    ] {
        let wasm = renderer_wasm(toolchain, purpose, (package, library), options)?;
        bindgen::module(&wasm, name, bindgen::FROM_RESPONSE, pkg)?;
        if purpose == Purpose::Publish {
            shrink(&pkg.join(format!("{name}_bg.wasm")))?;
        }
    }
    Ok(())
}

/// Builds the modules of the baker. For tests they are one program under two names, that of npm: other features would compile the
/// baker again.
fn bakers(toolchain: Toolchain, purpose: Purpose, pkg: &Path) -> Result<()> {
    for (name, options) in [(BAKER, &[][..]), (BAKER_STEP, &["--features", "step"])] {
        let options = if purpose == Purpose::Test { &["--features", COMMAND_STEP] } else { options };
        let wasm = baker_wasm(toolchain, purpose.profile("web-baker"), options)?;
        bindgen::module(&wasm, name, bindgen::FROM_MODULE, pkg)?;
        if purpose == Purpose::Publish {
            optimise(&pkg.join(format!("{name}_bg.wasm")), &BAKER_PASSES)?;
        }
    }
    Ok(())
}

/// Compiles a package of the renderer, with the name of its library; returns the path of the wasm file.
fn renderer_wasm(
    toolchain: Toolchain,
    purpose: Purpose,
    (package, library): (&str, &str),
    options: &[&str],
) -> Result<PathBuf> {
    let profile = purpose.profile(RENDERER_PROFILE);
    let mut cargo = toolchain.cargo("build");
    cargo.args(["--package", package, "--lib", "--profile", profile]).args(options);
    process::run(renderer_flags(&mut cargo, purpose))?;
    Ok(toolchain.target().join(toolchain::TARGET).join(profile).join(library).with_extension("wasm"))
}

/// Compiles the baker with a profile and options; returns the path of the wasm file.
///
/// # Errors
/// If the code does not compile.
pub fn baker_wasm(toolchain: Toolchain, profile: &str, options: &[&str]) -> Result<PathBuf> {
    let mut cargo = toolchain.cargo("build");
    cargo.args(["--package", "rebounce-bake-wasm", "--lib", "--profile", profile]).args(options);
    process::run(with_flags(&mut cargo, BAKER_FLAGS))?;
    Ok(toolchain.target().join(toolchain::TARGET).join(profile).join("rebounce_bake_wasm.wasm"))
}

/// Whether a file of web/dist is of the baker alone.
pub fn is_of_baker(name: &str) -> bool {
    name.starts_with(BAKER) || name.starts_with("bake")
}

/// Whether a file of web/dist is of the renderer of all files.
pub fn is_of_radiosity(name: &str) -> bool {
    name.starts_with(RADIOSITY) || name.starts_with("radiosity")
}

/// Whether a file of web/dist is for three.js alone.
pub fn is_of_three(name: &str) -> bool {
    name.starts_with(THREE) || name.starts_with("three")
}

/// Passes of Binaryen's wasm-opt for minimum size after gzip; `-Oz` gives a larger gzip size.
const PASSES: [&str; 14] = [
    "--remove-unused-module-elements",
    "--dealign",
    "--duplicate-function-elimination",
    "--remove-unused-brs",
    "--optimize-instructions",
    "--strip-target-features",
    "--dae-optimizing",
    "--simplify-locals-notee-nostructure",
    "--precompute",
    "--remove-unused-names",
    "--vacuum",
    "--merge-blocks",
    "--rse",
    "--vacuum",
];
/// Final passes, run once.
const LAST: [&str; 4] =
    ["--generate-global-effects", "--simplify-locals-notee-nostructure", "--vacuum", "--rse"];
/// Passes for the baker, which LLVM compiles for speed: no more than duplicates and what is never reached.
const BAKER_PASSES: [&str; 7] = [
    "--enable-simd",
    "--duplicate-function-elimination",
    "--remove-unused-module-elements",
    "--remove-unused-brs",
    "--merge-blocks",
    "--rse",
    "--vacuum",
];
/// Wasm features used by LLVM's output, passed to Binaryen explicitly instead of detected from the file.
const FEATURES: [&str; 6] = [
    "--enable-bulk-memory",
    "--enable-multivalue",
    "--enable-mutable-globals",
    "--enable-nontrapping-float-to-int",
    "--enable-reference-types",
    "--enable-sign-ext",
];

/// Replaces a wasm file by a smaller equivalent file.
fn shrink(wasm: &Path) -> Result<()> {
    // Two rounds: the second round removes duplicates produced by the first.
    optimise(wasm, &[&PASSES[..], &PASSES[..], &LAST[..]].concat())?;
    let module = fs::read(wasm).with_context(|| wasm.display().to_string())?;
    fs::write(wasm, function_order::name(&module)?).with_context(|| wasm.display().to_string())?;
    optimise(wasm, &["--reorder-functions-by-name"])
}

/// Runs passes of Binaryen's wasm-opt on a file.
fn optimise(wasm: &Path, passes: &[&str]) -> Result<()> {
    let mut command = Command::new("node");
    command.arg("node_modules/binaryen/bin/wasm-opt").args(FEATURES).args(passes);
    process::run(command.arg(wasm).arg("-o").arg(wasm).current_dir(process::root().join("web")))
}

/// Gives Cargo the flags of the renderer: other flags compile its dependencies again.
pub fn renderer_flags(cargo: &mut Command, purpose: Purpose) -> &mut Command {
    with_flags(cargo, purpose.flags(RENDERER_FLAGS))
}

fn with_flags<'a>(cargo: &'a mut Command, flags: &str) -> &'a mut Command {
    cargo.env("RUSTC_BOOTSTRAP", "1").env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS", flags)
}

/// Installs the packages of web/package-lock.json unless up to date.
///
/// # Errors
/// If npm fails.
pub fn npm() -> Result<()> {
    packages(
        "web",
        "the TypeScript compiler, the bundler, the minifiers, the manifest's analyzer, a glTF writer, Playwright's driver, axe",
    )
}

/// Installs the packages of a repository folder's package-lock.json unless up to date.
///
/// # Errors
/// If npm fails.
pub fn packages(folder: &str, what: &str) -> Result<()> {
    let dir = process::root().join(folder);
    let lock =
        fs::read(dir.join("package-lock.json")).with_context(|| format!("{folder}/package-lock.json"))?;
    let stamp = dir.join("node_modules/.rebounce-lock");
    if fs::read(&stamp).is_ok_and(|installed| installed == lock) {
        return Ok(());
    }
    println!("installing into {folder}/node_modules, through npm: {what}");
    process::run(
        Command::new("npm").args(["ci", "--no-audit", "--no-fund", "--loglevel=error"]).current_dir(&dir),
    )?;
    fs::write(&stamp, lock).with_context(|| stamp.display().to_string())
}

/// Node.js command in web/, with the browser's path in the environment.
pub fn node() -> Command {
    let mut command = Command::new(process::find(&["node", "nodejs"]).unwrap_or_else(|| "node".into()));
    command.current_dir(process::root().join("web"));
    if let Some(browser) = install::chromium() {
        command.env("CHROMIUM", browser);
    }
    command
}

/// Compiles the TypeScript, bundles the modules and gathers the files of the site.
fn assemble(pkg: &Path) -> Result<BTreeMap<String, Vec<u8>>> {
    let web = process::root().join("web");
    let modules = compile(pkg)?;
    let mut files = BTreeMap::new();
    let read = |path: PathBuf| fs::read(&path).with_context(|| path.display().to_string());
    for (fetches, wasm) in FETCHES {
        for name in [format!("{wasm}.js"), format!("{wasm}.d.ts"), format!("{wasm}_bg.wasm")] {
            files.insert(name.clone(), read(pkg.join(name))?);
        }
        let module = modules.join(fetches);
        files.insert(fetches.to_owned(), read(module.clone())?);
        integrity::seal(&mut files, fetches, &format!("{wasm}_bg.wasm"))?;
        fs::write(module, files.remove(fetches).unwrap_or_default()).context(fetches)?;
    }
    let bundle = bundle(&modules)?;
    for (folder, ending) in [(&modules, ".d.ts"), (&bundle, ".js")] {
        for name in names(folder)?.into_iter().filter(|name| name.ends_with(ending)) {
            let content = read(folder.join(&name))?;
            files.insert(name, content);
        }
    }
    for (name, bytes) in files.iter_mut().filter(|(name, _)| name.ends_with(".js")) {
        *bytes = minified(&bundle.join(name), bytes)?;
    }
    files.insert(integrity::LIST.to_owned(), integrity::list(&files)?);
    for name in STATIC {
        files.insert(name.to_owned(), read(web.join(name))?);
    }
    Ok(files)
}

/// Compiles every TypeScript module to JavaScript and declarations; returns the output folder, used by test
/// imports.
fn compile(pkg: &Path) -> Result<PathBuf> {
    let modules = pkg.join("modules");
    if modules.exists() {
        fs::remove_dir_all(&modules).with_context(|| modules.display().to_string())?;
    }
    process::run(
        Command::new("node")
            .arg("node_modules/typescript/bin/tsc")
            .arg("--outDir")
            .arg(&modules)
            .current_dir(process::root().join("web")),
    )?;
    Ok(modules)
}

/// Bundles the modules; returns the folder of the bundles.
fn bundle(modules: &Path) -> Result<PathBuf> {
    let out = modules.join("bundle");
    let web = process::root().join("web");
    process::run(Command::new("node").arg("bundle.mjs").args([modules, &out]).current_dir(web))?;
    Ok(out)
}

/// Minifies a JavaScript module: short names, no comments; export names are kept.
///
/// # Errors
/// If the minifier fails.
pub fn minified(file: &Path, source: &[u8]) -> Result<Vec<u8>> {
    fs::write(file, source).with_context(|| file.display().to_string())?;
    let out = file.with_extension("min");
    process::run(
        Command::new("node")
            .args([
                "node_modules/terser/bin/terser",
                "--module",
                "--compress",
                "passes=2,ecma=2020,inline=1,keep_fargs=false,sequences=false,unsafe_arrows,unsafe_methods",
                "--ecma",
                "2020",
                "--mangle",
                "--output",
            ])
            .args([&out, file])
            .current_dir(process::root().join("web")),
    )?;
    fs::read(&out).with_context(|| out.display().to_string())
}

/// Whether a file of web/dist is code of the package; the page of `rebounce view` is not package code.
pub fn is_code(name: &str) -> bool {
    (name.ends_with(".js") || name.ends_with(".wasm")) && name != "page.js"
}

/// Makes the contents of a directory equal to `files`; equal files stay untouched, so that dependent builds are not
/// repeated.
fn mirror(files: &BTreeMap<String, Vec<u8>>, dir: &Path) -> Result<()> {
    fs::create_dir_all(dir).with_context(|| dir.display().to_string())?;
    for name in names(dir)?.iter().filter(|name| !files.contains_key(*name)) {
        fs::remove_file(dir.join(name))?;
    }
    for (name, bytes) in files {
        let path = dir.join(name);
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
        }
        if fs::read(&path).ok().as_ref() != Some(bytes) {
            fs::write(&path, bytes).with_context(|| path.display().to_string())?;
        }
    }
    Ok(())
}

/// The files in a folder and in folders in it, as paths from there: `wire/shot.d.ts`.
///
/// # Errors
/// If a folder cannot be read.
pub fn names(folder: &Path) -> Result<Vec<String>> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).with_context(|| folder.display().to_string())? {
        let entry = entry?;
        let name = entry.file_name().to_string_lossy().into_owned();
        match entry.file_type()?.is_dir() {
            true => found.extend(names(&entry.path())?.iter().map(|inner| format!("{name}/{inner}"))),
            false => found.push(name),
        }
    }
    Ok(found)
}
