//! What can a person ask of a warp?

use super::eye::EyeArgs;
use crate::commands::panels::filter_name::FilterName;
use crate::commands::panels::rig_args::RigArgs;
use crate::options::renderer::RendererName;
use crate::report::output::{WrongUsage, out_of_range, spare_inputs};
use anyhow::bail;
use clap::{Args, ValueEnum};
use foveal_core::view::panel::rig::Panel;
use std::path::{Path, PathBuf};

/// Most of Feline's samples of a pixel.
pub(super) const MOST_PROBES: u32 = 16;

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum WarpModeName {
    /// As seed 002's program: two maps of 16.16 bits a panel, and derivatives of 8.
    Seed,
}

/// Fills all panels of a rig from one source.
///
/// A world is drawn for each eye, as large as no panel magnifies it unless --source is given; a
/// file lies where all panels of --eye see it.
#[derive(Clone, Debug, Args)]
pub(crate) struct WarpArgs {
    #[command(flatten)]
    pub(super) rig: RigArgs,
    /// A picture or video file, world:valley or world:gratings, or what is live: x11:root, x11:ID
    /// or x11:TITLE of a window, v4l2:DEVICE, lavfi:GRAPH.
    pub(super) source_name: String,
    /// The folder for ID.png a panel, as the eye sees it, and atlas.png, as it is sent; a video, or
    /// any source with --frames, gives ID/frame_00000.png and so on.
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// Show a window for each surface, full screen on the monitor that the rig names, until one is
    /// closed; Q or Escape closes them.
    #[arg(long, conflicts_with_all = ["out", "compare"])]
    pub(super) window: bool,
    /// How the source is filtered (default: auto; with --mode seed trilinear).
    #[arg(long, value_enum)]
    pub(super) filter: Option<FilterName>,
    /// By maps instead of matrices; the source then lies as in seed 002 unless --placement says
    /// otherwise.
    #[arg(long, value_enum)]
    pub(super) mode: Option<WarpModeName>,
    /// Stop after this many frames (default: all of a video, 1 of a world, and what is live until
    /// Ctrl-C; in a window all).
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(super) frames: Option<u32>,
    /// How the two eyes' pictures lie in the source.
    #[arg(long, value_enum, default_value = "mono")]
    pub(super) stereo: StereoName,
    /// How far a mono source lies before the head (default: infinitely far).
    #[arg(long, value_name = "METRES")]
    pub(super) distance: Option<f64>,
    /// Size of a world's picture for each eye as 1600x1200, or a picture or video that has it
    /// (default: as many pixels as are needed).
    #[arg(long, value_name = "WxH|FILE")]
    pub(super) source: Option<String>,
    /// Also draw each panel of a world directly, compare, and write both side by side to
    /// DIR/compare: there without fades, gain and black, which the pictures that are sent keep.
    #[arg(long)]
    pub(super) compare: bool,
    #[command(flatten)]
    pub(super) eye: EyeArgs,
    /// Paint pixels of which Feline takes more than one sample.
    #[arg(long)]
    pub(super) show_anisotropy: bool,
    /// What draws.
    #[arg(long, value_enum, default_value = "gpu")]
    pub(super) renderer: RendererName,
    /// One JSON object on stdout.
    #[arg(long)]
    pub(super) json: bool,
}

/// How the two eyes' pictures lie in a source.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum StereoName {
    /// Both eyes see all of it.
    #[default]
    Mono,
    /// The left half is the left eye's.
    Sbs,
    /// The upper half is the left eye's.
    Tb,
}

impl WarpArgs {
    pub(super) fn check(&self) -> anyhow::Result<()> {
        if self.out.is_none() && !self.window {
            bail!(WrongUsage(
                "nothing says where panels are shown; give --out DIR for pictures, or --window"
                    .to_owned()
            ));
        }
        let others = [
            ("--compare", self.compare),
            ("--show-anisotropy", self.show_anisotropy),
            ("--mode seed", self.mode.is_some()),
        ];
        self.eye.check(self.filter_name(), others)?;
        if let Some(distance) = self.distance
            && !(0.05..=1e6).contains(&distance)
        {
            bail!(out_of_range(
                "--distance",
                distance,
                "0.05 to 1000000 metres"
            ));
        }
        if self.distance.is_some() && self.stereo != StereoName::Mono {
            bail!(WrongUsage(
                "--distance: each eye has its own picture, which shows how far things are; leave \
                 --stereo or --distance"
                    .to_owned()
            ));
        }
        Ok(())
    }

    /// Refuses to write a picture where the source or the rig lies.
    pub(super) fn spare_inputs(&self, panels: &[&Panel]) -> Result<(), WrongUsage> {
        let Some(out) = &self.out else {
            return Ok(());
        };
        let of_panel = |panel: &&Panel| [panel.id.clone(), panel.output.surface.clone()];
        let names = panels.iter().flat_map(of_panel).chain(["atlas".to_owned()]);
        for name in names {
            let once = out.join(format!("{name}.png"));
            let first = out.join(name).join("frame_00000.png");
            for picture in [once, first] {
                let read = [self.rig.rig.as_path(), Path::new(&self.source_name)];
                spare_inputs(&picture, read)?;
            }
        }
        Ok(())
    }

    pub(super) fn filter_name(&self) -> FilterName {
        self.filter.unwrap_or(match self.mode {
            Some(WarpModeName::Seed) => FilterName::Trilinear,
            None => FilterName::Auto,
        })
    }
}
