//! Common parts of `render` and `reference`: shot, size, samples, output file.

use anyhow::{Context, Result};
use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};
use rebounce::geometry::Surfaces;
use rebounce::io::environment;
use rebounce::io::picture::{Only, Picture, check_name, png};
use rebounce::io::shot;
use rebounce::io::write::{check_place, write_whole};
use rebounce::verify::expose::Exposure;
use rebounce::verify::render::shown::Shown;
use rebounce_shared::camera::{Camera, CameraFrame};
use rebounce_shared::environment::Environment;
use rebounce_shared::light::{Light, LightSource};
use rebounce_shared::lighting::with_emission;
use rebounce_shared::mix::mixed;
use rebounce_shared::rbn::shown::Ground;
use rebounce_shared::shot::Shot;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Arguments of every command that takes a picture.
#[derive(Args, Debug)]
pub struct PictureArgs {
    /// Camera and lights (docs/guide/shot.md); the scene's own when absent
    #[arg(long, value_name = "SHOT.json")]
    shot: Option<PathBuf>,
    /// Where to write: .exr holds linear radiance, .png is tone mapped
    #[arg(short, long, value_name = "OUT.exr|OUT.png")]
    output: PathBuf,
    /// Which light to show
    #[arg(long, value_enum, default_value = "all")]
    only: OnlyArg,
    /// Width and height in pixels; the shot's when absent
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<[u32; 2]>,
    /// Seed of all random numbers
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Threads; all cores when absent
    #[arg(long)]
    threads: Option<usize>,
}

/// Which light to show.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum OnlyArg {
    /// Direct and bounced light, and surfaces that shine by themselves
    All,
    /// Light that did not bounce, and surfaces that shine by themselves
    Direct,
    /// Light that bounced at least once
    Indirect,
}

impl From<OnlyArg> for Only {
    fn from(only: OnlyArg) -> Self {
        match only {
            OnlyArg::All => Only::All,
            OnlyArg::Direct => Only::Direct,
            OnlyArg::Indirect => Only::Indirect,
        }
    }
}

/// Sets the number of threads of the whole program; all cores when absent.
pub fn set_threads(threads: Option<usize>) -> Result<()> {
    let Some(threads) = threads else { return Ok(()) };
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global().context("setting up threads")
}

/// Completes the lights of a shot, read from `file` if it is not the scene's own, for a scene with these groups of emissive
/// surfaces; returns the picture of the shot's environment, `own` where the shot names no file.
pub fn lit(
    file: Option<&Path>,
    mut shot: Shot,
    groups: &[String],
    own: Option<Arc<Environment>>,
) -> Result<(Shot, Option<Arc<Environment>>)> {
    shot.resolve_groups(groups).map_err(anyhow::Error::msg)?;
    if file.is_some() {
        shot.lights = mixed(&with_emission(&shot.lights, groups.len(), shot.emission), &shot.mix);
    }
    let environment = read_environment(&shot, file.unwrap_or(Path::new("")))?;
    Ok((shot, environment.or(own)))
}

fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let number = |part: &str| match part.trim().parse() {
        Ok(n) if (1..=shot::MAX_SIZE).contains(&n) => Some(n),
        _ => None,
    };
    text.split_once(['x', 'X'])
        .and_then(|(w, h)| Some([number(w)?, number(h)?]))
        .ok_or_else(|| format!("give width x height, each from 1 to {}, as in 640x360", shot::MAX_SIZE))
}

/// Reads the picture of the environment that a shot names, relative to the shot's `path`; `None` where it names none.
pub fn read_environment(shot: &Shot, path: &Path) -> Result<Option<Arc<Environment>>> {
    let mut files = shot.lights.iter().filter_map(|light| match light {
        Light::Environment { file, .. } => file.as_deref(),
        _ => None,
    });
    let Some(file) = files.next() else { return Ok(None) };
    let beside = path.parent().unwrap_or(Path::new(""));
    let (environment, notes) = environment::read(&beside.join(file))?;
    notes.iter().for_each(|note| eprintln!("note: {note}"));
    Ok(Some(Arc::new(environment)))
}

impl PictureArgs {
    /// Checks the output path, sets up the threads and reads the shot, before the long work.
    pub fn prepare(&self) -> Result<Option<Shot>> {
        check_name(&self.output)?;
        check_place(&self.output)?;
        set_threads(self.threads)?;
        Ok(self.shot.as_deref().map(shot::read).transpose()?)
    }

    /// Completes the lights of a shot for a fixed solution with these groups of emissive surfaces. Its sky is the file's own.
    pub fn lit_as_solved(&self, mut shot: Shot, groups: &[String]) -> Result<Shot> {
        for light in &mut shot.lights {
            if let Light::Environment { file, .. } = light
                && let Some(file) = file.take()
            {
                eprintln!("note: the sky is the one that the file was solved with; {file} is not read");
            }
        }
        Ok(self.lit(shot, groups, None)?.0)
    }

