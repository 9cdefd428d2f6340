//! The `foveal` program: which command runs?

mod allocator;
mod commands;
#[cfg(test)]
mod documented_tests;
mod examples;
mod gaze_source;
mod help;
mod inputs;
mod options;
mod report;
mod run;
mod web_files;

use allocator::Allocator;
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use std::ffi::OsString;
use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: Allocator = Allocator::new();

/// Streams and renders only the detail an eye can see.
#[derive(Debug, Parser)]
#[command(version, propagate_version = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Turn a video, a picture or a 3D scene into a pack.
    #[command(subcommand)]
    Prepare(Prepare),
    /// Show what is in a pack.
    Info(commands::info::InfoArgs),
    /// Check every byte of a pack.
    Verify(commands::verify::VerifyArgs),
    /// Measure a pack's score by detail, so that targets hold.
    Calibrate(commands::calibrate::CalibrateArgs),
    /// Show which levels a policy would choose, without content.
    Select(commands::select::SelectArgs),
    /// Play a pack without a window: pictures, figures and a log.
    Simulate(commands::simulate::options::SimulateArgs),
    /// Show a video or a scene in a window.
    #[command(mut_arg("policy", |policy| {
        policy.help(
            "How levels are chosen: by viewport, or with --demo by perceptual, of scenes by \
             acuity (eccentricity with --link), if not given",
        )
    }))]
    View(commands::view::ViewArgs),
    /// Show a clip, a sphere, a mesh and panels in one report.
    Demo(commands::demo::DemoArgs),
    /// Fill tiled headsets, walls and domes from one source.
    #[command(subcommand)]
    Panels(commands::panels::Panels),
    /// Show what the eye resolves and what detail is worth to it.
    #[command(subcommand)]
    Perception(commands::perception::Perception),
    /// Measure speed and cost on this machine.
    #[command(subcommand)]
    Bench(commands::bench::Bench),
    /// Score a picture or video for an eye and where it looks.
    Score(Box<commands::score::ScoreArgs>),
    /// Compare policies and codecs on your own video.
    #[command(subcommand)]
    Evaluate(commands::evaluate::Evaluate),
    /// Repeat the selection of a logged session and compare.
    Replay(commands::replay::ReplayArgs),
    /// Write packs and pages into a folder for any web host.
    #[command(subcommand)]
    Export(commands::site::export::Export),
    /// Serve a site, or packs, to browsers.
    Serve(commands::serve::ServeArgs),
    /// Record, classify, fit and evaluate gaze.
    #[command(subcommand)]
    Gaze(commands::gaze::GazeCommand),
}

#[derive(Debug, Subcommand)]
enum Prepare {
    /// Turn flat or 360° video, or a still picture, into a pack.
    Video(commands::prepare::video::PrepareVideoArgs),
    /// Turn meshes (glTF, OBJ, PLY, STL) and scans (LAS, LAZ, PLY) of one scene into a pack.
    Scene(commands::prepare::scene::PrepareSceneArgs),
    /// List the formats that are read, and what becomes of what their files hold.
    Formats(commands::formats::FormatsArgs),
}

