//! How is one picture made, with all that it takes?

use crate::error::PlayError;
use crate::player::Player;
use foveal_core::content::unit::{AssetId, UnitRef};
use foveal_core::pack::unit::UnitId;
use foveal_core::perception::moment::Moment;
use foveal_core::session::actions::{Now, Pace, SessionEvent};
use foveal_core::session::decoder::{DecodeError, Decoded};
use foveal_core::session::log::SessionFrame;
use foveal_core::session::unit_states::Piece;
use std::collections::HashSet;
use std::time::{Duration, Instant};

/// How long a player sleeps at most until it takes what has been decoded.
const TAKEN_EVERY: Duration = Duration::from_millis(4);
/// Rounds in which what came is shown and more is asked for, at one time: where little may be under
/// way at once, more takes another round.
const MOST_ROUNDS: u32 = 10_000;

/// What making a picture took.
#[derive(Clone, Debug, Default)]
pub struct Made {
    /// What was chosen, as the log records it; `None` where the choice before still holds.
    pub chosen: Option<Box<SessionFrame>>,
    /// The units to be shown, whether they came or not.
    pub wanted: Vec<UnitRef>,
    /// Number of units on screen of each level, finest first.
    pub units_by_level: Vec<u32>,
    /// Bytes of units that this run had not needed before.
    pub new_bytes: u64,
    /// Bytes of the pages of a scene's index and table that cover them.
    pub page_bytes: u64,
    /// Samples decoded, those to catch up included.
    pub decoded_samples: u64,
    /// Frames of units decoded, those to catch up included.
    pub decodes: u32,
    /// Pieces that could not be decoded.
    pub damaged: usize,
    /// Time of choosing.
    pub choose: Duration,
    /// From asking for pieces until the last was there.
    pub decode: Duration,
    /// Time of bringing them to where they are drawn from.
    pub upload: Duration,
    /// Time of all of that.
    pub total: Duration,
}

impl Player {
    /// Makes the picture of a moment: chooses, fetches and decodes what is missing and hands it to
    /// what draws. At [`Pace::FrameByFrame`] that is frame `tick` by itself, which waits for finer
    /// units at most `patience`; at [`Pace::Standing`] a picture that is refined until nothing is
    /// missing.
    ///
    /// # Errors
    /// Nothing can be shown because of damage, or the device was lost.
    pub fn make(
        &mut self,
        tick: u64,
        now: &Now,
        patience: Option<Duration>,
    ) -> Result<Made, PlayError> {
        let begun = Instant::now();
        let mut made = Made::default();
        self.leave_room(&now.moment)?;
        let is_single = now.pace == Pace::FrameByFrame;
        let over = Now {
            pace: Pace::FrameIsOver,
            ..now.clone()
        };
        let mut has_measured = false;
        for round in 0..MOST_ROUNDS {
            if !has_measured && self.session.shown_tick().is_some() {
                self.measure(&now.moment)?;
                has_measured = true;
            }
            let evicted = self.drawer.take_evicted();
            self.tell_session(evicted);
            let stepping = Instant::now();
            let actions = match (is_single, round) {
                (true, 0) => self.session.begin_frame(tick, now),
                (true, _) => self.session.step(&over),
                (false, _) => self.session.step(now),
            };
            if round == 0 {
                made.choose = stepping.elapsed();
            }
            // Workers begin while the rest is asked for.
            let asking = Instant::now();
            let stepped = self.perform(actions, now)?;
            self.run.log.push_str(&stepped.log);
            made.chosen = stepped.chosen.or(made.chosen);
            let is_last = if is_single {
                round > 0
            } else {
                self.session.requested().is_empty()
            };
            if round > 0 {
                made.upload += stepping.elapsed();
            }
            if is_last {
                break;
            }
            let decoding = match round {
                0 => asking,
                _ => Instant::now(),
            };
            self.fetch(&mut made);
            self.decode(patience.map(|it| (begun, it)), &mut made)?;
            made.decode += decoding.elapsed();
        }
        self.session.take(SessionEvent::Charged {
            bytes: made.page_bytes,
        });
        let wanted = self.session.wanted().map_or(&[][..], |(_, wanted)| wanted);
        made.wanted = wanted.iter().map(|piece| piece.unit).collect();
        made.units_by_level = self.session.figures().histogram.clone();
        made.total = begun.elapsed();
        Ok(made)
    }

