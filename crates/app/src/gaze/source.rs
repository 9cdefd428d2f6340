//! What are gaze and head at a time, whatever they come from?

use super::choice::GazeChoice;
use super::live::Live;
use super::trace_file::read_trace;
use anyhow::bail;
use foveal_core::gaze::head::FollowingHead;
use foveal_core::gaze::loss::head_only_gaze;
use foveal_core::gaze::sample::{GazeSample, HeadPose};
use foveal_core::gaze::scan::ScanPath;
use foveal_core::gaze::trace::Trace;
use foveal_core::units::{Radians, Seconds};
use foveal_core::view::surface::{Projection, Surface};
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// How long a live source may take to send its first sample.
pub(crate) const FIRST_SAMPLE: Duration = Duration::from_secs(10);

/// A gaze, and the head it belongs to, at any time.
pub(crate) struct GazeSource {
    path: GazePath,
    head: FollowingHead,
    head_moves: bool,
}

enum GazePath {
    At(GazeSample),
    Scan(ScanPath),
    Trace(Trace),
    Head(Trace),
    Live(Live),
}

impl GazeSource {
    /// The source of a choice, for content on `surface` that lasts `length`. Waits for the first
    /// sample of a live one.
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
            GazeChoice::Trace(file) => GazePath::Trace(read_trace(file)?),
            GazeChoice::Head(file) => {
                let trace = read_trace(file)?;
                let headless = |sample: &GazeSample| sample.head.is_none();
                if let Some(row) = trace.samples().iter().position(headless) {
                    bail!(
                        "{}: row {} lacks head_yaw_deg and head_pitch_deg, which head: reads",
                        file.display(),
                        row + 1
                    );
                }
                GazePath::Head(trace)
            }
            GazeChoice::Live(choice) => {
                let live = Live::open(choice)?;
                live.wait_for_first(FIRST_SAMPLE, &AtomicBool::new(false))?;
                GazePath::Live(live)
            }
        };
        Ok(Self {
            path,
            head: FollowingHead::default(),
            head_moves: surface.projection == Projection::Cube,
        })
    }

    /// Whether time passes by itself: frames must then be played when they are due.
    pub(crate) fn is_live(&self) -> bool {
        matches!(self.path, GazePath::Live(_))
    }

    /// The gaze and the head at a time; times must not decrease. On flat content the head stays
    /// before the screen; on 360° content a head that was not recorded follows the gaze. A live
    /// source gives what is known when it is asked.
    pub(crate) fn at(&mut self, time: Seconds) -> (GazeSample, HeadPose) {
        let sample = match &mut self.path {
            GazePath::At(sample) => GazeSample { time, ..*sample },
            GazePath::Scan(path) => path.at(time).0,
            GazePath::Trace(trace) => GazeSample {
                time,
                ..trace.at(time)
            },
            GazePath::Head(trace) => by_head(trace.at(time), time),
            GazePath::Live(live) => live.now(time),
        };
        let head = match (self.head_moves, sample.head) {
            (false, _) => HeadPose::default(),
            (true, Some(head)) => head,
            (true, None) => self.head.follow(sample.gaze_in_content, time),
        };
        (sample, head)
    }
}

/// What remains of a sample when only its head counts.
fn by_head(sample: GazeSample, time: Seconds) -> GazeSample {
    let (gaze_in_content, spread) = head_only_gaze(sample.head.unwrap_or_default());
    GazeSample {
        time,
        gaze_in_content,
        valid: false,
        spread,
        ..sample
    }
}
