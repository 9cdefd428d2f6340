//! How is the video that a pack was made from shown without loss, to judge against?

use crate::evaluate::trial::Scratch;
use crate::output::{self, Counting, WrongUsage};
use anyhow::{Context, bail};
use foveal_core::asset::codec::Codec;
use foveal_core::asset::pack::Description;
use foveal_core::units::counted;
use foveal_media::pack_file::PackFile;
use foveal_media::prepare::{
    Plan, PrepareSettings, Progress, ProjectionChoice, StereoChoice, prepare,
};
use foveal_media::{SourceInfo, VideoInput};
use std::path::Path;
use std::sync::Arc;

/// The video that a pack was made from.
pub(super) struct Original {
    /// Its first frames, cut like the pack, every sample kept.
    pub(super) file: Arc<PackFile>,
    pub(super) bytes: u64,
    /// Frames as far as its container tells.
    pub(super) frames: Option<u64>,
}

/// How far rates may lie apart: containers round them.
const RATE_TOLERANCE: f64 = 1e-3;

/// Prepares the first `frames` frames of `source`, of which `pack` was made; refuses another video.
pub(super) fn original(
    source: &Path,
    pack: &PackFile,
    frames: u32,
    scratch: &Scratch,
) -> anyhow::Result<Original> {
    let info = VideoInput::open(source)?.info().clone();
    let about = pack.pack().description();
    let plan = plan_like(source, &info, about, frames).filter(|_| is_of(&info, about));
    let Some(plan) = plan else {
        let (file, source) = (pack.path().display(), source.display());
        bail!(WrongUsage(format!(
            "--source {source}: has {}, and {file} was made from {}; give the video that the pack \
             was made from",
            told_of(&info),
            told(about),
        )));
    };
    output::say(&format!(
        "{}: is being prepared without loss",
        source.display()
    ));
    let to = scratch.0.join("source.foveal");
    let bar = output::bar(Some(u64::from(frames)), Counting::Frames);
    let mut note = |progress: Progress| bar.set_position(u64::from(progress.frames));
    let prepared = prepare(source, &to, &plan, &mut note);
    bar.finish_and_clear();
    let found = prepared.with_context(|| format!("--source {}", source.display()))?;
    let found = found.description.frames;
    if found < frames {
        bail!(WrongUsage(format!(
            "--source {}: has {}, and {frames} of {} are to be played; give the video that the \
             pack was made from",
            source.display(),
            counted(found, "frame"),
            pack.path().display()
        )));
    }
    Ok(Original {
        file: Arc::new(PackFile::open(&to)?),
        bytes: info.bytes,
        frames: info.frames,
    })
}

/// Whether a pack may be of a video: of the same size and rate, and as long, or of its beginning.
fn is_of(info: &SourceInfo, about: &Description) -> bool {
    let rate = rate_of(info) / about.fps();
    let same_file = info.bytes == about.source.bytes;
    // What containers tell of their length is an estimate.
    let as_long = info.frames.is_none_or(|frames| {
        let pack = u64::from(about.frames);
        frames + 1 >= pack && (same_file || frames <= pack + 1)
    });
    [info.width, info.height] == about.source.size && (rate - 1.0).abs() < RATE_TOLERANCE && as_long
}

/// The preparation that makes faces like those of a pack, which does not tell how the video
/// surrounds the eyes; none where no projection does.
fn plan_like(source: &Path, info: &SourceInfo, about: &Description, frames: u32) -> Option<Plan> {
    let projections = [
        ProjectionChoice::Auto,
        ProjectionChoice::Flat,
        ProjectionChoice::Equirect,
        ProjectionChoice::HalfEquirect,
        ProjectionChoice::Cube,
    ];
    let stereo = [
        StereoChoice::Auto,
        StereoChoice::Mono,
        StereoChoice::SideBySide,
        StereoChoice::TopBottom,
    ];
    let choices = projections
        .into_iter()
        .flat_map(|projection| stereo.map(|stereo| (projection, stereo)));
    let plans = choices.filter_map(|(projection, stereo)| {
        let settings = PrepareSettings {
            projection,
            stereo,
            sound: false,
            cut: Some(about.cut),
            levels: Some(about.levels),
            ratio: about.ratio,
            codec: Codec::Png,
            jobs: output::jobs(None).unwrap_or(1),
            most_frames: Some(frames),
            ..PrepareSettings::default()
        };
        Plan::new(source, info, &settings).ok()
    });
    plans.into_iter().find(|plan| {
        let of = |about: &Description| {
            (
                about.projection,
                about.size,
                about.eyes,
                about.cube_faces,
                about.pixel_aspect,
            )
        };
        of(&plan.description) == of(about)
    })
}

fn rate_of(info: &SourceInfo) -> f64 {
    let [frames, seconds] = info.frame_rate.map(f64::from);
    frames / seconds
}

fn told_of(info: &SourceInfo) -> String {
    let frames = info
        .frames
        .map_or(String::new(), |n| format!(", {}", counted(n, "frame")));
    let (width, height, rate) = (info.width, info.height, rate_of(info));
    format!("{width}x{height} pixels at {rate:.3} frames a second{frames}")
}

fn told(about: &Description) -> String {
    let [width, height] = about.source.size;
    let (rate, frames) = (about.fps(), counted(about.frames, "frame"));
    let projection = format!("{:?}", about.projection).to_lowercase();
    format!("{width}x{height} pixels at {rate:.3} frames a second, {frames}, {projection}")
}
