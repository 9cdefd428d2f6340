//! Where is the window's viewer looking?

use crate::commands::view::window::panes::RigPanes;
use crate::gaze_source::{GazeChoice, GazeSource, ViewerModel, parse_gaze};
use anyhow::anyhow;
use foveal_core::gaze::pointer::gaze_at;
use foveal_core::gaze::sample::{EyeEvent, GazeSample};
use foveal_core::perception::moment::Moment;
use foveal_core::perception::parameters::{EyeState, Parameters};
use foveal_core::session::viewer::Viewer;
use foveal_core::units::Seconds;
use foveal_core::view::navigation::{Pane, Shown};
use foveal_core::view::surface::Surface;

/// Length of a simulated scan path.
const SCAN: Seconds = Seconds(3600.0);

/// What `--gaze` may be in a window.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum WindowGaze {
    Mouse,
    /// The middle of the window.
    Centre,
    Other(GazeChoice),
}

/// Reads the value of `--gaze` for a window.
pub(crate) fn parse_window_gaze(text: &str) -> anyhow::Result<WindowGaze> {
    Ok(match text {
        "mouse" => WindowGaze::Mouse,
        "center" | "centre" => WindowGaze::Centre,
        _ => WindowGaze::Other(parse_gaze(text).map_err(|error| anyhow!("mouse, or: {error}"))?),
    })
}

/// Where the gaze comes from.
pub(crate) enum WindowGazeSource {
    Pointer,
    Centre,
    Source {
        source: Box<GazeSource>,
        /// Whether its head turns the view; otherwise only a recorded one does.
        leads: bool,
        /// Whether it changes by itself.
        moves: bool,
    },
}

impl WindowGazeSource {
    /// Opens a source; waits for the first sample of a live one.
    pub(crate) fn open(
        choice: &WindowGaze,
        surface: &Surface,
        seed: u64,
        length: Seconds,
        model: &ViewerModel,
    ) -> anyhow::Result<Self> {
        let choice = match choice {
            WindowGaze::Mouse => return Ok(Self::Pointer),
            WindowGaze::Centre => return Ok(Self::Centre),
            WindowGaze::Other(choice) => choice,
        };
        let length = match choice {
            GazeChoice::Scan => SCAN,
            _ => length,
        };
        let source = GazeSource::new(choice, surface, seed, length, model)?;
        Ok(Self::Source {
            source: Box::new(source),
            leads: !matches!(choice, GazeChoice::At(_) | GazeChoice::Live(_)),
            moves: !matches!(choice, GazeChoice::At(_)),
        })
    }

    /// Whether the gaze changes without any input to the window.
    pub(crate) fn moves(&self) -> bool {
        matches!(self, Self::Source { moves: true, .. })
    }

    /// What selection is given, with the head turned to where a source says; asked in order of
    /// time.
    pub(crate) fn moment(
        &mut self,
        now: Seconds,
        viewer: &mut Viewer,
        (pane, panes): (&Pane, Option<&RigPanes>),
        perception: &Parameters,
    ) -> Moment {
        let still = perception.eye_state(EyeEvent::Fixation, None);
        let (gaze, state) = match self {
            Self::Source { source, leads, .. } => {
                let look = source.look(now);
                let expected = look.expected;
                let recorded = expected.gaze.head;
                let head = if *leads {
                    Some(look.head_expected)
                } else {
                    recorded
                };
                if let Some(head) = head {
                    viewer.navigation.look_along(head);
                }
                let state = perception.eye_state(expected.event, expected.since_saccade);
                (expected.gaze, state)
            }
            Self::Pointer => {
                let shown = pointed_at(viewer, pane, panes);
                (viewer.pointer.gaze(now, &shown), still)
            }
            Self::Centre => (gaze_at(None, now, &viewer.shown(pane)), still),
        };
        let navigation = &viewer.navigation;
        let view = navigation.shown(pane).view;
        let head = navigation.head();
        Moment {
            gaze: GazeSample {
                gaze_in_content: navigation.with_the_hand(gaze.gaze_in_content),
                ..gaze
            },
            views: match panes {
                Some(panes) => panes.views(head, view.position),
                None => vec![view],
            },
            head: panes.map_or(head, |panes| panes.head(head)),
            state,
            behind_sound: None,
        }
    }
}

/// The key that stands for a saccade where no eye tracker reports one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum SaccadeKey {
    #[default]
    NeverHeld,
    Held,
    LetGo(Seconds),
}

impl SaccadeKey {
    /// The key is held from now on, or let go.
    pub(crate) fn hold(&mut self, is_held: bool, now: Seconds) {
        *self = match (is_held, *self) {
            (true, _) => Self::Held,
            (false, Self::Held) => Self::LetGo(now),
            (false, other) => other,
        };
    }

    /// When the eye has landed; `None` where it has not jumped, or still does.
    pub(crate) fn landed(&self, perception: &Parameters) -> Option<Seconds> {
        match self {
            Self::LetGo(at) => Some(Seconds(at.0 + perception.landed_ms / 1000.0)),
            Self::NeverHeld | Self::Held => None,
        }
    }

    /// What the eye is doing; `None` where the key says nothing about it.
    pub(crate) fn state(&self, now: Seconds, perception: &Parameters) -> Option<EyeState> {
        let since = match self {
            Self::NeverHeld => return None,
            Self::Held => return Some(perception.eye_state(EyeEvent::Saccade, None)),
            Self::LetGo(at) => Seconds(now.0 - at.0),
        };
        let state = perception.eye_state(EyeEvent::Fixation, Some(since));
        (state == EyeState::Landed).then_some(state)
    }
}

/// What the pointer is over: the panel under it, where there are panels.
fn pointed_at(viewer: &Viewer, pane: &Pane, panes: Option<&RigPanes>) -> Shown {
    let shown = viewer.shown(pane);
    let at = viewer.pointer.place().zip(panes);
    let under = at.and_then(|(place, panes)| {
        let head = viewer.navigation.head();
        panes.shown_at((pane.size, place), head, shown.view.position)
    });
    under.unwrap_or(shown)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_eye_jumps_while_the_key_is_held_and_lands_when_it_is_let_go() {
        let perception = Parameters::default();
        let mut key = SaccadeKey::default();
        let state = |key: &SaccadeKey, now| key.state(Seconds(now), &perception);
        assert_eq!(state(&key, 1.0), None);
        key.hold(false, Seconds(1.0));
        assert_eq!(state(&key, 1.0), None, "it was not held");
        key.hold(true, Seconds(2.0));
        assert_eq!(state(&key, 5.0), Some(EyeState::Jumping));
        key.hold(false, Seconds(5.0));
        assert_eq!(state(&key, 5.01), Some(EyeState::Landed));
        assert_eq!(state(&key, 6.0), None);
    }

    #[test]
    fn a_window_takes_the_mouse_and_every_other_gaze() {
        assert_eq!(parse_window_gaze("mouse").unwrap(), WindowGaze::Mouse);
        assert_eq!(parse_window_gaze("center").unwrap(), WindowGaze::Centre);
        let scan = WindowGaze::Other(GazeChoice::Scan);
        assert_eq!(parse_window_gaze("scan").unwrap(), scan);
        assert!(parse_window_gaze("cat").is_err());
    }
}
