//! How good does one picture or video look beside another, to an eye that looks at a place in it?

mod conditions;
mod engine;
mod folder;
mod frames;
mod heat;
mod of_source;
mod pack_frames;
mod pairs;
mod picture;
mod report;

use crate::options::policy::{PolicyName, PolicyOptions, ViewOptions};
use crate::report::output::{self, Counting, WrongUsage};
use anyhow::{Context, bail};
use clap::{Args, ValueEnum};
pub(crate) use conditions::{DeviceName, ModeName};
use conditions::{GazeOnPicture, GazeWords, fps_of, gaze_of, parse_gaze_words};
use engine::Frame;
pub(crate) use engine::{Companions, Engine};
use foveal_core::units::counted;
use foveal_eval::score::companion::{Companion, CompanionJudge};
use foveal_eval::score::{Display, Viewing};
use frames::{Frames, Opening, is_pack};
use heat::write_heat;
use of_source::PackOfSource;
pub(crate) use pack_frames::{LastGaze, display_of_view, picture_of};
pub(crate) use picture::{from_image, read_picture};
use report::Single;
pub(crate) use report::{Conditions, Report};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// A measure by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum MetricName {
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
    fn companion(self) -> Option<Companion> {
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
/// Without --gaze nobody looks at a place, and eccentricity does not count.
#[derive(Clone, Debug, Args)]
pub(crate) struct ScoreArgs {
    /// A picture, a folder of numbered pictures, a video or a pack: what should be seen. Before a
    /// pack, a file is what it was made from, and is seen in the same views.
    #[arg(required_unless_present_any = ["pairs", "list_displays", "cite"])]
    reference: Option<PathBuf>,
    /// The same in the same size: what is seen.
    #[arg(required_unless_present_any = ["pairs", "list_displays", "cite"])]
    test: Option<PathBuf>,
    /// What shows it (default, of packs alone: the view itself): standard_4k, standard_fhd,
    /// standard_hmd, standard_phone, standard_hdr_pq, sdr_4k_30, sdr_fhd_24, htc_vive_pro,
    /// iphone_12_pro, ipad_pro_12_9, macbook_pro_16, lg_oled_2017_sdr, lg_oled_2017_hdr, or a file
    /// that describes it.
    #[arg(long, value_name = "NAME|FILE.toml")]
    display: Option<String>,
    /// Where the eye looks, in the picture or beside it: pixels from the middle of the first one,
    /// to the right and down, or center. Of a pack beside its source, as in `simulate`: YAW,PITCH
    /// in degrees, center, scan, trace:FILE or head:FILE.
    #[arg(long, value_name = "X,Y", value_parser = parse_gaze_words, allow_hyphen_values = true)]
    #[arg(conflicts_with = "gaze_trace")]
    gaze: Option<GazeWords>,
    /// The same frame by frame: CSV with frame,x_px,y_px.
    #[arg(long, value_name = "FILE.csv")]
    gaze_trace: Option<PathBuf>,
    /// What is measured.
    #[arg(long, value_enum, default_value = "fovvideovdp")]
    metric: MetricName,
    /// As published, to compare with published scores, or right where that slips.
    #[arg(long, value_enum, default_value = "compat")]
    mode: ModeName,
    /// Stop after this many frames (default: all).
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    frames: Option<u32>,
    /// Write what is lost at every pixel, the mean over all frames: as a picture, or where the name
    /// ends in .npy as numbers, JOD as float32 by rows and columns.
    #[arg(long, value_name = "OUT.png|OUT.npy")]
    heat: Option<PathBuf>,
    /// What computes.
    #[arg(long, value_enum, default_value = "cpu")]
    device: DeviceName,
    /// Threads (default: all cores).
    #[arg(long, value_name = "N")]
    jobs: Option<usize>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
    /// Frames a second (default: the video's; folders need it).
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    #[arg(help_heading = "Pictures and videos")]
    fps: Option<f64>,
    /// Score every row of a table: CSV with reference,test and as wanted gaze_x,gaze_y,gaze_trace,
    /// display, which go before the options; other columns are kept. Files are named from where the
    /// table lies.
    #[arg(
        long,
        value_name = "FILE.csv",
        requires = "out",
        help_heading = "Many pairs"
    )]
    #[arg(conflicts_with_all = ["reference", "test", "heat"])]
    pairs: Option<PathBuf>,
    /// The same table with jod (or value) and under which conditions, or in column error why not.
    #[arg(
        long,
        value_name = "FILE.csv",
        requires = "pairs",
        help_heading = "Many pairs"
    )]
    out: Option<PathBuf>,
    /// List the displays that have names, with their figures.
    #[arg(long, conflicts_with = "pairs", help_heading = "In place of a score")]
    list_displays: bool,
    /// Print version, parameters and paper, ready for a methods section.
    #[arg(long, conflicts_with_all = ["list_displays", "pairs"])]
    #[arg(help_heading = "In place of a score")]
    cite: bool,
    /// The policy that the first of two packs is played under.
    #[arg(long, value_enum, default_value = "full", help_heading = PACKS)]
    reference_policy: PolicyName,
    #[command(flatten, next_help_heading = PACKS)]
    policy: PolicyOptions,
    #[command(flatten, next_help_heading = PACKS)]
    view: ViewOptions,
    /// Seed of the scan path.
    #[arg(long, default_value_t = 1, help_heading = PACKS)]
    seed: u64,
}

