//! What does a viewer want of one asset, whatever kind it is of?

use crate::content::head::ContentHead;
use crate::content::payload::Payload;
use crate::content::policy::{HasTables, PolicyConfig};
use crate::content::unit::Unit;
use crate::pack::unit::UnitId;
use crate::pack::{PackError, UnitPlace};
use crate::perception::footprints::Measured;
use crate::perception::moment::Moment;
use crate::units::Seconds;
use crate::view::timeline::Timeline;
use glam::DVec3;
use std::sync::Arc;

/// What is shown of one asset.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chosen {
    /// The units to show, coarsest first: without hole and crack once all of them are there.
    pub units: Vec<UnitId>,
    /// The same, as a log records it.
    pub record: Record,
}

/// What a log records about chosen units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    /// Number of units of each level, finest first.
    pub per_level: Vec<u32>,
    /// What they show, in samples.
    pub samples: u64,
    /// SHA-256 of their places, in hexadecimal.
    pub sha256: String,
}

/// A step that a budget can be spent on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Offer {
    /// Whether it was bought before.
    pub is_held: bool,
    /// What it takes, in bytes.
    pub bytes: u32,
    /// What it is worth to the viewer at the moment; what is not positive is not bought.
    pub value: f64,
}

/// What one viewer wants of one asset. It remembers what its rule needs to be steady, and what it
/// bought.
///
/// The steps of an asset are numbered from 0 and stay the same; what they cost and what they are
/// worth changes with every moment. Buying goes like this: [`Self::begin`] once for a moment, then
/// in each round [`Self::offers`], [`Self::is_missed`] for the steps that would be bought next, and
/// [`Self::buy`]. What chooses by a rule alone says [`Self::needed`] and nothing of buying.
pub trait Demand: core::fmt::Debug + Send {
    /// The units to show of a frame where bytes are not limited, or the policy is a rule.
    fn needed(&mut self, frame: u32, moment: &Moment) -> Chosen;

    /// Whether choosing within `budget` bytes, or without limit, is buying steps.
    fn buys(&self, budget: Option<u64>) -> bool {
        let _ = budget;
        false
    }

    /// For every step those of the same asset that it needs first, at most 16; empty where nothing
    /// is bought.
    fn steps(&self) -> Vec<Vec<u32>> {
        Vec::new()
    }

    /// From now on this is known of units by what was drawn.
    fn see(&mut self, measured: &Measured) {
        let _ = measured;
    }

    /// Looks at a frame and a moment, for buying.
    fn begin(&mut self, frame: u32, moment: &Moment, budget: Option<u64>) {
        let _ = (frame, moment, budget);
    }

    /// What every step costs and is worth, after what was bought so far.
    fn offers(&mut self) -> Vec<Offer> {
        Vec::new()
    }

    /// Whether the next step is still of use after those that were asked for before it in this
    /// round: buying for a score ends where the score is reached.
    fn is_missed(&mut self, step: u32) -> bool {
        let _ = step;
        true
    }

    /// Buys those of the steps that will be seen, and returns what they take in bytes.
    fn buy(&mut self, steps: &[u32]) -> u64 {
        let _ = steps;
        0
    }

    /// The units to show of what was bought.
    fn bought(&mut self) -> Chosen {
        Chosen::default()
    }

    /// Whether what was bought last reaches the score that is asked for, so that more bytes would
    /// buy nothing.
    fn has_reached(&self) -> bool {
        false
    }

    /// The score that what was chosen last is expected to have against every finest unit, in JOD,
    /// once all of it is shown; `None` before any choice and where it is unknown.
    fn expected_jod(&self) -> Option<f64> {
        None
    }
}

/// One asset of a scene, the same for all its viewers: what selection and sessions learn of it,
/// whatever kind it is of. What it need not say is of content without time that is all there.
pub trait Content: core::fmt::Debug + Send + Sync {
    /// Its name, for people and logs.
    fn name(&self) -> &str;

    /// The frames in time; of content without time there is one.
    fn timeline(&self) -> Timeline {
        Timeline::new(&[0], Seconds(1.0))
    }

    /// What is known of a unit.
    fn unit(&self, unit: UnitId) -> Unit;

    /// Where the bytes of a unit lie in the file of the content.
    fn place(&self, unit: UnitId) -> UnitPlace;

    /// Whether a unit will never come, because nothing says where it is.
    fn is_lost(&self, unit: UnitId) -> bool {
        self.place(unit) == UnitPlace::Lost
    }

    /// The units of the coarsest level at a frame: while one of them is missing, there is nothing
    /// to show.
    fn base(&self, frame: u32) -> Vec<UnitId>;

    /// Whether units of the coarsest level stand each by itself, so that the others are shown where
    /// one is damaged.
    fn stands_in_parts(&self) -> bool {
        false
    }

    /// The coarsest level.
    fn coarsest(&self) -> u8;

    /// What errors call the chunk of a unit.
    fn chunk_name(&self, unit: UnitId) -> String {
        format!("chunk of unit {}", unit.0)
    }

    /// What is drawn of a unit whose chunk says so without a codec; `chunk` are its bytes, of which
    /// the checksum is right.
    ///
    /// # Errors
    /// It is damaged, or a codec makes it.
    fn payload(&self, unit: UnitId, chunk: &[u8]) -> Result<Payload, PackError> {
        let _ = chunk;
        Err(PackError {
            field: self.chunk_name(unit),
            found: "coded pictures".to_owned(),
            expected: "what needs no codec".to_owned(),
        })
    }

    /// The unit that shows the place of `unit` at another frame: of content without time the same.
    fn at_frame(&self, unit: UnitId, frame: u32) -> UnitId {
        let _ = frame;
        unit
    }

    /// The units that must be on screen before a unit can be shown, all of lower numbers: a unit
    /// whose prerequisites are missing waits. Of content whose units show by themselves none.
    fn needs(&self, unit: UnitId) -> &[UnitId] {
        let _ = unit;
        &[]
    }

    /// Direction in which a unit is seen by an eye, for what comes first.
    fn direction(&self, unit: UnitId, eye: DVec3) -> DVec3;

    /// Samples of everything at the finest level.
    fn finest_samples(&self) -> u64;

    /// What it knows about its units.
    fn has(&self) -> HasTables;

    /// Whether everything has been loaded by which a policy chooses for a frame.
    fn is_ready(&self, config: &PolicyConfig, frame: u32) -> bool {
        let _ = (config, frame);
        true
    }

    /// Whether what is not loaded yet may still come.
    fn may_become_ready(&self) -> bool {
        true
    }

    /// What one viewer wants of it under a policy, cut as `head` says: as it is, or as a log was. A
    /// head of another kind counts for nothing.
    fn demand(self: Arc<Self>, head: &ContentHead, config: &PolicyConfig) -> Box<dyn Demand>;

    /// How it is cut, as recorded in the head of a log.
    fn head(&self) -> ContentHead;
}
