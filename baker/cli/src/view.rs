//! `rebounce view`: serves the built viewer with one baked file on 127.0.0.1. For a scene, a `draft` is baked first.

use super::draft::{self, Draft};
use super::http::{self, Request, Response, ResponseBody};
use super::stop::end_at_once;
use anyhow::{Context, Result, bail};
use clap::Args;
use rebounce::scene::SceneError;
use rebounce_args::bake::PREVIEW;
use rebounce_shared::rbn::container::MAGIC;
use std::fs::File;
use std::io::Read;
use std::net::{Ipv4Addr, TcpListener};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::time::UNIX_EPOCH;

/// Arguments of `rebounce view`.
#[derive(Args, Debug)]
pub struct ViewArgs {
    /// What `rebounce bake` wrote; or a .gltf, .glb or .step file or builtin:NAME, of which a draft is baked first
    ///
    /// Of room.glb, room.rbn beside it is shown where that is not older. Elsewhere a draft goes into room.draft.rbn, which is
    /// made anew when the scene's file is newer. No other file is ever replaced.
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Port on 127.0.0.1; 7777, or any that is free, when absent
    #[arg(long)]
    port: Option<u16>,
    /// Shows the newest of FILE.rbn and FILE.preview.rbn (`rebounce bake --preview`), and newer ones as they come;
    /// neither need be there yet
    #[arg(long)]
    watch: bool,
    /// Only prints the address, opens no browser
    #[arg(long)]
    no_open: bool,
    /// Bakes a draft without asking
    #[arg(short, long)]
    yes: bool,
}

/// Viewer files by name; empty if the binary was built without the viewer.
static WEB: &[(&str, &[u8])] = include!(concat!(env!("OUT_DIR"), "/web_files.rs"));

const DEFAULT_PORT: u16 = 7777;

