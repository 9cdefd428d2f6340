//! Where is the page's viewer looking?

use foveal_core::gaze::head_prediction::saturating::HeadGazePreset;
use foveal_core::gaze::read::record::GazeRecord;
use foveal_core::gaze::read::stream::GazeStream;
use foveal_core::gaze::sample::{EyeEvent, GazeSample, HeadPose};
use foveal_core::gaze::tracker::GazeTracker;
use foveal_core::perception::moment::Moment;
use foveal_core::perception::parameters::Parameters;
use foveal_core::session::viewer::Viewer;
use foveal_core::units::{Radians, Seconds};
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::navigation::Pane;

/// The sender of gazes; without one it is the pointer.
#[derive(Default)]
pub(crate) struct PageGazeSource {
    sender: Option<Sender>,
    /// Expects the eye where a headset's head goes.
    headset: Option<GazeTracker>,
}

struct Sender {
    stream: GazeStream,
    tracker: GazeTracker,
}

fn tracker() -> GazeTracker {
    GazeTracker::new(HeadGazePreset::free_viewing())
}

impl PageGazeSource {
    /// Takes a record that arrived now; says what is wrong with it.
    pub(crate) fn take(&mut self, record: &[u8], now: Seconds) -> Result<(), String> {
        let record = GazeRecord::parse(record).map_err(|error| error.to_string())?;
        let sender = self.sender.get_or_insert_with(|| Sender {
            stream: GazeStream::default(),
            tracker: tracker(),
        });
        if let Some(row) = sender.stream.take(&record, now) {
            sender.tracker.push(&row.sample());
        }
        Ok(())
    }

    /// Goes back to the pointer.
    pub(crate) fn forget_sender(&mut self) {
        self.sender = None;
    }

    /// Whether it changes without any input to the page.
    pub(crate) fn moves(&self) -> bool {
        self.sender.is_some()
    }

    /// What selection is given, with the head turned to where a sender says.
    pub(crate) fn moment(
        &mut self,
        now: Seconds,
        viewer: &mut Viewer,
        pane: &Pane,
        perception: &Parameters,
    ) -> Moment {
        let still = perception.eye_state(EyeEvent::Fixation, None);
        let expected = self.sender.as_mut().and_then(|sender| {
            if let Some(row) = sender.stream.silence(now) {
                sender.tracker.push(&row.sample());
            }
            sender.tracker.predict(sender.stream.now(now))
        });
        let (gaze, state) = match expected {
            Some(expected) => {
                if let Some(head) = expected.gaze.head {
                    viewer.navigation.look_along(head);
                }
                let state = perception.eye_state(expected.event, expected.since_saccade);
                let time = now;
                (
                    GazeSample {
                        time,
                        ..expected.gaze
                    },
                    state,
                )
            }
            None => (viewer.pointer.gaze(now, &viewer.shown(pane)), still),
        };
        Moment {
            gaze: GazeSample {
                gaze_in_content: viewer.navigation.with_the_hand(gaze.gaze_in_content),
                ..gaze
            },
            views: vec![viewer.shown(pane).view],
            head: viewer.navigation.head(),
            state,
            behind_sound: None,
        }
    }

    /// What selection is given in a headset: the gaze expected from the head's motion, unless
    /// a gaze is sent.
    pub(crate) fn moment_in_headset(
        &mut self,
        now: Seconds,
        views: Vec<EyeView>,
        head: HeadPose,
        perception: &Parameters,
    ) -> Moment {
        let ahead = GazeSample {
            gaze_in_content: head.axes().forward,
            valid: false,
            head: Some(head),
            ..GazeSample::at(now, Radians(0.0), Radians(0.0))
        };
        let by_head = self.headset.get_or_insert_with(tracker);
        by_head.push(&ahead);
        let sent = self.sender.as_ref();
        let sent = sent.and_then(|sent| sent.tracker.predict(sent.stream.now(now)));
        let expected = sent.or_else(|| by_head.predict(now));
        let event = expected.map_or(EyeEvent::Fixation, |expected| expected.event);
        let since = expected.and_then(|expected| expected.since_saccade);
        let gaze = expected.map_or(ahead, |expected| expected.gaze);
        Moment {
            gaze: GazeSample { time: now, ..gaze },
            views,
            head,
            state: perception.eye_state(event, since),
            behind_sound: None,
        }
    }
}
