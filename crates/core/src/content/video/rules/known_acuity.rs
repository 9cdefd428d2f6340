//! What is known of an eye's acuity from other views of the same moment?

use crate::perception::acuity::AcuityModel;
use crate::units::Radians;
use glam::DVec3;

/// No level: it was not asked for yet.
pub(super) const UNKNOWN: u8 = u8::MAX;

/// What was found of one eye at one moment on one grid.
#[derive(Clone, Debug, Default)]
pub(crate) struct KnownAcuity {
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
    /// How many eyes were asked.
    #[cfg(test)]
    pub(super) fn eyes(&self) -> usize {
        self.found.len()
    }

    /// The levels known so far for such an eye, by rank of the cell.
    pub(super) fn levels(&mut self, eye: EyeBehind, cells: usize) -> &mut Vec<u8> {
        let at = self.found.iter().position(|(known, _)| *known == eye);
        let at = at.unwrap_or_else(|| {
            self.found.push((eye, vec![UNKNOWN; cells]));
            self.found.len() - 1
        });
        &mut self.found[at].1
    }
}