fn main() -> ExitCode {
    settle_environment();
    #[cfg(target_os = "linux")]
    keep_freed_memory();
    let program = help::by_task(examples::attached(with_negative_numbers(Cli::command())));
    report::called::read_command_line(&program);
    let matches = program.try_get_matches();
    let matches = matches.unwrap_or_else(|error| report::output::fail_usage(&with_hint(error)));
    let cli =
        Cli::from_arg_matches(&matches).unwrap_or_else(|error| report::output::fail_usage(&error));
    let given = options::unused::Given::of(&matches);
    let result = match cli.command {
        Command::Prepare(Prepare::Video(args)) => commands::prepare::video::run(&args),
        Command::Prepare(Prepare::Scene(args)) => commands::prepare::scene::run(&args),
        Command::Prepare(Prepare::Formats(args)) => commands::formats::run(&args),
        Command::Info(args) => commands::info::run(&args),
        Command::Verify(args) => commands::verify::run(&args),
        Command::Calibrate(args) => commands::calibrate::run(&args),
        Command::Select(args) => commands::select::run(&args, &given),
        Command::Simulate(args) => commands::simulate::run(&args, &given),
        Command::View(args) => commands::view::run(&args),
        Command::Demo(args) => commands::demo::run(&args),
        Command::Panels(command) => commands::panels::run(&command),
        Command::Perception(command) => commands::perception::run(&command),
        Command::Bench(command) => commands::bench::run(&command),
        Command::Score(args) => commands::score::run(&args),
        Command::Evaluate(command) => commands::evaluate::run(&command),
        Command::Replay(args) => commands::replay::run(&args),
        Command::Export(command) => commands::site::export::run(&command),
        Command::Serve(args) => commands::serve::run(&args),
        Command::Gaze(command) => commands::gaze::run(&command),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            let words = &report::called::called().words;
            report::output::fail(&run::other_input::no_address(words, error))
        }
    }
}

/// Suggests a command when a file was given in place of one, and a comma where a gaze was given as
/// two words.
fn with_hint(mut error: clap::Error) -> clap::Error {
    use clap::error::{ContextKind, ContextValue, ErrorKind};
    let called = report::called::called();
    let command = &called.command;
    let takes_files = ["foveal", "foveal prepare", "foveal panels"].contains(&command.as_str());
    let hint = match error.get(ContextKind::InvalidSubcommand) {
        Some(ContextValue::String(word)) if takes_files => {
            run::other_input::meant_command(command, word)
        }
        _ if error.kind() == ErrorKind::UnknownArgument => {
            gaze_source::gaze_in_two_words(&called.words)
        }
        _ => None,
    };
    if let Some(hint) = hint {
        let hint = ContextValue::StyledStrs(vec![hint.into()]);
        error.insert(ContextKind::Suggested, hint);
    }
    error
}

/// `-3` is a number, perhaps out of range, and not an unknown option.
fn with_negative_numbers(command: clap::Command) -> clap::Command {
    let takes_values = |arg: &clap::Arg| arg.get_action().takes_values();
    command
        .mut_args(|arg| match takes_values(&arg) {
            true => arg.allow_negative_numbers(true),
            false => arg,
        })
        .mut_subcommands(with_negative_numbers)
}

/// Frames and encoders come and go by the hundred megabytes, every few seconds; memory that was
/// given back to the system between them took up to a third of the time of `prepare` to be
/// cleared again. So it is given back after a while.
#[cfg(target_os = "linux")]
fn keep_freed_memory() {
    /// `mi_option_purge_delay` of mimalloc.h, in milliseconds.
    const PURGE_DELAY: libmimalloc_sys::mi_option_t = 15;
    #[allow(unsafe_code, reason = "a call of C")]
    // SAFETY: the option is of this version, and options may be set at any time.
    unsafe {
        libmimalloc_sys::mi_option_set(PURGE_DELAY, 120_000);
    }
}

/// What Mesa's drivers ask of the environment and complain of on stderr where it is missing: its
/// device-select layer a display (wgpu chooses the device itself), its loaders a folder for what
/// lives as long as the user is logged in.
fn settle_environment() {
    let has = |name| std::env::var_os(name).is_some();
    let mut missing = Vec::new();
    if !has("DISPLAY") && !has("WAYLAND_DISPLAY") && !has("NODEVICE_SELECT") {
        missing.push(("NODEVICE_SELECT", OsString::from("1")));
    }
    if cfg!(target_os = "linux") && !has("XDG_RUNTIME_DIR") {
        missing.push(("XDG_RUNTIME_DIR", std::env::temp_dir().into()));
    }
    for (name, value) in missing {
        #[allow(
            unsafe_code,
            reason = "changing the environment is unsafe while other threads run"
        )]
        // SAFETY: the first statement of main; no other thread has begun.
        unsafe {
            std::env::set_var(name, value);
        }
    }
}
