//! When is a frame shown, with what, and what of the rest stays on the GPU?

use super::{Session, Staged};
use crate::content::unit::{AssetId, UnitRef};
use crate::session::actions::{Now, Pace, SessionAction};
use crate::session::client_memory::worth_of;
use crate::session::figures::FrameOutcome;
use crate::session::unit_states::{Piece, UnitState};
use std::collections::HashSet;

/// How long a paused picture may stay as it is before the next one is shown unfinished.
const PATIENCE_S: f64 = 0.25;
/// Longest time that a frame is begun ahead of its own.
const MOST_LEAD_S: f64 = 1.0;

impl Session {
    pub(super) fn is_due(&self, now: &Now) -> bool {
        let Some(coming) = &self.coming else {
            return false;
        };
        let mut base = (0..)
            .map(AssetId)
            .zip(&self.scene)
            .flat_map(|(asset, content)| {
                let frame = coming.frames[usize::from(asset.0)];
                let units = content.base(frame).into_iter();
                units.map(move |unit| UnitRef { asset, unit })
            });
        let is_cached = |unit| {
            self.states.of(coming.piece(unit)) == Some(UnitState::Cached)
                || self.states.is_resident(coming.piece(unit))
        };
        if coming.wanted.is_empty() || !base.all(is_cached) {
            return false;
        }
        match now.pace {
            Pace::Playing => now.media.0 + 1e-4 >= self.timeline.time_of(coming.tick).0,
            Pace::Standing => {
                let waited = now.wall.0 - coming.begun;
                coming.complete.is_some() || self.shown.is_none() || waited > PATIENCE_S
            }
            Pace::FrameByFrame => coming.complete.is_some(),
            Pace::FrameIsOver => true,
        }
    }

    /// Shows the frame that came, with the units that are there.
    pub(super) fn present(&mut self, now: &Now) {
        let Some(coming) = self.coming.take() else {
            return;
        };
        self.actions.push(SessionAction::BeginFrame(coming.frame));
        self.show_again(coming.wanted.clone());
        let cached = |piece: &&Piece| self.states.of(**piece) == Some(UnitState::Cached);
        let cached: Vec<Piece> = coming.wanted.iter().filter(cached).copied().collect();
        self.held_back.clear();
        cached
            .into_iter()
            .for_each(|piece| self.show_arrived(piece, false));
        let before = self.shown.take();
        let playing = now.pace == Pace::Playing;
        if playing {
            self.learn_lead(now, &coming);
        }
        let overdue = now.media.0 > self.timeline.time_of(coming.tick + 1).0;
        let left_out = match &before {
            Some(before) if playing && !self.jumped => coming.tick.saturating_sub(before.tick + 1),
            _ => 0,
        };
        let follows = playing && before.is_some();
        let is_missing = |piece: &Piece| !self.states.is_settled(*piece);
        let outcome = FrameOutcome {
            left_out,
            late: follows && overdue,
            incomplete: follows && coming.wanted.iter().any(is_missing),
        };
        self.figures.shown(now.wall, outcome);
        let is_whole = self.waiting.is_empty();
        self.shown = Some(Staged {
            complete: coming.complete.filter(|_| is_whole),
            ..coming
        });
        self.show_no_others();
        // What was still to come of the frame before does not come any more.
        self.let_go(&before.map(|before| before.wanted).unwrap_or_default());
        self.jumped = false;
        self.count();
    }

    /// Shows nothing but the frame on screen and what the one that comes shows of it already.
    pub(super) fn show_no_others(&mut self) {
        let coming = self.coming.as_ref().map(|coming| coming.shows.clone());
        self.keep_shown(&coming.unwrap_or_default(), 0);
    }

    /// Shows again what stayed on the GPU of these pieces.
    pub(super) fn show_again(&mut self, wanted: Vec<Piece>) {
        let stayed = wanted.into_iter();
        let stayed = stayed.filter(|piece| self.states.of(*piece) == Some(UnitState::Resident));
        for piece in self.needs_first(stayed.collect()) {
            self.states.set(piece, UnitState::Shown);
            self.staying.remove(&piece);
            self.uncounted = true;
            self.actions.push(SessionAction::Show(piece));
        }
    }

    /// Evicts where a piece would not fit next to what is there: first what merely stays, and then
    /// all that the frame on screen does not show.
    pub(super) fn make_room(&mut self, piece: Piece) {
        let bytes = self.unit(piece).gpu_bytes;
        self.leave_room(bytes);
        if self.resident_bytes + bytes > self.bounds.gpu {
            self.keep_shown(&HashSet::new(), bytes);
            // What the frame that comes had there is to be fetched again.
            if let Some(coming) = &mut self.coming {
                coming.complete = None;
                self.must_ask_anew = true;
            }
        }
    }

    /// Evicts what merely stays where so many bytes would not fit next to it.
    pub(super) fn leave_room(&mut self, bytes: u64) {
        if self.resident_bytes + bytes > self.bounds.gpu && !self.staying.is_empty() {
            let shown = self.states.in_state(UnitState::Shown);
            self.keep_shown(&shown.into_iter().collect(), bytes);
        }
    }

