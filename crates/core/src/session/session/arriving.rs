//! What becomes of what was decoded, and of what cannot be?

use super::{Session, Staged};
use crate::content::unit::UnitRef;
use crate::pack::unit::UnitId;
use crate::session::actions::{Now, SessionAction};
use crate::session::client_memory::Fetched;
use crate::session::unit_states::{Piece, UnitState};

impl Session {
    /// Puts what was decoded where it belongs.
    pub(super) fn take_events(&mut self, now: &Now) {
        for arrived in std::mem::take(&mut self.arrived) {
            let samples = self.unit(arrived.piece).samples;
            self.figures.decoded(u64::from(arrived.frames) * samples);
            match arrived.is_damaged {
                true => self.give_up(arrived.piece),
                false => {
                    self.receive(arrived.piece);
                    self.place(arrived.piece);
                }
            }
        }
        let lost = |piece: &&Piece| {
            let asset = &self.scene[usize::from(piece.unit.asset.0)];
            asset.is_lost(piece.unit.unit)
        };
        let lost: Vec<Piece> = self.requested.iter().filter(lost).copied().collect();
        lost.into_iter().for_each(|piece| self.give_up(piece));
        self.hand_out_more();
        let has_no_room = self.has_no_room();
        let (states, figures) = (&self.states, &mut self.figures);
        for (staged, is_full) in [(&mut self.shown, false), (&mut self.coming, has_no_room)] {
            let Some(staged) = staged else {
                continue;
            };
            if staged.complete.is_none() && (is_full || staged.is_whole(states)) {
                staged.complete = Some(now.wall.0);
                figures.complete(now.wall.0 - staged.begun);
            }
        }
    }

    /// Counts what a piece took to fetch, where its unit was not there.
    fn receive(&mut self, piece: Piece) {
        let unit = self.unit(piece);
        let bytes = u64::from(unit.bytes.unwrap_or(0));
        let fetched = self.memory.receive(piece.unit, &unit);
        self.figures.fetched_bytes += if fetched == Fetched::Held { 0 } else { bytes };
        self.figures.refetched_bytes += if fetched == Fetched::Again { bytes } else { 0 };
    }

    /// Keeps a piece for the frame that comes, or shows it in the one that is there.
    fn place(&mut self, piece: Piece) {
        self.requested.retain(|requested| *requested != piece);
        let wants = |staged: &Option<Staged>| {
            let staged = staged.as_ref();
            staged.is_some_and(|staged| staged.shows.contains(&piece))
        };
        let state = self.states.of(piece);
        let is_awaited = state == Some(UnitState::Requested);
        if state == Some(UnitState::Cached) {
            // It came twice, and one payload took the place of the other.
        } else if is_awaited && wants(&self.coming) {
            self.states.set(piece, UnitState::Cached);
        } else if is_awaited && wants(&self.shown) {
            self.states.set(piece, UnitState::Cached);
            self.show_arrived(piece, true);
        } else if !self.is_taken(piece) {
            self.actions.push(SessionAction::Drop(piece));
        }
    }

    /// Shows what came for the frame on screen, once all that it needs is there, and what waited
    /// for it; `makes_room` where others may have to be evicted first.
    pub(super) fn show_arrived(&mut self, piece: Piece, makes_room: bool) {
        let mut open = vec![piece];
        while let Some(piece) = open.pop() {
            if self.states.of(piece) != Some(UnitState::Cached) {
                continue;
            }
            let missing = self.needs(piece).find(|it| !self.states.is_resident(*it));
            if let Some(missing) = missing {
                self.held_back.entry(missing).or_default().push(piece);
                continue;
            }
            if makes_room {
                self.make_room(piece);
            }
            self.upload(piece);
            open.extend(self.held_back.remove(&piece).unwrap_or_default());
        }
    }

    /// Whether what came of a piece is uploaded or dropped by what is to be done already: it came
    /// twice before one step, and one payload took the place of the other.
    fn is_taken(&self, piece: Piece) -> bool {
        let takes = [SessionAction::Upload(piece), SessionAction::Drop(piece)];
        self.actions.iter().any(|action| takes.contains(action))
    }

    /// Brings what was decoded onto the screen.
    pub(super) fn upload(&mut self, piece: Piece) {
        let bytes = self.unit(piece).gpu_bytes;
        self.resident_bytes += bytes;
        self.uncounted = true;
        self.figures.uploaded(bytes);
        self.states.set(piece, UnitState::Resident);
        self.states.set(piece, UnitState::Shown);
        self.actions.push(SessionAction::Upload(piece));
    }

    /// Goes on without a piece: a coarser level stands in, and for the coarsest the frame before.
    fn give_up(&mut self, piece: Piece) {
        self.requested.retain(|requested| *requested != piece);
        if self.states.of(piece) != Some(UnitState::Requested) {
            return;
        }
        self.figures.damaged_units += 1;
        self.states.set(piece, UnitState::Damaged);
        let is_base = self.is_base(piece) && !self.is_spared(piece);
        let is_of_coming = self.coming.as_ref().filter(|it| it.shows.contains(&piece));
        if let Some(coming) = is_of_coming.filter(|_| is_base) {
            self.damaged = Some(coming.tick);
            self.give_up_coming();
            self.figures.damaged_frames += 1;
        }
    }

    /// Whether a damaged piece of the coarsest level leaves others that are shown without it.
    fn is_spared(&self, piece: Piece) -> bool {
        let asset = &self.scene[usize::from(piece.unit.asset.0)];
        let is_whole = |unit: UnitId| {
            let unit = UnitRef { unit, ..piece.unit };
            self.states.of(Piece { unit, ..piece }) != Some(UnitState::Damaged)
        };
        asset.stands_in_parts() && asset.base(piece.frame).into_iter().any(is_whole)
    }

    /// The frame that was coming does not come.
    pub(super) fn give_up_coming(&mut self) {
        let Some(coming) = self.coming.take() else {
            return;
        };
        self.waiting.clear();
        self.must_ask_anew = true;
        self.let_go(&coming.wanted);
        // What is left came for the frame on screen as well.
        for piece in coming.wanted {
            self.show_arrived(piece, true);
        }
    }

    /// Forgets pieces that nothing shows.
    pub(super) fn let_go(&mut self, pieces: &[Piece]) {
        let is_kept = |staged: &Option<Staged>, piece: &Piece| {
            let staged = staged.as_ref();
            staged.is_some_and(|staged| staged.shows.contains(piece))
        };
        for piece in pieces {
            if is_kept(&self.shown, piece) || is_kept(&self.coming, piece) {
                continue;
            }
            match self.states.of(*piece) {
                Some(UnitState::Cached) => {
                    self.actions.push(SessionAction::Drop(*piece));
                    self.states.drop(*piece);
                }
                Some(UnitState::Requested | UnitState::Damaged) => self.states.drop(*piece),
                Some(UnitState::Resident | UnitState::Shown) | None => {}
            }
        }
    }
}
