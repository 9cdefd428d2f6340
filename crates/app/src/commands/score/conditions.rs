//! Who looks at what, from where?

use crate::commands::score::frames::Frames;
use crate::gaze_source::{GazeChoice, parse_gaze};
use crate::options::policy::parse_pair;
use crate::report::output::{WrongUsage, out_of_range, read_settings, read_text};
use anyhow::{Context, bail};
use clap::ValueEnum;
use foveal_core::units::counted;
use foveal_eval::score::display::{DisplayFile, Transfer};
use foveal_eval::score::gaze_trace::GazeTrace;
use foveal_eval::score::named_displays::NamedDisplay;
use foveal_eval::score::{Display, Mode};
use std::path::{Path, PathBuf};
use std::sync::Arc;

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ModeName {
    /// As the published package computes.
    Compat,
    /// Right where that one slips: borders, angles, the frame's real size, times.
    Strict,
}

impl ModeName {
    pub(crate) fn mode(self) -> Mode {
        match self {
            Self::Compat => Mode::Compat,
            Self::Strict => Mode::Strict,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum DeviceName {
    /// All cores.
    Cpu,
    /// The GPU, or a software Vulkan driver in its place: within 0.005 JOD.
    Gpu,
}

/// Where in the pictures an eye looks.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum GazeOnPicture {
    /// At the middle.
    Centre,
    /// At one place.
    At([f64; 2]),
    /// As a file says.
    Trace(PathBuf, Arc<GazeTrace>),
}

/// What `--gaze` was given: of pictures and packs a place in pixels, of a pack against its source
/// where its viewer looks.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct GazeWords(String);

/// Reads the value of `--gaze`.
pub(super) fn parse_gaze_words(text: &str) -> anyhow::Result<GazeWords> {
    let is_known = on_picture(text).is_some() || parse_gaze(text).is_ok();
    is_known
        .then(|| GazeWords(text.to_owned()))
        .with_context(|| {
            format!("expected {ON_PICTURE}; for a pack against its source {OF_VIEWER}")
        })
}

const ON_PICTURE: &str = "two finite numbers of pixels as 10,-5, or center";
const OF_VIEWER: &str = "YAW,PITCH in degrees, center, scan, trace:FILE or head:FILE";

fn on_picture(text: &str) -> Option<GazeOnPicture> {
    match text {
        "center" | "centre" => Some(GazeOnPicture::Centre),
        _ => parse_pair(text).ok().map(GazeOnPicture::At),
    }
}

impl GazeWords {
    /// A place in pixels.
    pub(super) fn at([x, y]: [f64; 2]) -> Self {
        Self(format!("{x},{y}"))
    }

    /// The place in a picture.
    fn on_picture(&self) -> anyhow::Result<GazeOnPicture> {
        let place = on_picture(&self.0);
        place.ok_or_else(|| out_of_range("--gaze", &self.0, ON_PICTURE).into())
    }

    /// Where the viewer of a pack looks.
    pub(super) fn of_viewer(&self) -> anyhow::Result<GazeChoice> {
        match parse_gaze(&self.0) {
            Ok(GazeChoice::Live(_)) | Err(_) => {
                bail!(out_of_range("--gaze", &self.0, OF_VIEWER))
            }
            Ok(choice) => Ok(choice),
        }
    }
}

/// The gaze that was asked for.
pub(super) fn gaze_of(
    gaze: Option<&GazeWords>,
    trace: Option<&Path>,
) -> anyhow::Result<Option<GazeOnPicture>> {
    let Some(path) = trace else {
        return gaze.map(GazeWords::on_picture).transpose();
    };
    let text = read_text(path, "a gaze trace")?;
    let trace = GazeTrace::parse(&text).with_context(|| path.display().to_string())?;
    Ok(Some(GazeOnPicture::Trace(path.to_owned(), Arc::new(trace))))
}

impl GazeOnPicture {
    /// Where the eye looks in a frame of pictures of `size`, or outside it.
    pub(crate) fn at(&self, frame: u32, size: [u32; 2]) -> anyhow::Result<[f64; 2]> {
        match self {
            // As the published package: the pixel after the middle.
            Self::Centre => Ok(size.map(|side| f64::from(side / 2))),
            Self::At(place) => Ok(*place),
            Self::Trace(path, trace) => trace.at(frame).with_context(|| {
                format!(
                    "{}: no row for frame {frame}; give a row for every frame, or --frames N",
                    path.display()
                )
            }),
        }
    }

    /// What results call it.
    pub(super) fn source(&self) -> String {
        match self {
            Self::Centre => "center".to_owned(),
            Self::At([x, y]) => format!("{x},{y}"),
            Self::Trace(path, _) => format!("trace:{}", path.display()),
        }
    }
}

/// The display that `option` asked for, or else `own`.
pub(super) fn display_of(
    option: &str,
    choice: Option<&str>,
    own: Option<Display>,
) -> anyhow::Result<Display> {
    let Some(choice) = choice else {
        return own.ok_or_else(|| {
            let names = Display::names().join(", ");
            let text =
                format!("{option} is missing; give one of {names}, or a file that describes it");
            WrongUsage(text).into()
        });
    };
    if let Some(named) = NamedDisplay::find(choice) {
        return match named.refused {
            None => Ok(named.display),
            Some(why) => bail!(WrongUsage(format!("{option} {choice}: {why}"))),
        };
    }
    let path = Path::new(choice);
    if !path.exists() {
        let names = Display::names().join(", ");
        bail!(out_of_range(
            option,
            choice,
            &format!("{names}, or a file that is there")
        ));
    }
    let text = read_settings(path, "a display")?;
    let file: DisplayFile = toml::from_str(&text).with_context(|| choice.to_owned())?;
    file.display().with_context(|| choice.to_owned())
}

/// Frames a second of both: what was asked for, what the files say, or none for stills.
pub(super) fn fps_of(asked: Option<f64>, pair: [&Frames; 2]) -> anyhow::Result<Option<f64>> {
    if asked.is_some() || pair.iter().all(|frames| frames.is_still) {
        return Ok(asked);
    }
    let [reference, test] = pair;
    let rates = pair.map(|frames| frames.fps);
    match rates {
        [Some(a), Some(b)] if (a / b - 1.0).abs() > 1e-3 => bail!(
            "{}: {} a second where the reference has {a}; give --fps",
            test.name.display(),
            counted(b, "frame")
        ),
        [Some(rate), _] | [None, Some(rate)] => Ok(Some(rate)),
        [None, None] => bail!(WrongUsage(format!(
            "{}: numbered pictures have no rate; give --fps",
            reference.name.display()
        ))),
    }
}

/// Refuses code values that the display does not take for what they are.
pub(super) fn check_hdr(display: &Display, pair: [&Frames; 2]) -> anyhow::Result<()> {
    match pair.iter().find(|frames| frames.is_hdr) {
        Some(frames) if display.transfer != Transfer::Pq => bail!(
            "{}: its code values follow a high dynamic range curve; give --display \
             standard_hdr_pq or a file with transfer = \"pq\", or convert it",
            frames.name.display()
        ),
        _ => Ok(()),
    }
}
