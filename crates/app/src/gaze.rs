//! Where does a command's gaze come from?

use crate::options::parse_pair;
use crate::output::read_text;
use anyhow::{Context, anyhow, bail};
use foveal_core::gaze::head::FollowingHead;
use foveal_core::gaze::sample::{GazeSample, HeadPose};
use foveal_core::gaze::scan::ScanPath;
use foveal_core::gaze::trace::Trace;
use foveal_core::units::{Radians, Seconds};
use foveal_core::view::surface::{Projection, Surface};
use std::path::PathBuf;

/// What `--gaze` was given.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum GazeChoice {
    /// Yaw to the right and pitch up, in degrees.
    At([f64; 2]),
    /// A simulated scan path.
    Scan,
    /// A recorded trace.
    Trace(PathBuf),
}

/// Reads `YAW,PITCH`, `center`, `scan` or `trace:FILE`.
pub(crate) fn parse_gaze(text: &str) -> anyhow::Result<GazeChoice> {
    if let Some(file) = text.strip_prefix("trace:") {
        return Ok(GazeChoice::Trace(PathBuf::from(file)));
    }
    match text {
        "center" | "centre" => Ok(GazeChoice::At([0.0, 0.0])),
        "scan" => Ok(GazeChoice::Scan),
        _ => {
            let [yaw, pitch] = parse_pair(text).map_err(|_| {
                anyhow!("expected YAW,PITCH in degrees, center, scan or trace:FILE")
            })?;
            if pitch.abs() > 90.0 || yaw.abs() > 36_000.0 {
                bail!("a pitch beyond 90 degrees, or a yaw beyond 36000");
            }
            Ok(GazeChoice::At([yaw, pitch]))
        }
    }
}

/// A gaze, and the head it belongs to, at any time.
#[derive(Clone, Debug)]
pub(crate) struct GazeSource {
    path: GazePath,
    head: FollowingHead,
    head_moves: bool,
}

#[derive(Clone, Debug)]
enum GazePath {
    At(GazeSample),
    Scan(ScanPath),
    Trace(Trace),
}

impl GazeSource {
    /// The source of a choice, for content on `surface` that lasts `length`.
    pub(crate) fn new(
        choice: &GazeChoice,
        surface: &Surface,
        seed: u64,
        length: Seconds,
    ) -> anyhow::Result<Self> {
        let path = match choice {
            GazeChoice::At([yaw, pitch]) => {
                let degrees = Radians::from_degrees;
                GazePath::At(GazeSample::at(Seconds(0.0), degrees(*yaw), degrees(*pitch)))
            }
            GazeChoice::Scan => GazePath::Scan(ScanPath::new(surface, seed, length)),
            GazeChoice::Trace(file) => {
                let name = file.display();
                let text = read_text(file, "a gaze trace")?;
                GazePath::Trace(Trace::parse(&text).with_context(|| name.to_string())?)
            }
        };
        let head_moves = surface.projection == Projection::Cube;
        Ok(Self {
            path,
            head: FollowingHead::default(),
            head_moves,
        })
    }

    /// The gaze and the head at a time; times must not decrease. On flat content the head stays
    /// before the screen; on 360° content a head that was not recorded follows the gaze.
    pub(crate) fn at(&mut self, time: Seconds) -> (GazeSample, HeadPose) {
        let sample = match &self.path {
            GazePath::At(sample) => GazeSample { time, ..*sample },
            GazePath::Scan(path) => path.at(time).0,
            GazePath::Trace(trace) => GazeSample {
                time,
                ..trace.at(time)
            },
        };
        let head = match (self.head_moves, sample.head) {
            (false, _) => HeadPose::default(),
            (true, Some(head)) => head,
            (true, None) => self.head.follow(sample.gaze_in_content, time),
        };
        (sample, head)
    }
}
