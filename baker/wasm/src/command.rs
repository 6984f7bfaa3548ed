//! The command `rebounce bake` in Node.js, with the options of the native command.

use super::host::{Host, check_memory, milliseconds, set_host, with_host};
use super::host_files::HostFiles;
use super::workers::Workers;
use clap::{Parser, Subcommand};
use js_sys::Uint8Array;
use rebounce::bake::{BakeError, Baker, Observer, Preview, Progress};
use rebounce::job::clock;
use rebounce::scene::outliers;
use rebounce_args::bake::BakeArgs;
use rebounce_args::error::sentence;
use rebounce_args::escape::escape_controls;
use rebounce_args::load::warnings;
use rebounce_args::plan::{Plan, thin};
use rebounce_args::progress::{JSON_LINES, LINES, LastShown, ProgressLine};
use rebounce_shared::rbn::container;
use serde::Serialize;
use std::error::Error;
use std::ffi::OsString;
use std::sync::Mutex;
use wasm_bindgen::prelude::*;

/// Exit codes of clap.
const WRONG_ARGUMENTS: i32 = 2;

/// Bakes how light bounces through a glTF scene, so that it can be relit live in a browser.
#[derive(Parser, Debug)]
#[command(name = "rebounce", version, disable_version_flag = true, propagate_version = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
    /// Prints the version
    #[arg(short = 'v', short_alias = 'V', long, action = clap::ArgAction::Version, global = true, display_order = 999)]
    version: (),
}

#[derive(Subcommand, Debug)]
enum Command {
    /// Bakes a scene into a .rbn file
    Bake(Box<BakeArgs>),
    #[command(external_subcommand)]
    Other(Vec<OsString>),
}

/// What JavaScript does next.
#[derive(Serialize)]
#[serde(rename_all = "camelCase", rename_all_fields = "camelCase", tag = "do")]
enum Next {
    /// Prints a text, on standard error if `is_error`, and ends.
    Print { text: String, is_error: bool, code: i32 },
    /// Bakes.
    Bake {
        output: String,
        report: Option<String>,
        preview: Option<String>,
        is_json: bool,
        workers: Option<usize>,
    },
}

fn arguments(words: Vec<String>) -> Result<Arguments, clap::Error> {
    Arguments::try_parse_from(["rebounce".to_owned()].into_iter().chain(words))
}

/// Parses the words of a command line, without the program's name, and checks the paths. `is_coloured`: help and errors
/// have the colours of a terminal. Returns what to do next, as JSON.
#[wasm_bindgen]
pub fn parse(host: &Host, words: Vec<String>, is_coloured: bool) -> String {
    set_host(host);
    let refused = |text: String| Next::Print { text, is_error: true, code: WRONG_ARGUMENTS };
    let next = match arguments(words) {
        Err(error) => Next::Print {
            text: match is_coloured {
                true => error.render().ansi().to_string(),
                false => error.render().to_string(),
            },
            is_error: error.use_stderr(),
            code: error.exit_code(),
        },
        Ok(Arguments { command: Command::Other(words), .. }) => {
            let verb = words.first().map(|word| word.to_string_lossy().into_owned()).unwrap_or_default();
            refused(format!(
                "rebounce: {} is a verb of the native program alone; the WebAssembly program, which runs here, has `bake`\n",
                escape_controls(&verb)
            ))
        }
        Ok(Arguments { command: Command::Bake(args), .. }) => {
            let native_alone = [(args.resume, "--resume"), (args.target_error.is_some(), "--target-error")];
            match (native_alone.iter().find(|(is_given, _)| *is_given), args.check(&HostFiles)) {
                (Some((_, option)), _) => refused(format!(
                    "rebounce: {option} is an option of the native program alone; the WebAssembly program runs here\n"
                )),
                (None, Err(error)) => Next::Print {
                    text: format!("rebounce: {}\n", escape_controls(&said(&error))),
                    is_error: true,
                    code: 1,
                },
                (None, Ok(())) => Next::Bake {
                    output: args.output().to_string_lossy().into_owned(),
                    report: args.report.as_ref().map(|path| path.to_string_lossy().into_owned()),
                    preview: args.preview_output().map(|path| path.to_string_lossy().into_owned()),
                    is_json: args.json_progress,
                    workers: args.threads,
                },
            }
        }
    };
    serde_json::to_string(&next).unwrap_or_default()
}

/// Returns the options of `rebounce bake`, as JSON: [`rebounce_args::table`].
#[wasm_bindgen(js_name = optionsTable)]
pub fn options_table() -> String {
    serde_json::to_string(&rebounce_args::table::options()).unwrap_or_default()
}

#[wasm_bindgen]
extern "C" {
    /// `CommandHost` of `baker/npm/src/wasm/host.ts`.
    #[wasm_bindgen(extends = Host)]
    type LineHost;

    /// Prints a line of progress: of `--json-progress`, or for people.
    #[wasm_bindgen(method)]
    fn line(this: &LineHost, text: &str, is_json: bool);

    /// Prints a note.
    #[wasm_bindgen(method)]
    fn note(this: &LineHost, sentence: &str);

    /// Milliseconds of processor time, of all threads of the process.
    #[wasm_bindgen(method)]
    fn processor(this: &LineHost) -> f64;
}

