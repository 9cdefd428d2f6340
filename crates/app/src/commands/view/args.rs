//! What can be asked of `foveal view`?

use crate::commands::view::gaze_source::{WindowGaze, parse_window_gaze};
use crate::commands::view::keys;
use crate::gaze_source::TrackerOptions;
use crate::options::bytes::parse_memory;
use crate::options::decoding::DecodingOptions;
use crate::options::hold::parse_hold;
use crate::options::link::{Link, parse_link};
use crate::options::panels::PanelsOptions;
use crate::options::policy::{PolicyOptions, ViewOptions};
use crate::options::preset::PlayPresets;
use crate::options::showing::{EyeName, ShowingOptions};
use clap::Args;
use foveal_core::units::Seconds;
use std::path::PathBuf;

/// Space pauses, arrows and the mouse move, the wheel zooms, H lists all keys and then figures.
/// Through scenes W, A, S and D fly, E and C go up and down, a drag turns the head.
#[derive(Clone, Debug, Args)]
#[command(after_help = keys::listed())]
pub(crate) struct ViewArgs {
    /// The pack.
    pub(super) pack: PathBuf,
    /// Take the mouse for the gaze and show only what an eye there could see. Otherwise everything
    /// in view is shown as fine as the display can, and the mouse decides what comes first.
    #[arg(long)]
    pub(super) demo: bool,
    /// mouse, center (of the window), YAW,PITCH in degrees, scan, trace:FILE, head:FILE, udp:PORT,
    /// ws:URL or osc:PORT.
    #[arg(
        long,
        value_name = "G",
        default_value = "mouse",
        allow_hyphen_values = true
    )]
    #[arg(value_parser = parse_window_gaze)]
    pub(super) gaze: WindowGaze,
    #[command(flatten)]
    pub(super) tracker: TrackerOptions,
    #[command(flatten)]
    pub(super) policy: PolicyOptions,
    #[command(flatten)]
    pub(super) view: ViewOptions,
    #[command(flatten)]
    pub(super) panels: PanelsOptions,
    #[command(flatten)]
    pub(super) showing: ShowingOptions,
    /// Whose picture is shown, of content for two eyes; both lie side by side. With --panels, whose
    /// panels there are.
    #[arg(long, value_enum, default_value = "left")]
    pub(super) eye: EyeName,
    /// The link between pack and viewer, as RATE or RATE,DELAY: 8mbit or 8mbit,30ms, or 3g, 4g, 5g
    /// (2, 40, 67 mbit a second). It limits what uniform, eccentricity and perceptual fetch
    /// (default: no limit).
    #[arg(long, value_name = "L", value_parser = parse_link)]
    pub(super) link: Option<Link>,
    /// Scenes: what units and pictures of them may take on the GPU, as 32MB or 1GB.
    #[arg(long, value_name = "SIZE", default_value = "256MB", value_parser = parse_memory)]
    pub(super) gpu_memory: u64,
    #[command(flatten)]
    pub(super) presets: PlayPresets,
    /// Begin paused.
    #[arg(long)]
    pub(super) paused: bool,
    /// Stay at the end instead of starting over.
    #[arg(long)]
    pub(super) once: bool,
    /// Stills and scenes: close the window after so many seconds, at most 3600 (default: it stays
    /// until it is closed).
    #[arg(long, value_name = "SECONDS", value_parser = parse_hold, conflicts_with = "script")]
    pub(super) hold: Option<Seconds>,
    /// Begin on the full screen.
    #[arg(long)]
    pub(super) full_screen: bool,
    /// Play no sound.
    #[arg(long)]
    pub(super) mute: bool,
    /// Write what was selected and for which gaze to this file, for `foveal replay`.
    #[arg(long, value_name = "FILE")]
    pub(super) log: Option<PathBuf>,
    /// The folder for screenshots, made if it does not exist: the picture without the text over it
    /// (default: next to the pack, and for a script the current folder).
    #[arg(long, value_name = "DIR")]
    pub(super) screenshots: Option<PathBuf>,
    /// A file with one thing a line to happen by itself: SECONDS and key NAME, press NAME, release
    /// NAME (keys that fly), move X Y, leave, drag DX DY, wheel STEPS, resize W H, screenshot NAME,
    /// settle or quit.
    #[arg(long, value_name = "FILE")]
    pub(super) script: Option<PathBuf>,
    #[command(flatten)]
    pub(super) decoding: DecodingOptions,
    /// Seed of the scan path.
    #[arg(long, default_value_t = 1)]
    pub(super) seed: u64,
    /// Print one JSON object at the end.
    #[arg(long)]
    pub(super) json: bool,
}
