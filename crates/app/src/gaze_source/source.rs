//! What are gaze and head at a time, whatever they come from?

use crate::gaze_source::choice::GazeChoice;
use crate::gaze_source::live::Live;
use crate::gaze_source::trace_file::{read_table, read_trace};
use crate::gaze_source::viewer::ViewerModel;
use anyhow::bail;
use foveal_core::gaze::head::FollowingHead;
use foveal_core::gaze::read::row::TraceRow;
use foveal_core::gaze::read::trace::Trace;
use foveal_core::gaze::sample::{EyeEvent, GazeSample, HeadPose};
use foveal_core::gaze::scan::ScanPath;
use foveal_core::gaze::tracker::{GazeTracker, Prediction};
use foveal_core::units::{Radians, Seconds};
use foveal_core::view::surface::Surface;
use foveal_play::WatchedFrame;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// How long a live source may take to send its first sample.
pub(crate) const FIRST_SAMPLE: Duration = Duration::from_secs(10);

/// Rate at which a simulated eye is watched, in hertz: that of a headset's tracker.
const SCAN_HZ: f64 = 120.0;
/// What a tracker is given of a gap between two pictures, in seconds. Filters, saccades and motion
/// forget within a second; what was learned before of how the eyes go with the head stays.
const REMEMBERED_S: f64 = 10.0;

/// A gaze, and the head it belongs to, at any time.
pub(crate) struct GazeSource {
    path: GazePath,
    tracker: GazeTracker,
    /// Samples of the path that the tracker was given.
    given: u64,
    /// How long before a picture is shown its gaze must be known.
    late: Seconds,
    head: FollowingHead,
    /// The same head, at the times of the samples.
    head_of_samples: FollowingHead,
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
        viewer: &ViewerModel,
    ) -> anyhow::Result<Self> {
        let path = match choice {
            GazeChoice::At([yaw, pitch]) => {
                let degrees = Radians::from_degrees;
                GazePath::At(GazeSample::at(Seconds(0.0), degrees(*yaw), degrees(*pitch)))
            }
            GazeChoice::Scan => GazePath::Scan(ScanPath::new(surface, seed)),
            GazeChoice::Trace(file) => {
                GazePath::Trace(checked_over(file, read_trace(file)?, length)?)
            }
            GazeChoice::Table(file, form) => {
                GazePath::Trace(checked_over(file, read_table(file, form)?, length)?)
            }
            GazeChoice::Head(file) => {
                let trace = checked_over(file, read_trace(file)?, length)?;
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
            tracker: GazeTracker::new(viewer.preset.clone()),
            given: 0,
            late: viewer.late,
            head: FollowingHead::default(),
            head_of_samples: FollowingHead::default(),
            head_moves: surface.projection.surrounds(),
        })
    }

    /// Whether time passes by itself: frames must then be played when they are due.
    pub(crate) fn is_live(&self) -> bool {
        matches!(self.path, GazePath::Live(_))
    }

    /// How long a recorded trace lasts, from 0; 0 of every other source.
    pub(crate) fn lasts(&self) -> Seconds {
        match &self.path {
            GazePath::Trace(trace) | GazePath::Head(trace) => {
                let last = trace.samples().last();
                Seconds(last.map_or(0.0, |last| last.time.0.max(0.0)))
            }
            GazePath::At(_) | GazePath::Scan(_) | GazePath::Live(_) => Seconds(0.0),
        }
    }

    /// The viewer when a picture is shown at `time`; times must not decrease. On flat content the
    /// head stays before the screen; on 360° content a head that was not recorded follows the gaze.
    /// A live source gives what is known when it is asked.
    pub(crate) fn look(&mut self, time: Seconds) -> WatchedFrame {
        self.watch(Seconds(time.0 - self.late.0));
        let asked = match &self.path {
            GazePath::Live(live) => Seconds(live.time().0 + self.late.0),
            _ => time,
        };
        let expected = self.tracker.predict(asked);
        let mut expected = expected.unwrap_or_else(|| unknown(&self.path, time));
        expected.gaze.time = time;
        let gaze = match &mut self.path {
            GazePath::At(sample) => *sample,
            GazePath::Scan(path) => path.at(time).0,
            GazePath::Trace(trace) => trace.at(time),
            // Its eyes, where it has any, are known to the judge alone.
            GazePath::Head(trace) => match trace.at(time) {
                eyes if eyes.valid => eyes,
                GazeSample { head, .. } => GazeSample {
                    head,
                    valid: false,
                    ..expected.gaze
                },
            },
            GazePath::Live(_) => expected.gaze,
        };
        let gaze = GazeSample { time, ..gaze };
        let head = self.head_at(&gaze, time);
        // Without delay the prediction equals the sample, where the source reports eyes.
        let tells_eyes = !matches!(self.path, GazePath::Head(_));
        let seen = gaze.valid && tells_eyes && self.late.0 == 0.0;
        if seen {
            expected.gaze = gaze;
        }
        let head_expected = match expected.gaze.head {
            Some(head_expected) if self.head_moves && !seen => head_expected,
            _ => head,
        };
        WatchedFrame {
            gaze,
            gaze_is_known: gaze.valid && !self.is_live(),
            head,
            expected,
            head_expected,
        }
    }

    fn head_at(&mut self, gaze: &GazeSample, time: Seconds) -> HeadPose {
        match (self.head_moves, gaze.head) {
            (false, _) => HeadPose::default(),
            (true, Some(head)) => head,
            (true, None) => self.head.follow(gaze.gaze_in_content, time),
        }
    }

    /// Gives the tracker what was sent until `time`.
    fn watch(&mut self, time: Seconds) {
        match &mut self.path {
            GazePath::At(_) => {}
            GazePath::Scan(path) => {
                let oldest = ((time.0 - REMEMBERED_S) * SCAN_HZ).max(0.0) as u64;
                self.given = self.given.max(oldest);
                while self.given as f64 / SCAN_HZ <= time.0 {
                    let at = Seconds(self.given as f64 / SCAN_HZ);
                    let mut sample = path.at(at).0;
                    if self.head_moves {
                        sample.head = Some(self.head_of_samples.follow(sample.gaze_in_content, at));
                    }
                    self.tracker.push(&sample);
                    self.given += 1;
                }
            }
            GazePath::Trace(trace) => {
                for sample in come(trace, &mut self.given, time) {
                    self.tracker.push(sample);
                }
            }
            GazePath::Head(trace) => {
                for sample in come(trace, &mut self.given, time) {
                    self.tracker.push(&GazeSample {
                        valid: false,
                        ..*sample
                    });
                }
            }
            GazePath::Live(live) => {
                let rows = live.take();
                rows.iter()
                    .map(TraceRow::sample)
                    .for_each(|sample| self.tracker.push(&sample));
            }
        }
    }
}