/// Headers of every response. The last two enable finer timers in the page.
const HEADERS: [(&str, &str); 7] = [
    (
        "Content-Security-Policy",
        "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; img-src 'self' data: blob:; \
         connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    ),
    ("X-Content-Type-Options", "nosniff"),
    ("Referrer-Policy", "no-referrer"),
    ("Cache-Control", "no-cache"),
    ("Cross-Origin-Resource-Policy", "same-origin"),
    ("Cross-Origin-Opener-Policy", "same-origin"),
    ("Cross-Origin-Embedder-Policy", "require-corp"),
];

/// Runs the command; ends only when interrupted.
pub fn run(args: &ViewArgs) -> Result<ExitCode> {
    if WEB.is_empty() {
        bail!(
            "this rebounce was built without the viewer; in its repository run `cargo xtask web`, then build rebounce again \
             (`cargo install --path baker/cli`)"
        );
    }
    let file = match draft::of(&args.file, args.watch, args.yes)? {
        Draft::Shown(file) => file,
        Draft::Not(code) => return Ok(code),
    };
    let site = Site { file: file.clone(), is_watching: args.watch, port: 0 };
    if let Some((file, _)) = site.newest().filter(|_| args.watch) {
        check(&file)?;
    } else if !args.watch {
        check(&file)?;
    }
    end_at_once().context("preparing for Ctrl-C")?;
    let listener = listen(args.port)?;
    let port = listener.local_addr()?.port();
    let address = format!("http://127.0.0.1:{port}/{}", if args.watch { "?watch" } else { "" });
    println!("{} at {address} (Ctrl-C ends)", file.display());
    if !args.no_open {
        open(&address);
    }
    let site = Site { port, ..site };
    http::serve(&listener, &HEADERS, move |request| site.answer(request)).context("serving the page")?;
    Ok(ExitCode::SUCCESS)
}

/// Whether the file can be read and begins like a .rbn file; the page checks the rest.
fn check(path: &Path) -> Result<()> {
    let mut start = [0; MAGIC.len()];
    let mut file = File::open(path).with_context(|| format!("cannot read {}", path.display()))?;
    if file.read_exact(&mut start).is_err() || start != MAGIC {
        let file = path.display().to_string();
        let Some(error) = SceneError::other_format(path) else {
            bail!("{file} is not a .rbn file; make one with `rebounce bake SCENE.glb -o FILE.rbn`");
        };
        return Err(error.into());
    }
    Ok(())
}

/// Binds `port`; without `port`, binds the default port, or else a free port.
fn listen(port: Option<u16>) -> Result<TcpListener> {
    let bind = |port| TcpListener::bind((Ipv4Addr::LOCALHOST, port));
    match port {
        Some(port) => {
            bind(port).with_context(|| format!("port {port} cannot be used; choose another with --port"))
        }
        None => bind(DEFAULT_PORT).or_else(|_| bind(0)).context("no port on 127.0.0.1 can be used"),
    }
}

/// Opens the system's browser; the address is printed in any case.
fn open(address: &str) {
    let program = match std::env::consts::OS {
        "macos" => "open",
        "windows" => "explorer",
        _ => "xdg-open",
    };
    // Without a browser, the printed address suffices.
    let _ = Command::new(program)
        .arg(address)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn();
}

struct Site {
    file: PathBuf,
    /// Serves the newer of the file and the preview.
    is_watching: bool,
    port: u16,
}

impl Site {
    /// Whether the host of a request names this server. A further accepted name would let a foreign page read the file
    /// (DNS rebinding).
    fn is_own(&self, host: Option<&str>) -> bool {
        host.is_some_and(|host| {
            host == format!("127.0.0.1:{}", self.port) || host == format!("localhost:{}", self.port)
        })
    }

    /// Returns the newer of the file and the preview, and a version of the contents; `None` while both are absent.
    fn newest(&self) -> Option<(PathBuf, String)> {
        let preview = self.is_watching.then(|| self.file.with_extension(PREVIEW));
        let there = [Some(self.file.clone()), preview].into_iter().flatten().filter_map(|path| {
            let metadata = path.metadata().ok()?;
            let since = metadata.modified().ok()?.duration_since(UNIX_EPOCH).ok()?;
            Some((since, metadata.len(), path))
        });
        // The file wins a tie.
        let (since, length, path) = there.rev().max_by_key(|(since, ..)| *since)?;
        Some((path, format!("{}-{length}", since.as_nanos())))
    }

    /// Serves exactly the embedded files and the scene; no part of the request becomes a path.
    fn answer(&self, request: &Request) -> Response {
        if !self.is_own(request.host.as_deref()) {
            return text(403, "this server answers only to 127.0.0.1");
        }
        if !matches!(request.method.as_str(), "GET" | "HEAD") {
            return text(405, "only GET and HEAD");
        }
        let path = request.target.split(['?', '#']).next().unwrap_or_default();
        let name = match path.strip_prefix('/') {
            Some("") => "index.html",
            Some(name) => name,
            None => return text(400, "not a path"),
        };
        if name == "scene.version" && self.is_watching {
            return text(200, &self.newest().map(|(_, version)| version).unwrap_or_default());
        }
        if name == "scene.rbn" {
            let path = self.newest().map_or(self.file.clone(), |(path, _)| path);
            let file = File::open(path).and_then(|file| match file.metadata()?.is_file() {
                true => Ok(file),
                false => Err(std::io::Error::other("it is no file")),
            });
            return match file {
                Ok(file) => {
                    Response { status: 200, mime: "application/octet-stream", body: ResponseBody::File(file) }
                }
                Err(error) => text(404, &format!("the scene can no longer be read: {error}")),
            };
        }
        match WEB.iter().find(|(known, _)| *known == name) {
            Some((_, bytes)) => Response { status: 200, mime: mime(name), body: ResponseBody::Bytes(bytes) },
            None => text(404, "there is no such file"),
        }
    }
}

fn mime(name: &str) -> &'static str {
    match name.rsplit('.').next() {
        Some("html") => "text/html; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("wasm") => "application/wasm",
        _ => "application/octet-stream",
    }
}

