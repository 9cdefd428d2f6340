//! Where does a viewer look whose pointer stands for the gaze?
//!
//! The pointer is taken as it is, without smoothing. When it leaves, its last place holds for a
//! second, then the middle of the picture stands in.

use crate::gaze::loss::HOLD;
use crate::gaze::sample::GazeSample;
use crate::gaze::spread::GazeEvidence;
use crate::units::{Radians, Seconds};
use crate::view::navigation::Shown;

/// The pointer over a window.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pointer {
    /// Its last place in the window, in pixels.
    place: Option<[f64; 2]>,
    left: Option<f64>,
}

impl Pointer {
    /// It is over the window, at `place`.
    pub fn move_to(&mut self, place: [f64; 2]) {
        self.place = Some(place);
        self.left = None;
    }

    /// It is no more over the window.
    pub fn leave(&mut self, now: Seconds) {
        self.left = self.left.or(Some(now.0));
    }

    /// The pointer's place while it is over the window.
    pub fn place(&self) -> Option<[f64; 2]> {
        self.place.filter(|_| self.left.is_none())
    }

    /// When it will be forgotten.
    pub fn forgotten(&self) -> Option<Seconds> {
        self.left.map(|left| Seconds(left + HOLD.0))
    }

    /// The gaze that it stands for.
    #[must_use]
    pub fn gaze(&self, now: Seconds, shown: &Shown) -> GazeSample {
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
#[must_use]
pub fn gaze_at(place: Option<[f64; 2]>, now: Seconds, shown: &Shown) -> GazeSample {
    let middle = shown.view.size.map(|side| f64::from(side) / 2.0);
    let ray = shown.view.ray(place.unwrap_or(middle)).normalize();
    GazeSample {
        gaze_in_content: ray,
        ..GazeSample::at(now, Radians(0.0), Radians(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::axes::angle_between;
    use crate::view::navigation::{Navigation, Pane};
    use crate::view::surface::{Screen, Surface};

    fn shown() -> Shown {
        let surface = Surface::flat([1600, 900], Screen::default());
        let pane = Pane::new([1600, 900], [1920, 1080], Screen::default());
        Navigation::new(surface, Radians(1.0)).shown(&pane)
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
}
