//! Where does whoever sits before the window look?

use crate::gaze_source::{GazeChoice, GazeSource, ViewerModel as Viewer, parse_gaze};
use anyhow::anyhow;
use foveal_core::gaze::pointer::{Pointer, gaze_at};
use foveal_core::gaze::sample::{EyeEvent, HeadPose};
use foveal_core::perception::parameters::Parameters;
use foveal_core::session::aim::Aim;
use foveal_core::units::Seconds;
use foveal_core::view::navigation::Shown;
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
pub(crate) enum Looking {
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

/// Who looks, and when.
pub(crate) struct Watched<'a> {
    pub(crate) now: Seconds,
    pub(crate) pointer: &'a Pointer,
    pub(crate) perception: &'a Parameters,
}

impl Looking {
    /// Opens a source; waits for the first sample of a live one.
    pub(crate) fn open(
        choice: &WindowGaze,
        surface: &Surface,
        seed: u64,
        length: Seconds,
        viewer: &Viewer,
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
        let source = GazeSource::new(choice, surface, seed, length, viewer)?;
        Ok(Self::Source {
            source: Box::new(source),
            leads: !matches!(choice, GazeChoice::At(_) | GazeChoice::Live(_)),
            moves: !matches!(choice, GazeChoice::At(_)),
        })
    }

    /// Whether the gaze changes though nobody touches the window.
    pub(crate) fn moves(&self) -> bool {
        matches!(self, Self::Source { moves: true, .. })
    }

    /// What selection is given; asked in order of time. `shown` tells what the window shows once
    /// the head is where the source says.
    pub(crate) fn aim(
        &mut self,
        watched: &Watched<'_>,
        shown: impl FnOnce(Option<HeadPose>) -> Shown,
    ) -> Aim {
        let (now, perception) = (watched.now, watched.perception);
        let still = perception.eye_state(EyeEvent::Fixation, None);
        let (gaze, state, view) = match self {
            Self::Source { source, leads, .. } => {
                let look = source.look(now);
                let expected = look.expected;
                let recorded = expected.gaze.head;
                let head = if *leads {
                    Some(look.head_expected)
                } else {
                    recorded
                };
                let state = perception.eye_state(expected.event, expected.since_saccade);
                (expected.gaze, state, shown(head).view)
            }
            Self::Pointer => {
                let shown = shown(None);
                (watched.pointer.gaze(now, &shown), still, shown.view)
            }
            Self::Centre => {
                let shown = shown(None);
                (gaze_at(None, now, &shown), still, shown.view)
            }
        };
        Aim {
            gaze,
            view,
            head: HeadPose::default(),
            state,
            behind_sound: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_takes_the_mouse_and_every_other_gaze() {
        assert_eq!(parse_window_gaze("mouse").unwrap(), WindowGaze::Mouse);
        assert_eq!(parse_window_gaze("center").unwrap(), WindowGaze::Centre);
        let scan = WindowGaze::Other(GazeChoice::Scan);
        assert_eq!(parse_window_gaze("scan").unwrap(), scan);
        assert!(parse_window_gaze("cat").is_err());
    }
}
