//! Where does whoever sits before the window look?
//!
//! A pointer stands for the gaze where nobody tracks it: as it is, without smoothing. When it
//! leaves, its last place holds for a second, then the middle of the window stands in.

use super::choice::Aim;
use super::scene::Shown;
use crate::gaze::{GazeChoice, GazeSource, Viewer, parse_gaze};
use anyhow::anyhow;
use foveal_core::gaze::loss::HOLD;
use foveal_core::gaze::sample::{EyeEvent, GazeSample, HeadPose};
use foveal_core::gaze::spread::GazeEvidence;
use foveal_core::perception::parameters::Parameters;
use foveal_core::units::{Radians, Seconds};
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

/// The pointer over a window.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Pointer {
    /// Its last place in the window, in pixels.
    place: Option<[f64; 2]>,
    left: Option<f64>,
}

impl Pointer {
    pub(crate) fn move_to(&mut self, place: [f64; 2]) {
        self.place = Some(place);
        self.left = None;
    }

    pub(crate) fn leave(&mut self, now: Seconds) {
        self.left = self.left.or(Some(now.0));
    }

    /// The pointer's place while it is over the window.
    pub(crate) fn place(&self) -> Option<[f64; 2]> {
        self.place.filter(|_| self.left.is_none())
    }

    /// When it will be forgotten.
    pub(crate) fn forgotten(&self) -> Option<Seconds> {
        self.left.map(|left| Seconds(left + HOLD.0))
    }

    /// The gaze that it stands for.
    fn gaze(&self, now: Seconds, shown: &Shown) -> GazeSample {
        let held = self.forgotten().is_none_or(|forgotten| now.0 < forgotten.0);
        let place = self.place.filter(|_| held);
        let (evidence, age) = match place {
            Some(_) => (GazeEvidence::Mouse, now.0 - self.left.unwrap_or(now.0)),
            None => (GazeEvidence::Head, 0.0),
        };
        GazeSample {
            valid: self.place().is_some(),
            spread: evidence.spread(evidence.own_spread(), Seconds(age)),
            ..gaze_at(place.map(|place| shown.in_picture(place)), now, shown)
        }
    }
}

/// A certain gaze at a place of the picture, or at the middle of it.
fn gaze_at(place: Option<[f64; 2]>, now: Seconds, shown: &Shown) -> GazeSample {
    let middle = shown.view.size.map(|side| f64::from(side) / 2.0);
    let ray = shown.view.ray(place.unwrap_or(middle)).normalize();
    GazeSample {
        gaze_in_content: ray,
        ..GazeSample::at(now, Radians(0.0), Radians(0.0))
    }
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
    use crate::view::scene::{Pane, Scene};
    use foveal_core::view::axes::angle_between;
    use foveal_core::view::surface::Screen;

    fn shown() -> Shown {
        let surface = Surface::flat([1600, 900], Screen::default());
        let pane = Pane::new([1600, 900], [1920, 1080], Screen::default());
        Scene::new(surface, Radians(1.0)).shown(&pane)
    }

    fn look(pointer: &Pointer, now: f64) -> GazeSample {
        pointer.gaze(Seconds(now), &shown())
    }

    #[test]
    fn the_pointer_is_the_gaze_at_once_and_exactly() {
        let mut pointer = Pointer::default();
        pointer.move_to([400.0, 225.0]);
        let gaze = look(&pointer, 0.0);
        assert!(gaze.valid);
        assert!((gaze.spread.to_degrees() - 0.5).abs() < 1e-9);
        let place = shown().view.place(gaze.gaze_in_content).unwrap();
        assert!((place[0] - 400.0).abs() < 1e-6 && (place[1] - 225.0).abs() < 1e-6);
    }

    #[test]
    fn a_pointer_that_left_holds_for_a_second_then_the_middle_stands_in() {
        let mut pointer = Pointer::default();
        pointer.move_to([10.0, 10.0]);
        let before = look(&pointer, 1.0);
        pointer.leave(Seconds(1.0));
        pointer.leave(Seconds(1.5));
        let held = look(&pointer, 1.99);
        assert!(!held.valid);
        assert_eq!(held.gaze_in_content, before.gaze_in_content);
        let forgotten = look(&pointer, 2.01);
        let off = angle_between(forgotten.gaze_in_content, shown().view.axes.forward);
        assert!(off.0 < 1e-9 && forgotten.spread > held.spread);
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
