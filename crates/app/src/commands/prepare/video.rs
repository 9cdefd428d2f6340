//! How does a person turn a video into a pack?

use crate::commands::info::{CalibrationInfo, PackInfo};
use crate::options::codec::CodecOptions;
use crate::options::policy::{CutOptions, MappingName};
use crate::options::preset::SystemPreset;
use crate::report::output::{self, WrongUsage, out_of_range};
use crate::run::calibrate::{CalibrationExtent, calibrate};
use crate::run::kept_pack::{remark, warn};
use crate::run::loss::loss_of;
use crate::run::other_input::{no_video, refuse_pack};
use crate::run::pack_place::{if_taken, pack_at, refuse_name_of_another};
use crate::run::quantisers::with_quantisers;
use anyhow::{anyhow, bail};
use clap::{Args, ValueEnum};
use foveal_core::content::policy::DEFAULT_TARGET;
use foveal_core::content::video::bytes::description::Loss;
use foveal_core::content::video::calibration::Calibration;
use foveal_core::content::video::grid::tile_grid::GridError;
use foveal_core::units::counted;
use foveal_media::VideoInput;
use foveal_media::pack::name_claim::NameClaim;
use foveal_media::pack::pack_file::{PackFile, partial_path};
use foveal_media::prepare::{
    Event, PreparationPlan, PrepareError, PrepareSettings, ProjectionChoice, Quality, SpherePack,
    StereoChoice, Witness, pack_identity_of, prepare_resumable, rehearse,
};
use foveal_media::read::film::deinterlace::Deinterlace;
use foveal_media::tiles::encode_settings::Speed;
use indicatif::ProgressBar;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Instant;

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ProjectionName {
    Auto,
    Flat,
    Equirect,
    HalfEquirect,
    /// Faces in 3x2, 6x1 or 1x6, or in 4x1 without top and bottom.
    Cube,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum PackProjectionName {
    Cube,
    Equirect,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum StereoName {
    Auto,
    Mono,
    /// Side by side.
    Sbs,
    /// Top and bottom.
    Tb,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum DeinterlaceName {
    /// A picture of each frame, at the frame rate.
    Frames,
    /// A picture of each field, at twice the rate: motion stays as smooth as it was taken.
    Fields,
    /// Frames stay as they are, with combs where things move.
    Off,
}

/// How much of the content is judged for what `--target` chooses by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum CalibrateName {
    /// Nothing: targets are then met by constants that fit most content.
    Off,
    /// As much as about a minute of CPU time allows.
    Usual,
    /// Five gazes, all densities and bounds.
    Thorough,
}

impl CalibrateName {
    pub(crate) fn extent(self) -> Option<CalibrationExtent> {
        match self {
            Self::Off => None,
            Self::Usual => Some(CalibrationExtent::Usual),
            Self::Thorough => Some(CalibrationExtent::Thorough),
        }
    }
}

#[derive(Clone, Debug, Args)]
pub(crate) struct PrepareVideoArgs {
    /// Whatever FFmpeg reads: a video, or a picture, which EXIF may turn upright.
    input: PathBuf,
    /// The pack to write, with the ending .foveal; where it is there already, nothing is done.
    #[arg(long, value_name = "PACK")]
    out: Option<PathBuf>,
    /// How the picture surrounds the eye; auto goes by metadata, name and size, and says so.
    ///
    /// The metadata of a photo sphere (GPano) also say which part of the sphere a picture covers
    /// and where north is, which is then forward; any other choice than auto passes them over.
    ///
    /// Without metadata the size of one eye's picture decides, with the words of the name. 360°:
    /// exactly 2:1, and 360, pano, sphere or equirect in the name, or one of two eyes, or at least
    /// 3840 pixels wide. Two eyes may be squeezed: 1:1 or 4:1 with such a name, 4:1 also from 3840
    /// pixels on. 180°: 1:1, and 180 or vr180 in the name. Cube: a shape of --projection cube, and
    /// cube or the like of cube3x2 in the name, or 6:1 from 256 pixels high on. Else flat.
    #[arg(long, value_enum, default_value = "auto")]
    projection: ProjectionName,
    /// Where the pictures of two eyes lie; auto goes by metadata and name, and says so.
    ///
    /// Without metadata words of the name decide. Side by side: LR, SBS, HSBS, FSBS, 3DH, or RL
    /// with the right eye first; also 180 or vr180 in the name of a picture of 2:1. One above the
    /// other: TB, OU, HTB, HOU, 3DV, or BT with the right eye on top. Else one picture. By the size
    /// that each eye's picture then has, --projection finds whether it is 360°.
    #[arg(long, value_enum, default_value = "auto")]
    stereo: StereoName,
    /// What lies all around: how the pack shows it. A whole equirectangular picture keeps its
    /// pixels as they are; on a cube there are fewer, and none are crowded at the poles.
    #[arg(long, value_enum, value_name = "NAME", default_value = "cube")]
    pack_projection: PackProjectionName,
    /// 360°: how pixels lie over the faces of the cube (default: equi-angular, and what a preset
    /// has). Faces of an input that is a cube stay as they are.
    #[arg(long, value_enum)]
    mapping: Option<MappingName>,
    /// 360°: pixels on a side of a face, a multiple of 16 (default: a quarter of the width of the
    /// sphere).
    #[arg(long, value_name = "PX")]
    face_size: Option<u32>,
    #[command(flatten)]
    cut: CutOptions,
    /// Cut as a published system does.
    #[arg(long, value_enum, value_name = "NAME")]
    preset: Option<SystemPreset>,
    #[command(flatten)]
    codec: CodecOptions,
    /// Interlaced film: what becomes of the two fields of a frame.
    #[arg(long, value_enum, value_name = "NAME", default_value = "frames")]
    deinterlace: DeinterlaceName,
    /// Refuse what would be mended: damaged, missing or cut frames, broken tags, time stamps that
    /// fail to rise.
    #[arg(long)]
    strict: bool,
    /// Leave the sound out.
    #[arg(long)]
    no_sound: bool,
    /// Do not measure how far the finest level is from the source: PSNR, and the score at the worst
    /// of nine gazes.
    #[arg(long)]
    no_loss: bool,
    /// Test how the score falls as detail is dropped, and store it in the pack: what --target
    /// chooses by (about a minute of CPU time).
    #[arg(long, value_enum, value_name = "EXTENT", default_value = "usual")]
    calibrate: CalibrateName,
    /// Twice as fast, larger files.
    #[arg(long, conflicts_with = "small")]
    fast: bool,
    /// Twice as slow, smaller files.
    #[arg(long)]
    small: bool,
    /// Threads (default: all cores).
    #[arg(long, value_name = "N")]
    jobs: Option<usize>,
    /// Stop after this many frames.
    #[arg(long, value_name = "N")]
    frames: Option<u32>,
    /// Start over even if the same preparation was stopped before and could resume.
    #[arg(long)]
    no_resume: bool,
    /// Replace another pack at --out, which stays until the new one is whole.
    #[arg(long)]
    force: bool,
    /// Say what it would take in time and disk, and write nothing.
    #[arg(long)]
    dry_run: bool,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// What a dry run says.
#[derive(Debug, Serialize)]
struct Estimate {
    dry_run: bool,
    frames: Option<u64>,
    #[serde(rename = "prepare_s")]
    seconds: Option<f64>,
    bytes: Option<u64>,
    #[serde(rename = "prepare_s_per_frame")]
    seconds_per_frame: f64,
    bytes_per_frame: f64,
    warnings: Vec<String>,
    notes: Vec<String>,
}

/// Frames that a dry run codes: one group of the finest level.
const REHEARSED: u32 = 8;

/// What `--json` prints.
#[derive(Debug, Serialize)]
struct Done<'a> {
    #[serde(flatten)]
    pack: &'a PackInfo,
    /// Whether an earlier run had made it, so that nothing was written.
    already_there: bool,
    /// The share of the pixels that 9.5 JOD needs, and the rule that needs it; null where the
    /// content was not calibrated.
    target_pixels_share: Option<f64>,
    target_policy: Option<&'static str>,
    /// Seconds that judging it took.
    calibrate_s: f64,
}

pub(crate) fn run(args: &PrepareVideoArgs) -> anyhow::Result<()> {
    if args.dry_run {
        let plan = args.plan()?;
        remark(&args.input, &plan.remarks);
        let plan = with_quantisers(&args.input, plan, output::jobs(args.jobs)?)?;
        return args.estimate(&plan);
    }
    let out = args
        .out
        .as_deref()
        .ok_or_else(|| WrongUsage("--out PACK is missing: where should the pack go?".to_owned()))?;
    refuse_to_overwrite_input(&args.input, out)?;
    let there = pack_at(out)?;
    refuse_name_of_another(out)?;
    let plan = args.plan()?;
    if let Some(there) = there.as_ref().filter(|_| !args.force) {
        let pack = there.if_it_is(&pack_identity_of(&args.input, &plan)?)?;
        let text = format!(
            "{}: already exists, made from {} with the same options; nothing was written",
            out.display(),
            args.input.display()
        );
        return args.say_done(&pack, None, &text);
    }
    if out.extension().is_none_or(|ending| ending != "foveal") {
        let usual = "a pack usually ends in .foveal, by which it is found among other files";
        warn(out, &[usual.to_owned()]);
    }
    remark(&args.input, &plan.remarks);
    let said = [&plan.remarks.warnings[..], &plan.remarks.notes].concat();
    let begun = Instant::now();
    let claim = NameClaim::of(out, if_taken(there.as_ref()))?;
    let plan = with_quantisers(&args.input, plan, output::jobs(args.jobs)?)?;
    let calibrate_s = args.prepare((out, claim), &plan)?;
    let seconds = begun.elapsed().as_secs_f64();
    let pack = PackInfo::new(&PackFile::open(out)?)?;
    let text = format!(
        "{}: {seconds:.1} s
{}{}
",
        out.display(),
        pack.text_but(&said),
        pack.in_short()
    );
    args.say_done(&pack, Some(calibrate_s), &text)
}

impl PrepareVideoArgs {
    fn plan(&self) -> anyhow::Result<PreparationPlan> {
        let settings = self.settings()?;
        refuse_pack(&self.input)?;
        let input = VideoInput::open_with(&self.input, settings.reading());
        let input = input.map_err(|error| no_video(&self.input, error.into()))?;
        let info = input.info().clone();
        PreparationPlan::new(&self.input, &info, &settings).map_err(|error| match error {
            PrepareError::Grid(GridError::Size(..)) => {
                anyhow!("{}: {error}; make it smaller", self.input.display())
            }
            PrepareError::Grid(_) | PrepareError::FaceSize(_) => {
                WrongUsage(error.to_string()).into()
            }
            error => anyhow::Error::from(error),
        })
    }

    /// Makes the pack with a progress bar, and says what no plan could say.
    fn prepare(
        &self,
        (out, claim): (&Path, NameClaim),
        plan: &PreparationPlan,
    ) -> anyhow::Result<f64> {
        let mut guide = Guide {
            args: self,
            plan,
            out,
            bar: output::bar(plan.frames, output::Counting::Frames),
            jobs: output::jobs(self.jobs)?,
            has_begun: false,
            calibrate_s: 0.0,
        };
        let prepared = prepare_resumable(&self.input, claim, plan, !self.no_resume, &mut guide);
        guide.bar.finish_and_clear();
        let (has_begun, calibrate_s) = (guide.has_begun, guide.calibrate_s);
        let partial = partial_path(out);
        let prepared = prepared.map_err(|error| match has_begun && partial.exists() {
            true => anyhow!(
                "{}\n{} and its journal keep what is done: the same command resumes there, or \
                 starts over with a repaired input",
                output::told(&error.into()),
                partial.display()
            ),
            false => error.into(),
        })?;
        warn(&self.input, &prepared.warnings);
        Ok(calibrate_s)
    }

    /// Describes a pack; of one that is new, how long judging it took.
    fn say_done(&self, pack: &PackInfo, new: Option<f64>, text: &str) -> anyhow::Result<()> {
        let calibration = pack.calibration.as_ref();
        let at_target = calibration.and_then(CalibrationInfo::at_default_target);
        let text = match calibration.zip(at_target) {
            Some((calibration, (policy, share))) => format!(
                "{}\nfor {DEFAULT_TARGET} JOD {} auto chooses {policy}, with {:.1} % of the pixels",
                text.trim_end(),
                calibration.finest_view(pack.projection),
                100.0 * share.min(1.0)
            ),
            None => text.to_owned(),
        };
        let done = Done {
            pack,
            already_there: new.is_none(),
            target_pixels_share: at_target.map(|(_, share)| share),
            target_policy: at_target.map(|(policy, _)| policy),
            calibrate_s: new.unwrap_or(0.0),
        };
        output::result(self.json, &done, &text)
    }

    fn settings(&self) -> anyhow::Result<PrepareSettings> {
        if self.frames == Some(0) {
            bail!(out_of_range("--frames", 0, "at least 1"));
        }
        let given = || self.cut.clone();
        let cut = self
            .preset
            .map_or_else(given, |preset| preset.cut(&self.cut));
        Ok(PrepareSettings {
            projection: match self.projection {
                ProjectionName::Auto => ProjectionChoice::Auto,
                ProjectionName::Flat => ProjectionChoice::Flat,
                ProjectionName::Equirect => ProjectionChoice::Equirect,
                ProjectionName::HalfEquirect => ProjectionChoice::HalfEquirect,
                ProjectionName::Cube => ProjectionChoice::Cube,
            },
            stereo: match self.stereo {
                StereoName::Auto => StereoChoice::Auto,
                StereoName::Mono => StereoChoice::Mono,
                StereoName::Sbs => StereoChoice::SideBySide,
                StereoName::Tb => StereoChoice::TopBottom,
            },
            strict: self.strict,
            deinterlace: match self.deinterlace {
                DeinterlaceName::Frames => Deinterlace::Frames,
                DeinterlaceName::Fields => Deinterlace::Fields,
                DeinterlaceName::Off => Deinterlace::Off,
            },
            sound: !self.no_sound,
            pack_projection: match self.pack_projection {
                PackProjectionName::Cube => SpherePack::Cube,
                PackProjectionName::Equirect => SpherePack::Equirect,
            },
            mapping: match (self.preset, self.pack_projection) {
                (Some(preset), PackProjectionName::Cube) => Some(preset.mapping(self.mapping)),
                _ => self.mapping,
            }
            .map(MappingName::mapping),
            face_size: self.face_size,
            cut: cut.asked(),
            levels: cut.levels,
            ratio: cut.ratio(),
            codec: self.codec.codec,
            quality: Some(self.codec.quality()?),
            speed: match (self.fast, self.small) {
                (true, _) => Speed::Fast,
                (_, true) => Speed::Small,
                _ => Speed::Default,
            },
            jobs: output::jobs(self.jobs)?,
            most_frames: self.frames,
        })
    }

    fn estimate(&self, plan: &PreparationPlan) -> anyhow::Result<()> {
        let begun = Instant::now();
        let (rehearsed, bytes) = rehearse(&self.input, plan, REHEARSED)?;
        let seconds_per_frame = begun.elapsed().as_secs_f64() / f64::from(rehearsed);
        let bytes_per_frame = bytes as f64 / f64::from(rehearsed);
        let frames = match (plan.frames, self.frames) {
            (Some(known), Some(most)) => Some(known.min(u64::from(most))),
            (known, _) => known,
        };
        let estimate = Estimate {
            dry_run: true,
            frames,
            seconds: frames.map(|frames| frames as f64 * seconds_per_frame),
            bytes: frames.map(|frames| (frames as f64 * bytes_per_frame) as u64),
            seconds_per_frame,
            bytes_per_frame,
            warnings: plan.remarks.warnings.clone(),
            notes: plan.remarks.notes.clone(),
        };
        let more = match (self.codec.quality()?, self.calibrate.extent()) {
            (Quality::Auto, _) | (_, Some(_)) => {
                ", and one to two minutes of CPU time more to find its quality and calibrate it"
            }
            _ => "",
        };
        let all = match (estimate.seconds, estimate.bytes) {
            (Some(seconds), Some(bytes)) => {
                format!(
                    "about {:.1} MB, coded in about {seconds:.0} s{more}",
                    bytes as f64 / 1e6
                )
            }
            _ => format!("the number of frames is not known{more}"),
        };
        let by = match plan.is_still {
            true => "a picture".to_owned(),
            false => format!(
                "{:.1} ms and {:.1} kB a frame by {}",
                seconds_per_frame * 1e3,
                bytes_per_frame / 1e3,
                counted(rehearsed, "frame"),
            ),
        };
        let text = format!("{all}; {by} (nothing written)");
        output::result(self.json, &estimate, &text)
    }
}

/// What a preparation turns to.
struct Guide<'a> {
    args: &'a PrepareVideoArgs,
    plan: &'a PreparationPlan,
    out: &'a Path,
    bar: ProgressBar,
    jobs: usize,
    has_begun: bool,
    calibrate_s: f64,
}

impl Witness for Guide<'_> {
    fn tell(&mut self, event: Event) {
        match event {
            Event::Begins(note) => output::say(&format!("{}: {note}", self.out.display())),
            Event::Progress(progress) => {
                self.has_begun = true;
                self.bar.set_position(u64::from(progress.frames));
            }
        }
    }

    fn loss_of(&mut self, pack: &Path) -> Option<Loss> {
        let input = &self.args.input;
        self.bar.finish_and_clear();
        if self.args.no_loss {
            return None;
        }
        let loss = loss_of(input, pack, self.plan, self.jobs);
        // The pack is good, even where its loss cannot be measured.
        loss.unwrap_or_else(|error| {
            let why = output::told(&error);
            let text = format!("what preparing lost cannot be measured: {why}");
            warn(input, &[text]);
            None
        })
    }

    fn calibration_of(&mut self, pack: &Path) -> Option<Calibration> {
        let extent = self.args.calibrate.extent()?;
        let input = &self.args.input;
        output::say(&format!(
            "{}: tests how the score falls as detail is dropped, which takes about a minute of \
             CPU time (--calibrate off skips it)",
            input.display()
        ));
        let begun = Instant::now();
        let found = calibrate(pack, extent, self.jobs);
        self.calibrate_s = begun.elapsed().as_secs_f64();
        let found = match found {
            Ok(Some(found)) => found,
            Ok(None) => {
                let text = "its pictures are too small for a score, so it is not calibrated";
                output::say(&format!("{}: {text}", input.display()));
                return None;
            }
            Err(error) => {
                let why = output::told(&error);
                warn(input, &[format!("the pack cannot be calibrated: {why}")]);
                return None;
            }
        };
        if let Some(left_out) = found.left_out {
            output::say(&format!("{}: {left_out}", input.display()));
        }
        Some(found.calibration)
    }
}

/// Writing the pack over its own source, or growing it there, would destroy the source.
fn refuse_to_overwrite_input(input: &Path, out: &Path) -> anyhow::Result<()> {
    let is_input = |path: &Path| match (input.canonicalize(), path.canonicalize()) {
        (Ok(input), Ok(path)) => input == path,
        _ => false,
    };
    if is_input(out) || is_input(&partial_path(out)) {
        bail!(WrongUsage(format!(
            "--out {}: it is the input itself, or grows where that lies; choose another name",
            out.display()
        )));
    }
    Ok(())
}
