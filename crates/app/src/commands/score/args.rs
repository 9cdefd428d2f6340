//! What can be asked of `foveal score`?

use crate::commands::score::conditions::{DeviceName, GazeWords, ModeName, parse_gaze_words};
use crate::options::policy::{PolicyOptions, ViewOptions};
use crate::options::policy_choice::policy_parser;
use clap::{Args, ValueEnum};
use foveal_core::content::policy::Policy;
use foveal_eval::score::companion::Companion;
use std::path::PathBuf;

/// A measure by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum MetricName {
    /// FovVideoVDP 1.2: just-objectionable differences, 10 is no difference.
    #[value(name = "fovvideovdp")]
    FovVideoVdp,
    /// Peak signal to noise over red, green and blue.
    Psnr,
    /// The same, errors weighed by the cells of the eye that look there.
    FwPsnr,
    /// Structural similarity of luma.
    Ssim,
    /// The same in the square round the fovea.
    FovealSsim,
    /// Luma of equirectangular pictures, rows weighed by their length on the sphere.
    WsPsnr,
    /// Luma of equirectangular pictures at places spread evenly over the sphere.
    SPsnr,
}

impl MetricName {
    pub(super) fn companion(self) -> Option<Companion> {
        Some(match self {
            Self::FovVideoVdp => return None,
            Self::Psnr => Companion::Psnr,
            Self::FwPsnr => Companion::FwPsnr,
            Self::Ssim => Companion::Ssim,
            Self::FovealSsim => Companion::FovealSsim,
            Self::WsPsnr => Companion::WsPsnr,
            Self::SPsnr => Companion::SPsnr,
        })
    }
}

/// Scores pictures, folders of numbered pictures, videos, two packs under two policies, or a pack
/// against the file that it was made from; alone or many pairs at once.
///
/// Without --gaze there is no gaze, and eccentricity does not count.
#[derive(Clone, Debug, Args)]
pub(crate) struct ScoreArgs {
    /// A picture, a folder of numbered pictures, a video or a pack: what should be seen. Before a
    /// pack, a file is what it was made from, and is seen in the same views.
    #[arg(required_unless_present_any = ["pairs", "list_displays", "cite"])]
    pub(super) reference: Option<PathBuf>,
    /// The same in the same size: what is seen.
    #[arg(required_unless_present_any = ["pairs", "list_displays", "cite"])]
    pub(super) test: Option<PathBuf>,
    /// What shows it (default, of packs alone: the view itself): standard_4k, standard_fhd,
    /// standard_hmd, standard_phone, standard_hdr_pq, sdr_4k_30, sdr_fhd_24, htc_vive_pro,
    /// iphone_12_pro, ipad_pro_12_9, macbook_pro_16, lg_oled_2017_sdr, lg_oled_2017_hdr, or a file
    /// that describes it.
    #[arg(long, value_name = "NAME|FILE.toml")]
    pub(super) display: Option<String>,
    /// Where the eye looks, in the picture or outside it: pixels from the middle of the first one,
    /// to the right and down, or center. Of a pack against its source, as in `simulate`: YAW,PITCH
    /// in degrees, center, scan, trace:FILE or head:FILE.
    #[arg(long, value_name = "X,Y", value_parser = parse_gaze_words, allow_hyphen_values = true)]
    #[arg(conflicts_with = "gaze_trace")]
    pub(super) gaze: Option<GazeWords>,
    /// The same frame by frame: CSV with frame,x_px,y_px.
    #[arg(long, value_name = "FILE.csv")]
    pub(super) gaze_trace: Option<PathBuf>,
    /// What is measured.
    #[arg(long, value_enum, default_value = "fovvideovdp")]
    pub(super) metric: MetricName,
    /// As published, to compare with published scores, or right where that slips.
    #[arg(long, value_enum, default_value = "compat")]
    pub(super) mode: ModeName,
    /// Stop after this many frames (default: all).
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(super) frames: Option<u32>,
    /// Write what is lost at every pixel, the mean over all frames: as a picture, or where the name
    /// ends in .npy as numbers, JOD as float32 by rows and columns.
    #[arg(long, value_name = "OUT.png|OUT.npy")]
    pub(super) heat: Option<PathBuf>,
    /// What computes.
    #[arg(long, value_enum, default_value = "cpu")]
    pub(super) device: DeviceName,
    /// Threads (default: all cores).
    #[arg(long, value_name = "N")]
    pub(super) jobs: Option<usize>,
    /// Print one JSON object.
    #[arg(long)]
    pub(super) json: bool,
    /// Frames a second (default: the video's; folders need it).
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    #[arg(help_heading = "Pictures and videos")]
    pub(super) fps: Option<f64>,
    /// Score every row of a table: CSV with reference,test; optionally gaze_x,gaze_y,gaze_trace,
    /// display, which go before the options; other columns are kept. Files are named from where the
    /// table lies.
    #[arg(
        long,
        value_name = "FILE.csv",
        requires = "out",
        help_heading = "Many pairs"
    )]
    #[arg(conflicts_with_all = ["reference", "test", "heat"])]
    pub(super) pairs: Option<PathBuf>,
    /// The same table with jod (or value) and under which conditions, or in column error why not.
    #[arg(
        long,
        value_name = "FILE.csv",
        requires = "pairs",
        help_heading = "Many pairs"
    )]
    pub(super) out: Option<PathBuf>,
    /// List the displays that have names, with their figures.
    #[arg(long, conflicts_with = "pairs", help_heading = "In place of a score")]
    pub(super) list_displays: bool,
    /// Print version, parameters and paper, ready for a methods section.
    #[arg(long, conflicts_with_all = ["list_displays", "pairs"])]
    #[arg(help_heading = "In place of a score")]
    pub(super) cite: bool,
    /// The policy that the first of two packs is played under.
    #[arg(long, value_parser = policy_parser(), default_value = "full", help_heading = PACKS)]
    pub(super) reference_policy: Policy,
    #[command(flatten, next_help_heading = PACKS)]
    pub(super) policy: PolicyOptions,
    #[command(flatten, next_help_heading = PACKS)]
    pub(super) view: ViewOptions,
    /// Seed of the scan path.
    #[arg(long, default_value_t = 1, help_heading = PACKS)]
    pub(super) seed: u64,
}

/// What stands above the options that pictures and videos do not go by.
const PACKS: &str = "Packs alone";