    /// Gives the session what parts of the view units would refine.
    fn measure(&mut self, moment: &Moment) -> Result<(), PlayError> {
        let events = match &mut self.run.rendered {
            Some(rendered) => vec![SessionEvent::Measured {
                asset: AssetId::ONLY,
                measured: rendered.measured(moment)?,
            }],
            None => self.drawer.measure_now(&self.session, moment)?,
        };
        self.tell_session(events);
        Ok(())
    }

    /// Counts what is asked for.
    fn fetch(&mut self, made: &mut Made) {
        let content = self.opened.content();
        for piece in self.session.requested() {
            let unit = piece.unit.unit;
            if let Some(scene) = self.opened.scene() {
                let pages = scene.pack().pages_of(unit).into_iter();
                let new = pages.zip(&mut self.run.pages);
                let new = new.filter_map(|((page, bytes), it)| it.insert(page).then_some(bytes));
                made.page_bytes += new.sum::<u64>();
            }
            if self.run.fetched.insert(unit) {
                made.new_bytes += u64::from(content.unit(unit).bytes.unwrap_or_default());
            }
        }
    }

    /// Waits for what was asked for; once all that is needed in any case is there, at most until
    /// so long after a beginning.
    fn decode(
        &mut self,
        patience: Option<(Instant, Duration)>,
        made: &mut Made,
    ) -> Result<(), PlayError> {
        let content = self.opened.content();
        let is_base = |piece: &Piece| content.unit(piece.unit.unit).level == content.coarsest();
        let mut left: HashSet<Piece> = self.session.requested().iter().copied().collect();
        let mut base = left.iter().filter(|piece| is_base(piece)).count();
        let until_due = || {
            patience.map(|(begun, most): (Instant, Duration)| most.saturating_sub(begun.elapsed()))
        };
        let mut has_waited = false;
        while !left.is_empty() {
            let patience = until_due().filter(|_| base == 0);
            let is_due = patience == Some(Duration::ZERO);
            // What is there is taken a few times a frame: all of it at the end would take long.
            let decoded = match self.supply.next(Some(Duration::ZERO)) {
                None if !has_waited && !is_due => {
                    let most = patience.map_or(TAKEN_EVERY, |it| it.min(TAKEN_EVERY));
                    self.supply.wait_for_all(Some(most));
                    has_waited = true;
                    continue;
                }
                None => self.supply.next(patience),
                decoded => decoded,
            };
            let Some(decoded) = decoded else {
                break;
            };
            has_waited = false;
            // Others are of an earlier order, and came too late for it.
            if !left.remove(&decoded.piece) {
                continue;
            }
            base -= usize::from(is_base(&decoded.piece));
            let samples = content.unit(decoded.piece.unit.unit).samples;
            made.decoded_samples += u64::from(decoded.frames) * samples;
            made.decodes += decoded.frames;
            made.damaged += usize::from(decoded.payload.is_err());
            self.take_or_stop(decoded)?;
        }
        self.supply.want(&[]);
        Ok(())
    }

    /// Takes a piece that came; fails where nothing can be shown without it.
    fn take_or_stop(&mut self, decoded: Decoded) -> Result<(), PlayError> {
        let piece = decoded.piece;
        let is_damaged = matches!(decoded.payload, Err(DecodeError::Damaged(_)));
        if is_damaged && self.leaves_nothing(piece) {
            let Err(DecodeError::Damaged(source)) = decoded.payload else {
                return Ok(());
            };
            let content = self.opened.content();
            return Err(match content.stands_in_parts() {
                true => PlayError::Damaged(source),
                false => PlayError::Coarsest {
                    pack: content.name().to_owned(),
                    frame: piece.frame,
                    source,
                },
            });
        }
        self.receive(decoded)
    }

    /// Whether nothing at all can be shown once a piece is damaged, too.
    fn leaves_nothing(&mut self, piece: Piece) -> bool {
        let unit = piece.unit.unit;
        let roots = self.opened.roots(piece.frame);
        if !roots.contains(&unit) {
            return false;
        }
        let damaged = &mut self.run.damaged_roots;
        damaged.insert(unit);
        !self.opened.content().stands_in_parts() || damaged.len() == roots.len()
    }

    /// The session log of the pictures that were made.
    #[must_use]
    pub fn log(&self) -> &str {
        &self.run.log
    }

    /// The units that were needed so far.
    pub fn fetched(&self) -> impl Iterator<Item = UnitId> {
        self.run.fetched.iter().copied()
    }

    /// Whether a first picture shows only the roots: what parts of the view units would refine, by
    /// which `perceptual` chooses, is measured on what was drawn before.
    #[must_use]
    pub fn first_is_blind(&self) -> bool {
        self.session.needs_footprints()
    }
}