/// What stands above the options that pictures and videos do not go by.
const PACKS: &str = "Packs alone";

pub(crate) fn run(args: &ScoreArgs) -> anyhow::Result<()> {
    if args.list_displays {
        let list = report::displays();
        return output::result(args.json, &list.0, &list.1);
    }
    if args.cite {
        let cited = report::citation();
        return output::result(args.json, &cited.0, &cited.1);
    }
    if let (Some(pairs), Some(out)) = (&args.pairs, &args.out) {
        let scored = pairs::score_pairs(args, pairs, out)?;
        return output::result(args.json, &scored, &scored.text());
    }
    let (Some(reference), Some(test)) = (&args.reference, &args.test) else {
        bail!(WrongUsage("give REFERENCE and TEST".to_owned()));
    };
    if args.out.is_some() {
        let text = "--out is for a table of pairs; give --pairs FILE.csv, or leave it";
        bail!(WrongUsage(text.to_owned()));
    }
    if let Some(heat) = &args.heat {
        output::spare_inputs(heat, [reference.as_path(), test.as_path()])?;
        heat::check_name(heat)?;
    }
    match args.score(reference, test)? {
        Judged::ByEye(report) => output::result(args.json, &*report, &report.text()),
        Judged::By(single) => output::result(args.json, &single, &single.text()),
    }
}

/// What takes in a frame, and what hands over all of them.
type TakeFrame<'a> = dyn FnMut(Frame) -> anyhow::Result<()> + 'a;
type EachFrame<'a> = dyn FnMut(&mut TakeFrame<'_>) -> anyhow::Result<()> + 'a;

/// What is said of a pair.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
enum Judged {
    ByEye(Box<Report>),
    By(Single),
}

impl ScoreArgs {
    fn score(&self, reference: &Path, test: &Path) -> anyhow::Result<Judged> {
        if is_pack(test) && !is_pack(reference) && !reference.is_dir() {
            return self.score_of_source(reference, test);
        }
        let mut pair = self.open(reference, test)?;
        let size = pair.0.size;
        let gaze = gaze_of(self.gaze.as_ref(), self.gaze_trace.as_deref())?;
        let fps = fps_of(self.fps, [&pair.0, &pair.1])?;
        let own = pair.0.display.clone();
        let display = conditions::display_of("--display", self.display.as_deref(), own)?;
        conditions::check_hdr(&display, [&pair.0, &pair.1])?;
        let foveated = gaze.is_some();
        let viewing = Viewing::new(display, size, fps, foveated, self.mode.mode())
            .with_context(|| reference.display().to_string())?;
        let name = gaze.as_ref().map(GazeOnPicture::source);
        self.judge(&viewing, name, &mut |take| {
            self.each_frame(&mut pair, &viewing, gaze.as_ref(), take)
        })
    }

    /// Scores a pack that is played as `simulate` does against the same views of its source.
    fn score_of_source(&self, source: &Path, pack: &Path) -> anyhow::Result<Judged> {
        let (name, trace) = (pack.display(), self.gaze_trace.is_some());
        let Some(gaze) = self.gaze.as_ref().filter(|_| !trace) else {
            bail!(WrongUsage(format!(
                "{name}: levels of a pack are chosen for its viewer's gaze; give --gaze \
                 YAW,PITCH, center, scan, trace:FILE or head:FILE"
            )));
        };
        if self.fps.is_some() {
            bail!(WrongUsage(format!(
                "--fps: {name} and its source tell their rate; leave it out"
            )));
        }
        let look = (gaze, self.seed);
        let opening = self.opening(None);
        let mut played = PackOfSource::open(source, pack, &opening, look, self.frames)?;
        let own = Some(played.display());
        let display = conditions::display_of("--display", self.display.as_deref(), own)?;
        let mode = self.mode.mode();
        let viewing = Viewing::new(display, played.size(), played.fps(), true, mode)
            .with_context(|| name.to_string())?;
        let judged = gaze.of_viewer()?.as_judged();
        self.judge(&viewing, Some(judged), &mut |take| {
            let bar = output::bar(Some(u64::from(played.frames())), Counting::Frames);
            while let Some(frame) = played.next()? {
                take(frame)?;
                bar.inc(1);
            }
            bar.finish_and_clear();
            played.tell_unseen();
            Ok(())
        })
    }

    fn judge(
        &self,
        viewing: &Viewing,
        gaze: Option<String>,
        frames: &mut EachFrame<'_>,
    ) -> anyhow::Result<Judged> {
        match self.metric.companion() {
            None => self.score_by_eye(viewing, gaze, frames),
            Some(companion) => self.score_by(companion, viewing, gaze, frames),
        }
    }

