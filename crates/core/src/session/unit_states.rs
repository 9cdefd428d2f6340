//! How far has each unit come on its way to the screen?

use crate::content::unit::UnitRef;
use std::collections::HashMap;

/// A frame of a unit: what is decoded, uploaded and shown at once. Of content without time the
/// frame is 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Piece {
    /// The unit.
    pub unit: UnitRef,
    /// The frame.
    pub frame: u32,
}

/// How far a piece has come. What is in no table is absent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnitState {
    /// It is to be fetched and decoded.
    Requested,
    /// It was decoded, and waits to be shown.
    Cached,
    /// It is on the GPU, and stays there though the picture is made without it, until its place is
    /// needed.
    Resident,
    /// It is on the GPU, and part of the picture.
    Shown,
    /// It is damaged: a coarser one stands in for it.
    Damaged,
}

/// The states of all pieces that a session has asked for: the only memory of them. Caches and the
/// GPU's store obey it.
#[derive(Clone, Debug, Default)]
pub struct UnitStates {
    states: HashMap<Piece, UnitState>,
}

impl UnitStates {
    /// How far a piece has come; `None` where it is absent.
    #[must_use]
    pub fn of(&self, piece: Piece) -> Option<UnitState> {
        self.states.get(&piece).copied()
    }

    /// Whether it came, or never will.
    #[must_use]
    pub fn is_settled(&self, piece: Piece) -> bool {
        self.of(piece)
            .is_some_and(|state| state != UnitState::Requested)
    }

    /// Whether it is on the GPU.
    #[must_use]
    pub fn is_resident(&self, piece: Piece) -> bool {
        matches!(self.of(piece), Some(UnitState::Resident | UnitState::Shown))
    }

    /// Whether it is part of the picture.
    #[must_use]
    pub fn is_shown(&self, piece: Piece) -> bool {
        self.of(piece) == Some(UnitState::Shown)
    }

    /// Brings a piece into a state.
    ///
    /// # Panics
    /// States change along their edges only: what is absent is requested, what was requested is
    /// decoded or found damaged, what was decoded is uploaded, what is resident is shown, and what
    /// was shown is resident.
    pub(super) fn set(&mut self, piece: Piece, to: UnitState) {
        let from = self.states.insert(piece, to);
        assert!(
            is_an_edge(from, to),
            "{piece:?} goes from {from:?} to {to:?}"
        );
    }

    /// Forgets a piece: it is absent.
    pub(super) fn drop(&mut self, piece: Piece) {
        self.states.remove(&piece);
    }

    /// Forgets all of them.
    pub(super) fn clear(&mut self) {
        self.states.clear();
    }

    /// The pieces in a state, in order.
    #[must_use]
    pub fn in_state(&self, state: UnitState) -> Vec<Piece> {
        let states = self.states.iter();
        let of_state = states.filter(|(_, is)| **is == state);
        let mut pieces: Vec<Piece> = of_state.map(|(piece, _)| *piece).collect();
        pieces.sort_unstable();
        pieces
    }

    /// The pieces that are on the GPU, of whichever frame, in order.
    #[must_use]
    pub fn resident(&self) -> Vec<Piece> {
        let mut pieces = self.in_state(UnitState::Resident);
        pieces.extend(self.in_state(UnitState::Shown));
        pieces.sort_unstable();
        pieces
    }
}

fn is_an_edge(from: Option<UnitState>, to: UnitState) -> bool {
    use UnitState::{Cached, Damaged, Requested, Resident, Shown};
    match to {
        Requested => matches!(from, None | Some(Requested)),
        Cached | Damaged => from == Some(Requested),
        Resident => matches!(from, Some(Cached | Shown)),
        Shown => from == Some(Resident),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use UnitState::{Cached, Damaged, Requested, Resident, Shown};

    #[test]
    fn a_piece_comes_step_by_step_and_goes_back_out_of_the_picture_or_by_being_dropped() {
        let all = [Requested, Cached, Resident, Shown, Damaged];
        let way = [Some(Requested), Some(Cached), Some(Resident), Some(Shown)];
        for from in way.into_iter().chain([None, Some(Damaged)]) {
            let next: Vec<UnitState> = all.into_iter().filter(|to| is_an_edge(from, *to)).collect();
            let expected: &[UnitState] = match from {
                None => &[Requested],
                Some(Requested) => &[Requested, Cached, Damaged],
                Some(Cached) => &[Resident],
                Some(Resident) => &[Shown],
                Some(Shown) => &[Resident],
                Some(Damaged) => &[],
            };
            assert_eq!(next, expected, "{from:?}");
        }
    }
}
