//! What can a person ask of a simulation?

use crate::commands::simulate::scoring::ScoringOptions;
use crate::gaze_source::{GazeChoice, TrackerOptions, parse_gaze};
use crate::options::bytes::{parse_budget, parse_memory};
use crate::options::decoding::DecodingOptions;
use crate::options::hold::HoldOptions;
use crate::options::link::parse_delay;
use crate::options::panels::PanelsOptions;
use crate::options::policy::{PolicyOptions, ViewOptions};
use crate::options::renderer::RendererName;
use crate::options::showing::{EyeName, ShowingOptions};
use crate::options::watching::Watching;
use crate::report::output::{WrongUsage, out_of_range};
use crate::run::run_folder::{hold, make_room};
use anyhow::{Context, bail};
use clap::{Args, ValueEnum};
use foveal_core::units::Seconds;
use foveal_core::view::panel::rig::Panel;
use std::path::{Path, PathBuf};

/// Most frames between two pictures.
const MOST_EVERY: u32 = 10_000;

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum WrittenPictures {
    /// One PNG a frame.
    Png,
    /// One video.
    Video,
    /// None: only figures.
    None,
}

#[derive(Clone, Debug, Args)]
pub(crate) struct SimulateArgs {
    /// The pack.
    pub(crate) pack: PathBuf,
    /// YAW,PITCH in degrees, center, scan, trace:FILE, head:FILE, udp:PORT, ws:URL or osc:PORT.
    ///
    /// The last three are live: frames are then played when they are due.
    #[arg(
        long,
        value_name = "G",
        default_value = "scan",
        allow_hyphen_values = true
    )]
    #[arg(value_parser = parse_gaze)]
    pub(crate) gaze: GazeChoice,
    #[command(flatten)]
    pub(crate) tracker: TrackerOptions,
    #[command(flatten)]
    pub(crate) policy: PolicyOptions,
    #[command(flatten)]
    pub(crate) watching: Watching,
    #[command(flatten)]
    pub(crate) view: ViewOptions,
    #[command(flatten)]
    pub(crate) panels: PanelsOptions,
    #[command(flatten)]
    pub(crate) showing: ShowingOptions,
    /// First frame to play; decoding starts at its group's key frame, without showing.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) start: u32,
    /// Stop after this many frames (default: all, and with a live gaze round after round until it
    /// is stopped by Ctrl-C; of a scene those of its route, or of --hold; before a viewer who
    /// stands still, without a trace, 120).
    #[arg(long, value_name = "N")]
    pub(crate) frames: Option<u32>,
    #[command(flatten)]
    pub(crate) hold: HoldOptions,
    /// Folder for pictures, frames.csv and session.jsonl; made if it is not there. What an older
    /// run left in it is removed.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// What pictures to write.
    #[arg(long, value_enum, default_value = "png")]
    pub(crate) pictures: WrittenPictures,
    /// Whose picture to write, of content for two eyes; both lie side by side. With --panels, whose
    /// panels there are.
    #[arg(long, value_enum, default_value = "left")]
    pub(crate) eye: EyeName,
    /// Write every Nth picture.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) every: u32,
    /// Draw levels as colours over the pictures; of video also tile borders and the gaze.
    #[arg(long)]
    pub(crate) heat_map: bool,
    /// What draws the pictures.
    #[arg(long, value_enum, default_value = "gpu")]
    pub(crate) renderer: RendererName,
    /// Show a frame when its time is over, a coarser level standing in for tiles that are late;
    /// otherwise every frame is waited for.
    #[arg(long)]
    pub(crate) paced: bool,
    #[command(flatten)]
    pub(crate) decoding: DecodingOptions,
    /// Seed of the scan path.
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
    #[command(flatten)]
    pub(crate) scoring: ScoringOptions,
    /// Scenes: where the eye is: still, orbit or a file with t_s,x,y,z,yaw_deg,pitch_deg. A gaze
    /// counts from where the route looks, and stays within 20 degrees of it.
    #[arg(long, value_name = "R", default_value = "still")]
    pub(crate) route: String,
    /// Scenes: bytes that may be fetched between one picture and the next, as 100KB; a fixed
    /// allowance in place of the rate of --link.
    #[arg(long, value_name = "BYTES", value_parser = parse_budget)]
    pub(crate) budget: Option<u64>,
    /// Scenes and stills: time from one picture to the next, as 200ms, 1 to 10000 ms
    /// (default: 33.3, 30 pictures a second).
    #[arg(long, value_name = "MS", value_parser = parse_interval)]
    pub(crate) interval: Option<Seconds>,
    /// Scenes: most memory on the GPU.
    #[arg(long, value_name = "BYTES", value_parser = parse_memory, default_value = "256MB")]
    pub(crate) gpu_memory: u64,
    /// Print one JSON object.
    #[arg(long)]
    pub(crate) json: bool,
}

impl SimulateArgs {
    /// Checks how many pictures are made and written.
    pub(crate) fn check_counts(&self) -> anyhow::Result<()> {
        if !(1..=MOST_EVERY).contains(&self.every) {
            bail!(out_of_range(
                "--every",
                self.every,
                &format!("1 to {MOST_EVERY}")
            ));
        }
        if self.frames == Some(0) {
            bail!(out_of_range("--frames", 0, "at least 1"));
        }
        if self.frames.is_some() && self.hold.hold.is_some() {
            bail!(WrongUsage(
                "--frames and --hold both say how long it is shown; give one of them".to_owned()
            ));
        }
        Ok(())
    }

    /// The files that are read.
    fn inputs(&self) -> Vec<&Path> {
        let mut inputs = vec![self.pack.as_path(), Path::new(&self.route)];
        inputs.extend(self.gaze.file());
        inputs.extend(self.panels.panels.as_deref());
        inputs.extend(self.watching.files());
        inputs
    }

    /// Where the pictures of each view go, made where they are not there; what an older run left
    /// there is removed.
    pub(crate) fn folders(&self, panels: Option<&[Panel]>) -> anyhow::Result<Vec<PathBuf>> {
        let folders = match panels {
            None => vec![self.out.clone()],
            Some(panels) => panels.iter().map(|it| self.out.join(&it.id)).collect(),
        };
        let ids: Vec<&str> = panels
            .iter()
            .flat_map(|it| it.iter())
            .map(|it| it.id.as_str())
            .collect();
        make_folder(&self.out)?;
        hold(&self.out)?;
        make_room(&self.out, &ids, &self.inputs())?;
        let writes = self.pictures != WrittenPictures::None;
        for folder in folders.iter().filter(|_| writes) {
            make_folder(folder)?;
        }
        Ok(folders)
    }
}

fn make_folder(path: &Path) -> anyhow::Result<()> {
    std::fs::create_dir_all(path)
        .with_context(|| format!("--out {}: the folder cannot be made", path.display()))
}

/// Reads an interval, as 200ms.
fn parse_interval(text: &str) -> anyhow::Result<Seconds> {
    match parse_delay(text) {
        Ok(interval) if interval.0 >= 0.001 => Ok(interval),
        _ => bail!("\"{text}\": expected 1 to 10000 ms, as 200ms"),
    }
}
