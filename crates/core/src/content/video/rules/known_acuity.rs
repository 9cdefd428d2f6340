//! What is known of an eye's acuity from other views and moments?

use crate::perception::acuity::AcuityModel;
use crate::units::Radians;
use glam::DVec3;

/// No level: it was not asked for yet.
pub(super) const UNKNOWN: u8 = u8::MAX;

/// Eyes that are remembered: those of a search for a slope, and a few densities of panels.
const MOST_EYES: usize = 16;

/// What was found of the last eyes on one grid.
#[derive(Clone, Debug, Default)]
pub(crate) struct KnownAcuity {
    /// The one asked last comes last.
    found: Vec<(EyeBehind, Vec<u8>)>,
}

/// What an eye's levels depend on where a view turns with the head.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct EyeBehind {
    pub(super) acuity: AcuityModel,
    pub(super) gaze: DVec3,
    pub(super) spread: Radians,
    /// Pixels per degree of the display's densest corner; 0 without one.
    pub(super) ppd: f64,
}

impl KnownAcuity {
    /// How many eyes are remembered.
    #[cfg(test)]
    pub(super) fn eyes(&self) -> usize {
        self.found.len()
    }

    /// The levels known so far for such an eye, by rank of the cell.
    pub(super) fn levels(&mut self, eye: EyeBehind, cells: usize) -> &mut Vec<u8> {
        let last = self.found.len();
        let at = self.found.iter().rposition(|(known, _)| *known == eye);
        match at {
            Some(at) => self.found[at..].rotate_left(1),
            None if last < MOST_EYES => self.found.push((eye, vec![UNKNOWN; cells])),
            None => {
                self.found.rotate_left(1);
                self.found[last - 1] = (eye, vec![UNKNOWN; cells]);
            }
        }
        let last = self.found.len() - 1;
        &mut self.found[last].1
    }
}
