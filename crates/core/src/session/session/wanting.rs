//! What is asked for, in which order, and how much of it at once?

use super::Session;
use crate::content::unit::{Unit, UnitRef};
use crate::session::actions::{Now, SessionAction};
use crate::session::unit_states::{Piece, UnitState};
use crate::view::axes::angle_between;
use std::collections::HashSet;

impl Session {
    pub(super) fn unit(&self, piece: Piece) -> Unit {
        self.scene[usize::from(piece.unit.asset.0)].unit(piece.unit.unit)
    }

    /// Whether a piece is of the coarsest level of its asset.
    pub(super) fn is_base(&self, piece: Piece) -> bool {
        let asset = &self.scene[usize::from(piece.unit.asset.0)];
        self.unit(piece).level == asset.coarsest()
    }

    /// Pieces in the order in which they matter: the coarsest level first, then by distance to the
    /// gaze; each after those that it needs.
    fn in_order(&self, pieces: impl Iterator<Item = Piece>, now: &Now) -> Vec<Piece> {
        let gaze = now.moment.gaze.gaze_in_content;
        let eye = now.moment.views.first().map(|view| view.position);
        let eye = eye.unwrap_or_default();
        let mut order: Vec<(bool, f64, Piece)> = pieces
            .map(|piece| {
                let asset = &self.scene[usize::from(piece.unit.asset.0)];
                let angle = angle_between(gaze, asset.direction(piece.unit.unit, eye)).0;
                (!self.is_base(piece), angle, piece)
            })
            .collect();
        order.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        self.needs_first(order.into_iter().map(|(.., piece)| piece).collect())
    }

    /// The same pieces, each after those of them that it needs.
    pub(super) fn needs_first(&self, pieces: Vec<Piece>) -> Vec<Piece> {
        if pieces
            .iter()
            .all(|piece| self.needs(*piece).next().is_none())
        {
            return pieces;
        }
        let mut left: HashSet<Piece> = pieces.iter().copied().collect();
        let mut order = Vec::with_capacity(pieces.len());
        for piece in pieces {
            let mut open = vec![piece];
            while let Some(&next) = open.last() {
                let before = open.len();
                if left.contains(&next) {
                    open.extend(self.needs(next).filter(|need| left.contains(need)));
                }
                if open.len() == before {
                    open.pop();
                    order.extend(left.take(&next));
                }
            }
        }
        order
    }

    /// What must be on screen before a piece.
    pub(super) fn needs(&self, piece: Piece) -> impl Iterator<Item = Piece> + '_ {
        let asset = piece.unit.asset;
        let needs = self.scene[usize::from(asset.0)].needs(piece.unit.unit);
        needs.iter().map(move |unit| Piece {
            unit: UnitRef { asset, unit: *unit },
            ..piece
        })
    }

    /// Those of the chosen pieces that there is room for on the GPU.
    pub(super) fn fitting(&self, wanted: Vec<Piece>, now: &Now) -> Vec<Piece> {
        let most = self.bounds.gpu;
        let all = wanted.iter().map(|piece| self.unit(*piece).gpu_bytes);
        if all.sum::<u64>() <= most {
            return wanted;
        }
        let mut bytes = 0;
        let mut has_room = |piece: &Piece| {
            bytes += self.unit(*piece).gpu_bytes;
            bytes <= most || self.is_base(*piece)
        };
        let order = self.in_order(wanted.iter().copied(), now);
        let fitting: HashSet<Piece> = order.into_iter().take_while(&mut has_room).collect();
        let fits = |piece: &Piece| fitting.contains(piece);
        wanted.into_iter().filter(fits).collect()
    }

    /// Orders what is missing, as much of it as there is room for.
    pub(super) fn want_missing(&mut self, now: &Now) {
        let Some(staged) = self.coming.as_ref().or(self.shown.as_ref()) else {
            return;
        };
        self.must_ask_anew = false;
        let missing = staged.wanted.iter().copied();
        let missing = missing.filter(|piece| !self.states.is_settled(*piece));
        self.waiting = self.in_order(missing, now);
        let ordered: HashSet<Piece> = self.waiting.iter().copied().collect();
        let before = std::mem::take(&mut self.requested);
        self.hand_out();
        let gone = before.iter().filter(|piece| !ordered.contains(piece));
        let gone: Vec<Piece> = gone.copied().collect();
        self.let_go(&gone);
        for piece in &self.waiting {
            // It is not under way any more, and would have no room.
            if self.states.of(*piece) == Some(UnitState::Requested) {
                self.states.drop(*piece);
            }
        }
        if self.requested != before {
            self.actions
                .push(SessionAction::Want(self.requested.clone()));
        }
    }

    /// Asks for more of what waits, where there is room again.
    pub(super) fn hand_out_more(&mut self) {
        if !self.waiting.is_empty() && self.hand_out() {
            self.actions
                .push(SessionAction::Want(self.requested.clone()));
        }
    }

    /// Whether nothing more comes before the frame that comes is shown: there is no room for it.
    pub(super) fn has_no_room(&self) -> bool {
        self.requested.is_empty() && !self.waiting.is_empty()
    }

    /// Moves what waits to what is asked for, from its head on, as far as there is room. Returns
    /// whether there was any.
    fn hand_out(&mut self) -> bool {
        let units = self.requested.iter().map(|piece| self.unit(*piece));
        let [mut in_flight, mut cached] = units.fold([0, 0], |[bytes, waiting], unit| {
            [bytes + of_unit(&unit), waiting + unit.gpu_bytes]
        });
        let waits = self.coming.is_some();
        if waits && !self.waiting.is_empty() {
            let there = self.states.in_state(UnitState::Cached);
            cached += there.iter().map(|it| self.unit(*it).gpu_bytes).sum::<u64>();
        }
        let mut is_first = self.requested.is_empty();
        let mut fits = |piece: &&Piece| {
            let unit = self.unit(**piece);
            in_flight += of_unit(&unit);
            cached += unit.gpu_bytes;
            let may_wait = !waits || cached <= self.bounds.cached || self.is_base(**piece);
            may_wait && (std::mem::take(&mut is_first) || in_flight <= self.bounds.in_flight)
        };
        let count = self.waiting.iter().take_while(&mut fits).count();
        let more: Vec<Piece> = self.waiting.drain(..count).collect();
        for piece in &more {
            self.states.set(*piece, UnitState::Requested);
        }
        self.requested.extend(more);
        count > 0
    }
}

/// Bytes to fetch, as far as they are known.
fn of_unit(unit: &Unit) -> u64 {
    u64::from(unit.bytes.unwrap_or(0))
}
