//! Test of a new user's installation: the command, built from the packages that would be published, shows a scene in its
//! page.

use crate::process;
use anyhow::{Context, Result, bail, ensure};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Packages of the command, dependencies first.
const PACKAGES: [&str; 5] = ["rebounce-shared", "rebounce-cad", "rebounce", "rebounce-args", "rebounce-cli"];

/// Unpacks the packages of the command; returns the folder of each.
fn unpacked() -> Result<Vec<PathBuf>> {
    let mut package = process::cargo();
    package.args(["package", "--locked", "--no-verify", "--allow-dirty"]);
    process::run(package.args(PACKAGES.iter().flat_map(|name| ["--package", name])))?;
    let folder = process::target().join("package");
    let unpack = |name: &&str| {
        let name = format!("{name}-{}", env!("CARGO_PKG_VERSION"));
        let archive = folder.join(format!("{name}.crate"));
        process::run(Command::new("tar").arg("-xzf").arg(&archive).arg("-C").arg(&folder))?;
        Ok(folder.join(name))
    };
    PACKAGES.iter().map(unpack).collect()
}

/// Installs the command from its packages, bakes a scene with the command, and requests the page from the command's
/// server.
///
/// # Errors
/// If a step fails, or the page is not served.
pub fn test() -> Result<()> {
    let root = process::target().join("installed");
    let mut install = process::cargo();
    let folders = unpacked()?;
    let [.., command] = &folders[..] else { bail!("no package was made") };
    install.args(["install", "--debug", "--force", "--path"]).arg(command).arg("--root").arg(&root);
    // The packages depend on each other by version.
    for (name, folder) in PACKAGES.iter().zip(&folders) {
        install
            .arg("--config")
            .arg(format!("patch.crates-io.{name}.path={:?}", folder.display().to_string()));
    }
    process::run(install.arg("--target-dir").arg(process::target()))?;
    let rebounce = root.join("bin/rebounce");
    process::run(Command::new(&rebounce).arg("--version"))?;
    let baked = root.join("room.rbn");
    let few = ["--preset", "draft", "--functions", "200", "--levels", "3", "-o"];
    process::run(Command::new(&rebounce).args(["bake", "builtin:two-rooms"]).args(few).arg(&baked))?;
    let mut view = Command::new(&rebounce);
    view.arg("view").arg(&baked).args(["--no-open", "--port", "0"]).stdout(Stdio::piped());
    let mut server = process::Running(view.spawn().context("the installed rebounce")?);
    let mut line = String::new();
    BufReader::new(server.0.stdout.take().context("rebounce view has no output")?).read_line(&mut line)?;
    let host = line.split_once("http://").and_then(|(_, rest)| rest.split_once('/'));
    let (host, _) = host.with_context(|| format!("rebounce view gave no address: {line}"))?;
    for (target, words) in [("/", "<rebounce-viewer"), ("/rebounce-viewer.js", "customElements")] {
        let answer = get(host, target)?;
        ensure!(
            answer.starts_with("HTTP/1.1 200") && answer.contains(words),
            "{target} is not served: {answer}"
        );
    }
    ensure!(get(host, "/scene.rbn")?.contains("REBOUNCE"), "the scene is not served");
    println!("test {} shows a scene ... ok", name(&rebounce));
    Ok(())
}

/// Complete response to a request, as text.
fn get(host: &str, target: &str) -> Result<String> {
    let mut stream = TcpStream::connect(host).with_context(|| host.to_owned())?;
    write!(stream, "GET {target} HTTP/1.1\r\nHost: {host}\r\n\r\n")?;
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer)?;
    Ok(String::from_utf8_lossy(&answer).into_owned())
}

fn name(path: &Path) -> String {
    path.strip_prefix(process::target()).unwrap_or(path).display().to_string()
}
