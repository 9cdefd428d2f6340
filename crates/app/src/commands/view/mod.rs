//! `foveal view`: what is in the window?

mod asking;
mod keys;
mod log_file;
mod looking;
mod opening;
mod screen;
mod script;
mod sound;
mod summary;
mod telling;
mod viewer;
mod window;

use crate::commands::view::sound::samples::Samples;
use crate::gaze_source::{ViewerModel as Watching, preset_of};
use crate::options::decoding::DecodingOptions;
use crate::options::link::{Link, parse_link};
use crate::options::policy::{PolicyOptions, ViewOptions, check_thresholds};
use crate::options::showing::{EyeName, ShowingOptions};
use crate::report::output::{self, WrongUsage};
use anyhow::{Context, bail};
use clap::Args;
use foveal_core::content::policy::Policy;
use foveal_core::session::session::SessionSettings;
use foveal_media::pack::pack_file::PackFile;
use foveal_play::Decoding;
use foveal_play::LiveOptions;
use looking::{WindowGaze, parse_window_gaze};
use script::Script;
use std::path::PathBuf;
use std::sync::Arc;

/// Space pauses, arrows and the mouse move, the wheel zooms, H lists all keys and then figures.
#[derive(Clone, Debug, Args)]
#[command(after_help = keys::listed())]
pub(crate) struct ViewArgs {
    /// The pack.
    pack: PathBuf,
    /// Take the mouse for the gaze and show only what an eye there could see. Otherwise everything
    /// in view is shown as fine as the display can, and the mouse decides what comes first.
    #[arg(long)]
    demo: bool,
    /// mouse, center (of the window), YAW,PITCH in degrees, scan, trace:FILE, head:FILE, udp:PORT,
    /// ws:URL or osc:PORT.
    #[arg(
        long,
        value_name = "G",
        default_value = "mouse",
        allow_hyphen_values = true
    )]
    #[arg(value_parser = parse_window_gaze)]
    gaze: WindowGaze,
    #[command(flatten)]
    policy: PolicyOptions,
    #[command(flatten)]
    view: ViewOptions,
    #[command(flatten)]
    showing: ShowingOptions,
    /// Whose picture is shown, of content for two eyes; both lie side by side.
    #[arg(long, value_enum, default_value = "left")]
    eye: EyeName,
    /// RATE[,DELAY] between the pack and the viewer, as 4g,30ms or 8mbit: what uniform,
    /// eccentricity and perceptual may spend (default: no limit).
    #[arg(long, value_name = "L", value_parser = parse_link)]
    link: Option<Link>,
    /// How gaze follows the head: free-viewing, search or a file that `gaze fit head` wrote.
    #[arg(long, value_name = "NAME|FILE.toml", default_value = "free-viewing")]
    preset: String,
    /// Begin paused.
    #[arg(long)]
    paused: bool,
    /// Stay at the end instead of beginning anew.
    #[arg(long)]
    once: bool,
    /// Begin on the full screen.
    #[arg(long)]
    full_screen: bool,
    /// Play no sound.
    #[arg(long)]
    mute: bool,
    /// Write what was selected and for which gaze to this file, for `foveal replay`.
    #[arg(long, value_name = "FILE")]
    log: Option<PathBuf>,
    /// The folder for screenshots, made where it is not there: the picture without what is written
    /// over it (default: beside the pack, and for a script's the current folder).
    #[arg(long, value_name = "DIR")]
    screenshots: Option<PathBuf>,
    /// A file with one thing a line to happen by itself: SECONDS and key NAME, move X Y, leave,
    /// drag DX DY, wheel STEPS, resize W H, screenshot FILE, settle or quit.
    #[arg(long, value_name = "FILE")]
    script: Option<PathBuf>,
    #[command(flatten)]
    decoding: DecodingOptions,
    /// Seed of the scan path.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print one JSON object at the end.
    #[arg(long)]
    json: bool,
}

/// What was read before a window opens: whatever is wrong is said without one.
struct Ready {
    args: ViewArgs,
    file: Arc<PackFile>,
    watching: Watching,
    script: Script,
    samples: Option<Samples>,
    decoding: Decoding,
}

impl Ready {
    fn new(args: &ViewArgs) -> anyhow::Result<Self> {
        let decoding = args.decoding.decoding()?;
        let file = Arc::new(PackFile::open(&args.pack)?);
        if let Some(log) = &args.log {
            output::spare_inputs(log, [args.pack.as_path()])?;
        }
        if let Some(folder) = &args.screenshots {
            std::fs::create_dir_all(folder).with_context(|| {
                format!(
                    "--screenshots {}: no such folder can be made",
                    folder.display()
                )
            })?;
        }
        // Says what is wrong with the options before a window is there.
        let config = args.policy.config()?;
        check_thresholds(&config, &file.pack().description().grid(args.view.screen))?;
        if args.link.is_some() && !config.policy.spends_a_budget() {
            bail!(WrongUsage(format!(
                "--link: {} spends no budget; give --policy uniform, eccentricity or perceptual",
                args.policy.name().name()
            )));
        }
        if args.showing.has_textures() && config.policy == Policy::Sampled {
            bail!(WrongUsage(
                "--reconstruction textures shows tiles, --policy sampled samples; give one of them"
                    .to_owned()
            ));
        }
        let surface = file.pack().description().grid(args.view.screen).surface;
        args.view.eye_view(&surface)?;
        let script = args.script.as_ref().map(|path| {
            let text = output::read_text(path, "a script")?;
            Script::parse(&text).with_context(|| format!("--script {}", path.display()))
        });
        Ok(Self {
            watching: Watching {
                preset: preset_of(&args.preset)?,
                late: args.link.unwrap_or_default().delay,
            },
            script: script.transpose()?.unwrap_or_default(),
            samples: if args.mute { None } else { sound_of(&file) },
            args: args.clone(),
            file,
            decoding,
        })
    }

    /// How the pack is played for a session with these settings.
    fn live_options(&self, session: SessionSettings) -> LiveOptions {
        LiveOptions {
            session,
            decoding: self.decoding,
            tell: output::say,
        }
    }
}

/// The sound of a pack; one that is damaged is told of and left out.
fn sound_of(file: &PackFile) -> Option<Samples> {
    let damaged = |error: anyhow::Error| output::say(&format!("foveal: {error:#}; no sound"));
    Samples::of_pack(file).map_err(damaged).ok().flatten()
}

pub(crate) fn run(args: &ViewArgs) -> anyhow::Result<()> {
    let summary = window::run(Ready::new(args)?)?;
    output::result(args.json, &summary, &summary.text())
}