fn text(status: u16, message: &str) -> Response {
    Response { status, mime: "text/plain; charset=utf-8", body: ResponseBody::Text(message.into()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn site() -> (Site, tempfile::NamedTempFile) {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), MAGIC).unwrap();
        (Site { file: file.path().to_owned(), is_watching: false, port: 80 }, file)
    }

    fn ask(site: &Site, method: &str, host: Option<&str>, target: &str) -> u16 {
        site.answer(&Request { method: method.into(), target: target.into(), host: host.map(Into::into) })
            .status
    }

    fn get(site: &Site, host: &str, url: &str) -> u16 {
        ask(site, "GET", Some(host), url)
    }

    #[test]
    fn only_its_own_names_are_answered() {
        let (site, _file) = site();
        assert_eq!(get(&site, "127.0.0.1:80", "/scene.rbn"), 200);
        assert_eq!(get(&site, "localhost:80", "/scene.rbn?x=1"), 200);
        for host in [
            "evil.example:80",
            "127.0.0.1:81",
            "127.0.0.1",
            "127.0.0.1:80.evil.example",
            "evil.example@127.0.0.1:80",
            "127.0.0.1:80, evil.example",
            "127.1:80",
            "[::1]:80",
            "",
        ] {
            assert_eq!(get(&site, host, "/scene.rbn"), 403, "{host}");
        }
        assert_eq!(ask(&site, "GET", None, "/scene.rbn"), 403);
    }

    #[test]
    fn nothing_but_its_files_is_served() {
        let (site, file) = site();
        let absolute = file.path().to_string_lossy().into_owned();
        for url in [
            "/../Cargo.toml",
            "/%2e%2e/Cargo.toml",
            "/..%2fCargo.toml",
            "//etc/passwd",
            "/etc/passwd",
            "/src/main.rs",
            "/./scene.rbn",
            "http://127.0.0.1/scene.rbn",
            "*",
            "/%2e%2e%2fCargo.toml",
            "/..%5c..%5cCargo.toml",
            "/..\\..\\Cargo.toml",
            "/%252e%252e/Cargo.toml",
            "/%c0%ae%c0%ae/Cargo.toml",
            "/..%00/scene.rbn",
            "/scene.rbn%00",
            "/scene.rbn/",
            "/scene.rbn/../Cargo.toml",
            "/scene.partial",
            "/....//Cargo.toml",
            "/SCENE.RBN",
            "/index.html/",
            "scene.rbn",
            "",
            &absolute,
        ] {
            let status = get(&site, "127.0.0.1:80", url);
            assert!(status == 404 || status == 400, "{url}: {status}");
        }
        for method in ["POST", "PUT", "DELETE", "OPTIONS", "TRACE", "CONNECT", "get", "", "PROPFIND"] {
            assert_eq!(ask(&site, method, Some("127.0.0.1:80"), "/scene.rbn"), 405, "{method}");
        }
        // The file is gone, then is a directory.
        file.close().unwrap();
        assert_eq!(get(&site, "127.0.0.1:80", "/scene.rbn"), 404);
        std::fs::create_dir(&site.file).unwrap();
        assert_eq!(get(&site, "127.0.0.1:80", "/scene.rbn"), 404);
        std::fs::remove_dir(&site.file).unwrap();
    }

    #[test]
    fn the_newest_of_file_and_preview_is_shown() {
        let folder = tempfile::tempdir().unwrap();
        let (file, preview) = (folder.path().join("a.rbn"), folder.path().join("a.preview.rbn"));
        let site = Site { file: file.clone(), is_watching: true, port: 80 };
        let at = |path: &Path, contents: &[u8], second: u64| {
            std::fs::write(path, contents).unwrap();
            let when = UNIX_EPOCH + std::time::Duration::from_secs(second);
            File::options().write(true).open(path).unwrap().set_modified(when).unwrap();
        };
        assert_eq!(site.newest(), None);
        assert_eq!(get(&site, "127.0.0.1:80", "/scene.version"), 200);
        at(&file, b"old", 100);
        let (path, old) = site.newest().unwrap();
        assert_eq!(path, file);
        at(&preview, b"coarse", 200);
        let (path, coarse) = site.newest().unwrap();
        assert_eq!(path, preview);
        at(&preview, b"finer", 201);
        let finer = site.newest().unwrap().1;
        at(&file, b"done", 201);
        let (path, done) = site.newest().unwrap();
        assert_eq!(path, file, "of two as new as each other the file itself");
        let mut versions = vec![old, coarse, finer, done];
        versions.dedup();
        assert_eq!(versions.len(), 4);
        // Without --watch, only the file is served, and no version.
        let plain = Site { is_watching: false, ..site };
        at(&preview, b"newer", 300);
        assert_eq!(plain.newest().unwrap().0, file);
        assert_eq!(get(&plain, "127.0.0.1:80", "/scene.version"), 404);
    }

    #[test]
    fn nobody_but_this_machine_is_listened_to() {
        let listener = listen(Some(0)).unwrap();
        assert_eq!(listener.local_addr().unwrap().ip(), Ipv4Addr::LOCALHOST);
        let port = listener.local_addr().unwrap().port();
        let refused = format!("{:#}", listen(Some(port)).unwrap_err());
        assert!(refused.contains(&port.to_string()) && refused.contains("--port"), "{refused}");
    }

    #[test]
    fn wasm_has_its_own_type() {
        assert_eq!(mime("rebounce_viewer_bg.wasm"), "application/wasm");
        assert_eq!(mime("rebounce-viewer.js"), "text/javascript; charset=utf-8");
    }
}