    /// Shows nothing but the frame on screen and these; what else is there of that frame stays as
    /// far as there is room for it next to so many bytes.
    fn keep_shown(&mut self, others: &HashSet<Piece>, bytes: u64) {
        let Some(shown) = &self.shown else {
            return;
        };
        let (mut kept, mut idle, mut gone) = (Vec::new(), Vec::new(), Vec::new());
        for piece in self.states.resident() {
            let stays = shown.shows.contains(&piece) || others.contains(&piece);
            let is_now = shown.frames[usize::from(piece.unit.asset.0)] == piece.frame;
            match (stays && self.states.is_shown(piece), is_now) {
                (true, _) => kept.push(piece),
                (false, true) => idle.push(piece),
                (false, false) => gone.push(piece),
            }
        }
        let kept_bytes = kept.iter().map(|piece| self.unit(*piece).gpu_bytes);
        let mut taken = bytes + kept_bytes.sum::<u64>();
        let mut staying = Vec::new();
        for piece in self.by_worth(idle) {
            taken += self.unit(piece).gpu_bytes;
            match taken <= self.bounds.gpu {
                true => staying.push(piece),
                false => gone.push(piece),
            }
        }
        gone.into_iter().for_each(|piece| self.lose(piece));
        for piece in &staying {
            if self.states.is_shown(*piece) {
                self.states.set(*piece, UnitState::Resident);
                self.staying.insert(*piece, self.memory.choice());
            }
        }
        self.uncounted = true;
        let [shown, staying] = [kept, staying].map(|pieces| {
            let units = pieces.into_iter().map(|piece| piece.unit);
            units.collect()
        });
        self.actions.push(SessionAction::Keep { shown, staying });
    }

    /// Pieces that the picture is made without, first what is to stay longest: what the frame that
    /// comes shows, then what is worth most; each after those that it needs.
    fn by_worth(&self, pieces: Vec<Piece>) -> Vec<Piece> {
        let coming = self.coming.as_ref();
        let choice = self.memory.choice();
        let mut ranked: Vec<(bool, u64, Piece)> = pieces
            .into_iter()
            .map(|piece| {
                let chosen = self.staying.get(&piece).copied().unwrap_or(choice);
                let is_awaited = coming.is_some_and(|it| it.shows.contains(&piece));
                let worth = worth_of(self.unit(piece).level, chosen);
                (!is_awaited, u64::MAX - worth, piece)
            })
            .collect();
        ranked.sort_unstable();
        self.needs_first(ranked.into_iter().map(|(.., piece)| piece).collect())
    }

    /// A piece is not on the GPU any more.
    pub(super) fn lose(&mut self, piece: Piece) {
        if !self.states.is_resident(piece) {
            return;
        }
        self.states.drop(piece);
        self.staying.remove(&piece);
        self.resident_bytes -= self.unit(piece).gpu_bytes;
        for staged in [&mut self.shown, &mut self.coming].into_iter().flatten() {
            if staged.shows.contains(&piece) {
                staged.complete = None;
                self.must_ask_anew = true;
            }
        }
    }

    /// Shows no more what is not wanted any more once all that is wanted is there.
    pub(super) fn settle(&mut self, now: &Now) {
        let Some(shown) = &mut self.shown else {
            return;
        };
        if shown.complete.is_none() && shown.is_whole(&self.states) {
            shown.complete = Some(now.wall.0);
        }
        let coming = self.coming.as_ref();
        let is_awaited = |piece: &Piece| coming.is_some_and(|it| it.shows.contains(piece));
        let stale = |piece: &Piece| !shown.shows.contains(piece) && !is_awaited(piece);
        if shown.complete.is_some() && self.states.in_state(UnitState::Shown).iter().any(stale) {
            self.show_no_others();
        }
        if self.uncounted {
            self.count();
        }
    }

    /// Begins frames earlier when they come after their time, though no earlier than they are on
    /// their way, and later again when they wait for it: a stall does not slow what follows.
    fn learn_lead(&mut self, now: &Now, shown: &Staged) {
        let [begin, end] = [shown.tick, shown.tick + 1].map(|tick| self.timeline.time_of(tick).0);
        let late = now.media.0 - end;
        self.lead = if late > 0.0 {
            let on_its_way = now.wall.0 - shown.begun;
            let longer = self.lead + 0.5 * (now.media.0 - begin);
            longer.min(on_its_way).min(MOST_LEAD_S)
        } else {
            let waited = shown.complete.map_or(0.0, |complete| now.wall.0 - complete);
            (self.lead * 0.95 - 0.5 * waited).max(0.0)
        };
    }

    /// Counts what is on screen.
    pub(super) fn count(&mut self) {
        self.uncounted = false;
        let coarsest = self.scene.iter().map(|asset| asset.coarsest()).max();
        let mut per_level = vec![0; usize::from(coarsest.unwrap_or(0)) + 1];
        let mut samples = 0;
        for piece in self.states.in_state(UnitState::Shown) {
            let asset = &self.scene[usize::from(piece.unit.asset.0)];
            let unit = asset.unit(piece.unit.unit);
            per_level[usize::from(unit.level)] += 1;
            samples += unit.samples;
        }
        let finest: u64 = self.scene.iter().map(|asset| asset.finest_samples()).sum();
        self.figures.histogram = per_level;
        self.figures.share = samples as f64 / finest as f64;
        self.actions.push(SessionAction::Count);
    }
}