    /// How packs are played, under a policy in the place of that of the options.
    fn opening(&self, policy: Option<PolicyName>) -> Opening {
        Opening {
            policy: policy.map_or_else(|| self.policy.clone(), |name| self.policy.named(name)),
            view: self.view.clone(),
            jobs: self.jobs,
            needs_gaze: self.gaze.is_none() && self.gaze_trace.is_none(),
        }
    }

    fn open(&self, reference: &Path, test: &Path) -> anyhow::Result<(Frames, Frames)> {
        let reference = Frames::open(reference, &self.opening(Some(self.reference_policy)))?;
        let test = Frames::open(test, &self.opening(None))?;
        if test.size != reference.size {
            let ([a, b], [c, d]) = (reference.size, test.size);
            let name = test.name.display();
            bail!("{name}: {c}x{d} pixels where the reference has {a}x{b}; bring both to one size");
        }
        if let (Some(wanted), Some(found)) = (reference.frames, test.frames)
            && self.frames.is_none()
            && wanted != found
            && reference.is_exact
            && test.is_exact
        {
            let name = test.name.display();
            let found = counted(found, "frame");
            bail!("{name}: has {found} where the reference has {wanted}; give --frames N");
        }
        Ok((reference, test))
    }

    fn score_by_eye(
        &self,
        viewing: &Viewing,
        gaze: Option<String>,
        frames: &mut EachFrame<'_>,
    ) -> anyhow::Result<Judged> {
        let mut engine = Engine::open(self.device, viewing, output::jobs(self.jobs)?)?;
        if self.heat.is_some() {
            engine.keep_heat()?;
        }
        let mut companions = Companions::beside(viewing)?;
        frames(&mut |frame| {
            companions.frame(&frame.reference, &frame.test, frame.gaze_px)?;
            engine.frame(&frame.reference, &frame.test, frame.gaze_px)
        })?;
        let score = engine.score()?;
        if let (Some(path), Some(heat)) = (&self.heat, engine.heat()?) {
            write_heat(path, &heat)?;
        }
        let report = Report::judged(viewing, self.mode.mode(), gaze, score).with(
            companions.totals(),
            engine.name(),
            self.heat.clone(),
        );
        Ok(Judged::ByEye(Box::new(report)))
    }

    fn score_by(
        &self,
        companion: Companion,
        viewing: &Viewing,
        gaze: Option<String>,
        frames: &mut EachFrame<'_>,
    ) -> anyhow::Result<Judged> {
        if self.heat.is_some() {
            bail!(WrongUsage(
                "--heat: only fovvideovdp tells where; leave --metric".to_owned()
            ));
        }
        let mut judge = CompanionJudge::new(companion, viewing).context("--metric")?;
        let mut per_frame = Vec::new();
        frames(&mut |frame| {
            per_frame.push(judge.frame(&frame.reference, &frame.test, frame.gaze_px)?);
            Ok(())
        })?;
        let measure = (companion, self.mode.mode());
        let single = Single::new(measure, viewing, gaze, judge.total(), per_frame);
        Ok(Judged::By(single))
    }

    /// Reads both to their end, frame by frame.
    fn each_frame(
        &self,
        (reference, test): &mut (Frames, Frames),
        viewing: &Viewing,
        gaze: Option<&GazeOnPicture>,
        take: &mut TakeFrame<'_>,
    ) -> anyhow::Result<()> {
        let most = self.frames.unwrap_or(u32::MAX);
        let length = reference.frames.map(|frames| frames.min(u64::from(most)));
        let names = [reference.name.clone(), test.name.clone()];
        let bar = output::bar(length, Counting::Frames);
        for number in 0..most {
            // A trace may end where the pictures do: it is asked when there is a picture.
            let gaze_px = || match gaze {
                Some(gaze) => gaze.at(number, viewing.size),
                None => Ok([0.0; 2]),
            };
            let both = (reference.next(gaze_px)?, test.next(gaze_px)?);
            let (reference, test) = match both {
                (Some(reference), Some(test)) => (reference, test),
                (None, None) if number > 0 => break,
                (longer, _) => {
                    let (name, other) = match longer {
                        Some(_) => (&names[1], &names[0]),
                        None => (&names[0], &names[1]),
                    };
                    bail!(
                        "{}: ends after {}, {} goes on; give --frames {}",
                        name.display(),
                        counted(number, "frame"),
                        other.display(),
                        number.max(1)
                    );
                }
            };
            take(Frame {
                reference,
                test,
                gaze_px: gaze_px()?,
            })?;
            bar.inc(1);
        }
        bar.finish_and_clear();
        Ok(())
    }
}

/// A named display, or the one that a file describes, as an `option` chose it.
pub(crate) fn display_named(option: &str, choice: &str) -> anyhow::Result<Display> {
    conditions::display_of(option, Some(choice), None)
}