/// A trace of a file, some of which is of the time from 0 to `length`.
fn checked_over(file: &Path, trace: Trace, length: Seconds) -> anyhow::Result<Trace> {
    let samples = trace.samples();
    if let (Some(first), Some(last)) = (samples.first(), samples.last())
        && (first.time.0 > length.0.max(1.0) || last.time.0 < 0.0)
    {
        bail!(
            "{}: t_s runs from {} to {}, the content from 0 to {}; let t_s count from the \
             content's start",
            file.display(),
            first.time.0,
            last.time.0,
            length.0
        );
    }
    Ok(trace)
}

/// The samples of a trace from number `given` until `time`.
fn come<'a>(trace: &'a Trace, given: &mut u64, time: Seconds) -> &'a [GazeSample] {
    let rest = &trace.samples()[*given as usize..];
    let count = rest.partition_point(|sample| sample.time <= time);
    *given += count as u64;
    &rest[..count]
}

/// What is expected of an eye before its first sample.
fn unknown(path: &GazePath, time: Seconds) -> Prediction {
    let gaze = match path {
        GazePath::At(sample) => *sample,
        GazePath::Trace(trace) => trace.at(time),
        GazePath::Head(trace) => {
            let first = trace.at(time);
            let forward = first.head.unwrap_or_default().axes().forward;
            GazeSample {
                gaze_in_content: forward,
                valid: false,
                ..first
            }
        }
        GazePath::Scan(_) | GazePath::Live(_) => GazeSample::at(time, Radians(0.0), Radians(0.0)),
    };
    Prediction {
        gaze,
        event: EyeEvent::Fixation,
        since_saccade: None,
    }
}