    /// As [`lit`], of this command's shot.
    pub fn lit(
        &self,
        shot: Shot,
        groups: &[String],
        own: Option<Arc<Environment>>,
    ) -> Result<(Shot, Option<Arc<Environment>>)> {
        lit(self.shot.as_deref(), shot, groups, own)
    }

    pub fn only(&self) -> Only {
        self.only.into()
    }

    pub fn exposure(&self, shot: &Shot, samples: u32) -> Exposure {
        Exposure { size: self.size.unwrap_or(shot.size), samples, seed: self.seed }
    }

    /// Writes the picture of `surfaces` from a camera. In a PNG, `lights` limit the exposure, unlit surfaces keep their
    /// colours, and an object with a ground has a backdrop.
    pub fn write(
        &self,
        picture: &Picture,
        surfaces: &impl Surfaces,
        camera: &CameraFrame,
        lights: &[LightSource],
        exposure: Exposure,
        ground: Option<&Ground>,
    ) -> Result<()> {
        if is_png(&self.output) {
            let of = Shown { surfaces, camera, lights, exposure, ground, only: self.only() };
            let shown = of.picture(picture);
            let bytes = png::encode_display(&shown).map_err(anyhow::Error::msg)?;
            write_whole(&self.output, &bytes)?;
        } else {
            picture.write(&self.output, f32::INFINITY)?;
        }
        eprintln!("wrote {}", self.output.display());
        Ok(())
    }
}

/// Returns the given shot, or a shot of the scene's first camera and the scene's lights.
pub fn shot_or_own(shot: Option<Shot>, spec: &str, cameras: &[Camera], lights: &[Light]) -> Result<Shot> {
    if let Some(shot) = shot {
        return Ok(shot);
    }
    let camera =
        cameras.first().with_context(|| format!("{spec} has no camera: give one with --shot SHOT.json"))?;
    if lights.is_empty() {
        anyhow::bail!("{spec} has no light: give some with --shot SHOT.json");
    }
    Ok(Shot::new([640, 360], camera.clone(), lights.to_vec()))
}

fn is_png(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png"))
}

/// Checks that [`write_panel`] can write to `out`.
pub fn check_panel(out: &Path) -> Result<()> {
    if !is_png(out) {
        anyhow::bail!("{}: such a picture is a PNG, its name must end in .png", out.display());
    }
    Ok(check_place(out)?)
}

/// Writes a PNG of pictures side by side: radiance with the first picture's exposure, then the pictures of
/// `as_they_are`, unchanged.
pub fn write_panel(out: &Path, radiance: Option<&[&Picture]>, as_they_are: &[&Picture]) -> Result<()> {
    let radiance = radiance.unwrap_or_default();
    let exposure = radiance.first().map_or(1.0, |first| png::exposure_of_lit(first, f32::INFINITY));
    let developed: Vec<Picture> = radiance.iter().map(|p| png::developed(p, exposure)).collect();
    let all: Vec<&Picture> = developed.iter().chain(as_they_are.iter().copied()).collect();
    let name = || out.display().to_string();
    let bytes = png::encode_display(&Picture::beside(&all)).map_err(anyhow::Error::msg).with_context(name)?;
    write_whole(out, &bytes).with_context(name)
}

/// Progress in rows: a bar with the time left on a terminal, a line every ten seconds when piped.
pub struct Rows {
    bar: ProgressBar,
    plain: Option<Mutex<(u32, Instant, Instant)>>,
    total: u32,
}

impl Rows {
    pub fn new(total: u32) -> Self {
        let now = Instant::now();
        let plain = (!std::io::stderr().is_terminal()).then(|| Mutex::new((0, now, now)));
        let bar = if plain.is_some() { ProgressBar::hidden() } else { ProgressBar::new(total as u64) };
        if let Ok(style) = ProgressStyle::with_template("rows [{bar:30}] {pos}/{len}, {eta} left") {
            bar.set_style(style.progress_chars("=> "));
        }
        Self { bar, plain, total }
    }

    pub fn done(&self) {
        self.bar.inc(1);
        let Some(Ok(mut state)) = self.plain.as_ref().map(|p| p.lock()) else { return };
        let (done, began, last) = &mut *state;
        *done += 1;
        if last.elapsed() > Duration::from_secs(10) {
            *last = Instant::now();
            let left = began.elapsed().as_secs_f64() * (self.total as f64 / *done as f64 - 1.0);
            eprintln!("row {done} of {}, {left:.0} s left", self.total);
        }
    }

    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

impl Drop for Rows {
    fn drop(&mut self) {
        self.finish();
    }
}