fn note(sentence: &str) {
    with_host(|host| host.unchecked_ref::<LineHost>().note(&escape_controls(sentence)));
}

/// The error and its causes as a sentence.
fn said<'a>(error: &'a (dyn Error + 'static)) -> String {
    let cause = |error: &&'a (dyn Error + 'static)| -> Option<&'a (dyn Error + 'static)> {
        let error: &'a (dyn Error + 'static) = *error;
        error.source()
    };
    sentence(std::iter::successors(Some(error), cause))
}

/// Shows progress and hands over previews.
struct CommandObserver {
    is_json: bool,
    wants_previews: bool,
    last: Mutex<LastShown>,
}

impl Observer for CommandObserver {
    fn progress(&self, progress: &Progress) {
        let Ok(mut last) = self.last.lock() else { return };
        with_host(|host| host.progress(progress.stage.label(), progress.fraction(), progress.seconds_left));
        if !last.is_due(progress, if self.is_json { JSON_LINES } else { LINES }) {
            return;
        }
        let text = match self.is_json {
            true => serde_json::to_string(&last.json(progress)).unwrap_or_default(),
            false => last.line(progress),
        };
        with_host(|host| host.unchecked_ref::<LineHost>().line(&text, self.is_json));
    }

    fn wants_previews(&self) -> bool {
        self.wants_previews
    }

    fn preview(&self, preview: Preview) {
        // A preview that does not fit the format is no loss: the file itself reports the error.
        if let Ok(bytes) = preview.file.to_bytes() {
            with_host(|host| host.preview(Uint8Array::from(&bytes[..])));
        }
    }
}

/// Result of a bake.
#[wasm_bindgen]
pub struct CommandFile {
    bytes: Vec<u8>,
    summary: String,
    report: String,
    last_line: String,
}

#[wasm_bindgen]
impl CommandFile {
    /// The .rbn file.
    #[wasm_bindgen(getter)]
    pub fn bytes(&self) -> Uint8Array {
        Uint8Array::from(&self.bytes[..])
    }

    /// The figures of the bake, as lines of text.
    #[wasm_bindgen(getter)]
    pub fn summary(&self) -> String {
        self.summary.clone()
    }

    /// The figures of the bake, as JSON: the file of `--report`.
    #[wasm_bindgen(getter)]
    pub fn report(&self) -> String {
        self.report.clone()
    }

    /// The last line of `--json-progress`.
    #[wasm_bindgen(getter, js_name = lastLine)]
    pub fn last_line(&self) -> String {
        self.last_line.clone()
    }
}

/// Bakes as worker `rank` of `size`: `words` are those of [`parse`], which has accepted them. Returns the file on worker
/// 0, nothing on the others.
///
/// # Errors
/// A sentence, as an `Error`.
#[wasm_bindgen(js_name = bakeCommand)]
pub async fn bake_command(
    host: Host,
    words: Vec<String>,
    rank: usize,
    size: usize,
) -> Result<Option<CommandFile>, JsError> {
    set_host(&host);
    clock::set_processor(|| {
        with_host(|host| milliseconds(host.unchecked_ref::<LineHost>().processor())).unwrap_or_default()
    });
    let began = (clock::wall(), clock::processor());
    let arguments = arguments(words).map_err(|error| JsError::new(&error.render().to_string()))?;
    let Command::Bake(args) = arguments.command else { return Err(JsError::new("bake is the only verb")) };
    let failed = |error: &(dyn Error + 'static)| JsError::new(&escape_controls(&said(error)));
    let scene = args.scene(&HostFiles, &mut note).map_err(|error| failed(&error))?;
    warnings(&scene)
        .iter()
        .chain(&outliers::far_away(&scene))
        .for_each(|sentence| host.warn(&escape_controls(sentence)));
    let shot = args.shot(&HostFiles).map_err(|error| failed(&error))?;
    let camera = shot.as_ref().map(|shot| &shot.camera);
    let plan = Plan::asked_for(&args, &scene, camera).map_err(|error| failed(&error))?;
    plan.note().iter().for_each(|sentence| note(sentence));
    check_memory(&scene, &plan.settings, &args.scene, "a worker").map_err(|error| JsError::new(&error))?;
    let workers = Workers { host: &host, rank, size };
    let observer =
        CommandObserver { is_json: args.json_progress, wants_previews: args.preview, last: Mutex::default() };
    let named =
        |error: &BakeError| JsError::new(&escape_controls(&format!("{}: {}", args.scene, said(error))));
    let baker = Baker::new(&plan.settings).observer(&observer).communicator(&workers);
    let baked = baker.bake_async(&scene).await.map_err(|error| named(&error))?;
    let Some((mut baked, mut report)) = baked else { return Ok(None) };
    drop(scene);
    thin(&args, &mut baked, &mut note).map_err(|error| failed(&error))?;
    let bytes = baked.to_bytes().map_err(|error| named(&BakeError::from(error)))?;
    report.add_file(&container::read(&bytes)?, bytes.len() as u64);
    let line = ProgressLine::done(
        (clock::wall() - began.0).as_secs_f64(),
        (clock::processor() - began.1).as_secs_f64(),
        None,
    );
    Ok(Some(CommandFile {
        bytes,
        summary: report.to_string(),
        report: serde_json::to_string_pretty(&report)?,
        last_line: serde_json::to_string(&line)?,
    }))
}
