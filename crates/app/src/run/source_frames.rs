//! What does a view show of the source that a pack was made from, at the time of a frame?

use crate::report::output::{self, WrongUsage};
use anyhow::bail;
use foveal_core::content::video::bytes::description::Description;
use foveal_core::units::counted;
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::picture::Picture;
use foveal_core::view::surface::{Projection, Screen};
use foveal_eval::score::ScorePicture;
use foveal_media::pack::pack_file::PackFile;
use foveal_media::prepare::{
    PreparationPlan as Plan, PrepareSettings, ProjectionChoice, SpherePack, StereoChoice,
};
use foveal_media::read::film::deinterlace::Deinterlace;
use foveal_media::{ReadOptions, SourceInfo, SourceView, VideoInput};
use std::path::{Path, PathBuf};

/// A source that is read on from frame to frame.
pub(crate) struct SourceFrames {
    source: PathBuf,
    pack: PathBuf,
    input: VideoInput,
    view: SourceView,
    /// When the pack shows its frames.
    times_ns: Vec<i64>,
    /// The frame that was read last.
    last: Option<Picture>,
    read: u32,
    jobs: usize,
}

/// How far rates may lie apart: containers round them.
const RATE_TOLERANCE: f64 = 1e-3;

impl SourceFrames {
    /// The source of a pack, whose flat content fills `screen`; refuses another video.
    pub(crate) fn open(source: &Path, pack: &PackFile, screen: Screen) -> anyhow::Result<Self> {
        let about = pack.pack().description();
        let reading = reading_like(source, about)?;
        let input = VideoInput::open_with(source, reading)?;
        let info = input.info();
        let plan = plan_like((source, reading), info, about).filter(|_| is_of(info, about));
        let Some(plan) = plan else {
            bail!(WrongUsage(format!(
                "{}: has {}, and {} was made from {}; give the file that it was made from",
                source.display(),
                told_of(info),
                pack.path().display(),
                told(about),
            )));
        };
        Self::planned(source, pack, &plan, screen, output::jobs(None)?)
    }

    /// The source of a pack that was just made as planned.
    pub(crate) fn planned(
        source: &Path,
        pack: &PackFile,
        plan: &Plan,
        screen: Screen,
        jobs: usize,
    ) -> anyhow::Result<Self> {
        let input = VideoInput::open_with(source, plan.reading)?;
        Ok(Self {
            source: source.to_owned(),
            pack: pack.path().to_owned(),
            view: SourceView::new(plan, input.info(), screen),
            times_ns: pack.frame_times()?,
            input,
            last: None,
            read: 0,
            jobs,
        })
    }

    /// What is known of the file.
    pub(crate) fn info(&self) -> &SourceInfo {
        self.input.info()
    }

    /// What views show of a frame; frames must not go back.
    pub(crate) fn seen(
        &mut self,
        frame: u32,
        views: &[EyeView],
    ) -> anyhow::Result<Vec<ScorePicture>> {
        while self.read <= frame {
            self.last = Some(self.next()?);
        }
        let Some(picture) = self.last.as_ref().filter(|_| self.read == frame + 1) else {
            bail!("{}: frame {frame} was passed", self.source.display());
        };
        let picture = self.view.of(picture);
        let seen = views.iter().map(|view| {
            let rgb = picture.seen(view, self.jobs);
            Ok(ScorePicture::from_rgb8(view.size, rgb)?)
        });
        seen.collect()
    }

    /// The next frame, which must be that of the pack.
    fn next(&mut self) -> anyhow::Result<Picture> {
        let number = self.read;
        let other = |what: String| {
            let (source, pack) = (self.source.display(), self.pack.display());
            WrongUsage(format!(
                "{source}: {what} {pack}; give the file that it was made from"
            ))
        };
        let Some(frame) = self.input.next_frame()? else {
            let (ends, wanted) = (counted(number, "frame"), self.times_ns.len());
            bail!(other(format!(
                "ends after {ends}, and there are {wanted} in"
            )));
        };
        let expected = self.times_ns.get(number as usize);
        if expected.is_some_and(|time| *time != frame.time_ns) {
            let [found, expected] = [Some(&frame.time_ns), expected]
                .map(|time| time.map_or(0.0, |ns| *ns as f64 / 1e9));
            bail!(other(format!(
                "shows frame {number} after {found:.6} s, not after {expected:.6} s as"
            )));
        }
        self.read += 1;
        Ok(frame.picture)
    }
}

/// How the source of a pack is read so that its frames are the pack's: film that was deinterlaced
/// is counted in it, with twice the rate where each field became a picture.
fn reading_like(source: &Path, about: &Description) -> anyhow::Result<ReadOptions> {
    let of = |deinterlace| ReadOptions {
        deinterlace,
        ..ReadOptions::default()
    };
    if !about.repairs.contains_key("deinterlaced_frames") {
        return Ok(of(Deinterlace::Off));
    }
    let frames = VideoInput::open_with(source, of(Deinterlace::Frames))?;
    let is_of_fields = about.fps() > 1.5 * rate_of(frames.info());
    Ok(of(match is_of_fields {
        true => Deinterlace::Fields,
        false => Deinterlace::Frames,
    }))
}

/// Whether a pack may be of a video: of the same size and rate, and as long, or of its beginning.
fn is_of(info: &SourceInfo, about: &Description) -> bool {
    let rate = rate_of(info) / about.fps();
    let same_file = info.bytes == about.source.bytes;
    // The length that containers give is an estimate.
    let as_long = info.frames.is_none_or(|frames| {
        let pack = u64::from(about.frames);
        frames + 1 >= pack && (same_file || frames <= pack + 1)
    });
    [info.width, info.height] == about.source.size && (rate - 1.0).abs() < RATE_TOLERANCE && as_long
}

/// The preparation that makes faces like those of a pack, which does not say how the video
/// surrounds the eyes; none where no projection does. Faces of another size are those of another
/// way to make them.
fn plan_like(
    (source, reading): (&Path, ReadOptions),
    info: &SourceInfo,
    about: &Description,
) -> Option<Plan> {
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
    let pack_projection = match about.projection {
        Projection::Equirect => SpherePack::Equirect,
        Projection::Flat | Projection::Cube => SpherePack::Cube,
    };
    let choices = projections
        .into_iter()
        .flat_map(|projection| stereo.map(|stereo| (projection, stereo)));
    let plans = choices.filter_map(|(projection, stereo)| {
        let settings = PrepareSettings {
            projection,
            stereo,
            pack_projection,
            cut: Some(about.cut),
            levels: Some(about.levels),
            ratio: about.ratio,
            codec: about.codec,
            deinterlace: reading.deinterlace,
            ..PrepareSettings::default()
        };
        Plan::new(source, info, &settings).ok()
    });
    let surrounds = |about: &Description| {
        let Description {
            projection, eyes, ..
        } = *about;
        (projection, eyes, about.cube_faces, about.pixel_aspect)
    };
    let alike: Vec<Plan> = plans
        .filter(|plan| surrounds(&plan.description) == surrounds(about))
        .collect();
    let same = alike
        .iter()
        .find(|plan| plan.description.size == about.size);
    let sphere = || {
        let is_sphere = about.projection.surrounds();
        alike.first().filter(|_| is_sphere)
    };
    same.or_else(sphere).cloned()
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
