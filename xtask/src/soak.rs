//! `cargo xtask soak`: moves lights and camera for an hour in headless Chromium, and checks for constant memory
//! use.

use crate::{install, process, web};
use anyhow::{Context, Result, bail};

fn parse(args: &[String]) -> Result<u32> {
    match args {
        [] => Ok(60),
        [name, minutes] if name == "--minutes" => {
            let minutes = minutes.parse().context("--minutes needs a whole number")?;
            if minutes < 2 {
                bail!("--minutes must be 2 or more: the first one does not count")
            } else {
                Ok(minutes)
            }
        }
        _ => bail!("the only option is --minutes N"),
    }
}

/// Bakes a small scene, builds the viewer, and runs it.
///
/// # Errors
/// If memory grows after the first minute, or a step fails.
pub fn run(args: &[String]) -> Result<()> {
    let minutes = parse(args)?;
    install::ensure(&install::BROWSER)?;
    web::build(web::Purpose::Publish)?;
    let folder = process::target().join("soak");
    std::fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    let bake = ["run", "--package", "rebounce-cli", "--", "bake", "builtin:cornell-box", "--preset", "draft"];
    let few = ["--functions", "4000", "-o"];
    process::run(process::cargo().args(bake).args(few).arg(folder.join("scene.rbn")))?;
    process::run(web::node().arg("test/soak.mjs").arg(minutes.to_string()).arg(&folder).arg("scene.rbn"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options() {
        let words = |line: &str| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
        assert_eq!(parse(&[]).unwrap(), 60);
        assert_eq!(parse(&words("--minutes 5")).unwrap(), 5);
        for wrong in ["--minutes", "--minutes 1", "--minutes soon", "--hours 1"] {
            assert!(parse(&words(wrong)).is_err(), "{wrong}");
        }
    }
}
