//! Which units does the policy want for a viewer who goes on looking, and how is that written down?
//!
//! Where something is still missing by which the policy chooses, what was chosen stays for a while,
//! and then another policy stands in. One part of the log follows the other whenever what it stands
//! for changes: the view's size, the zoom, the policy.

use crate::content::demand::{Chosen, Content, Record};
use crate::content::policy::{Policy, PolicyConfig};
use crate::content::unit::{AssetId, UnitRef};
use crate::perception::footprints::{Footprints, Measured};
use crate::perception::moment::Moment;
use crate::selection::scheduler::Scheduler;
use crate::session::budget::Budget;
use crate::session::log::{AssetHead, SessionFrame, SessionHead, SessionLogPart};
use crate::session::recorded::recorded;
use crate::units::{Radians, Seconds};
use crate::view::axes::angle_between;
use crate::view::eye_view::{EyeView, Field};
use crate::view::mounted::MountedPanel;
use std::sync::Arc;

/// What is kept fine outside the view, at most in shares of its width: a window that is zoomed to a
/// corner of the content does not fetch the rest.
const MARGIN_SHARE: f64 = 0.25;
/// How long what was chosen stays where something is awaited, before something else stands in and
/// what was bought is forgotten, in seconds.
const PATIENCE_S: f64 = 0.5;

/// A gaze that moved less has not moved, in degrees.
const STILL_DEG: f64 = 0.05;

/// Chooses under one policy at a time, and writes it down.
#[derive(Debug)]
pub(super) struct PolicyRun {
    scene: Vec<Arc<dyn Content>>,
    /// What is asked for.
    asked: PolicyConfig,
    /// What chooses: what is asked for, or what stands in for it.
    using: PolicyConfig,
    running: Option<(Scheduler, SessionHead)>,
    /// What the link brings; `None` where bytes are not limited.
    budget: Option<Budget>,
    /// When the budget was last asked.
    until: Option<f64>,
    /// What shows the content where that turns with the head: the views of every moment.
    panels: Vec<MountedPanel>,
    /// Whether the margin round the view is cut to its width: where a view can be zoomed.
    zooms: bool,
    /// Something is missing by which a frame is chosen for as it was asked.
    awaited: Option<Vec<u32>>,
    last: Option<Last>,
    measured: MeasuredUnits,
}

/// What is known of the units of each asset by what was drawn.
#[derive(Debug)]
struct MeasuredUnits {
    /// Whether anything is, once something is drawn.
    are_measured: bool,
    /// What was measured last; empty before.
    now: Vec<Measured>,
    /// What the running part of the log records.
    logged: Vec<Footprints>,
    /// Whether something came since the last choice that is not what it was.
    are_new: bool,
}

/// What was chosen last.
#[derive(Debug)]
struct Last {
    /// When, by the clock of gazes.
    at: f64,
    units: Vec<UnitRef>,
}

/// What was chosen.
#[derive(Debug, Default)]
pub(super) struct Picked {
    /// The units to show, of each asset the whole coarsest level first.
    pub(super) units: Vec<UnitRef>,
    /// Lines of the session log.
    pub(super) log: String,
    /// The line of this choice; `None` where nothing new was chosen.
    pub(super) line: Option<SessionFrame>,
}

impl PolicyRun {
    pub(super) fn new(
        scene: Vec<Arc<dyn Content>>,
        asked: PolicyConfig,
        budget: Option<Budget>,
        begins: Option<Seconds>,
        zooms: bool,
        measures: bool,
    ) -> Self {
        Self {
            measured: MeasuredUnits {
                are_measured: measures,
                now: Vec::new(),
                logged: vec![Footprints::default(); scene.len()],
                are_new: false,
            },
            scene,
            using: asked.clone(),
            asked,
            running: None,
            budget,
            until: begins.map(|begins| begins.0),
            panels: Vec::new(),
            zooms,
            awaited: None,
            last: None,
        }
    }

    /// What is asked for.
    pub(super) fn asked(&self) -> &PolicyConfig {
        &self.asked
    }

    /// What chooses: what is asked for, or what stands in for it.
    pub(super) fn using(&self) -> &PolicyConfig {
        &self.using
    }

    /// Chooses by another policy from now on.
    pub(super) fn change(&mut self, config: PolicyConfig) {
        self.asked = PolicyConfig {
            together: !self.panels.is_empty(),
            ..config
        };
        self.awaited = None;
    }

    /// Every moment is seen through these panels, turned with its head.
    pub(super) fn show_on(&mut self, panels: Vec<MountedPanel>) {
        self.panels = panels;
        self.change(self.asked.clone());
        self.using = self.asked.clone();
    }

    /// The link brings so many bytes a second from now on.
    pub(super) fn set_bytes_per_s(&mut self, bytes_per_s: f64) {
        match &mut self.budget {
            Some(budget) => budget.set_rate(bytes_per_s),
            None => self.budget = Some(Budget::new(bytes_per_s)),
        }
    }

    /// The link brought so many bytes besides what was bought.
    pub(super) fn charge(&mut self, bytes: u64) {
        if let Some(budget) = &mut self.budget {
            budget.charge(bytes);
        }
    }

    /// From now on this is known of the units of an asset by what was drawn.
    pub(super) fn see(&mut self, asset: AssetId, measured: Measured) {
        let units = &mut self.measured;
        units.are_new |= units.now.get(usize::from(asset.0)) != Some(&measured);
        units.now.resize(self.scene.len(), Measured::default());
        units.now[usize::from(asset.0)] = measured;
    }

    /// Whether choosing takes what parts of the view units would refine.
    pub(super) fn needs_footprints(&self) -> bool {
        self.measured.are_measured && self.using.policy == Policy::Perceptual
    }

    /// Whether the picture stands from now on, and may wait for what takes long to arrive.
    pub(super) fn stand(&mut self, stands: bool) {
        if let Some(budget) = &mut self.budget {
            budget.stand(stands);
        }
    }

    /// What is spent counts from here.
    pub(super) fn begin_at(&mut self, time: Seconds) {
        self.until = Some(time.0);
    }

    /// The score that what was chosen last is expected to have.
    pub(super) fn expected_jod(&self) -> Option<f64> {
        self.running.as_ref()?.0.expected_jod()
    }

    /// Whether what was bought last reaches the score that is asked for.
    pub(super) fn has_reached(&self) -> bool {
        let has_reached = |(scheduler, _): &(Scheduler, _)| scheduler.has_reached();
        self.running.as_ref().is_some_and(has_reached)
    }

    /// Whether what was asked for waits for what it needs, and something else stands in.
    pub(super) fn waits(&self) -> bool {
        self.awaited.is_some() && self.scene.iter().all(|asset| asset.may_become_ready())
    }

    fn is_ready(&self, frames: &[u32]) -> bool {
        let mut assets = self.scene.iter().zip(frames);
        assets.all(|(asset, frame)| asset.is_ready(&self.asked, *frame))
    }

    fn spends(&self) -> bool {
        self.using.policy.spends_a_budget()
    }

    /// Whether what was chosen last stays while something is awaited.
    fn keeps(&self, now: f64) -> bool {
        let last = self.last.as_ref().filter(|_| self.using == self.asked);
        last.is_some_and(|last| (0.0..PATIENCE_S).contains(&(now - last.at)))
    }

    /// Whether what a choice waited for is there, or more may be bought.
    fn may_go_on(&self, now: f64) -> bool {
        if let Some(frames) = &self.awaited {
            if !self.waits() {
                return false;
            }
            let has_waited = self.using == self.asked && self.last.is_some() && !self.keeps(now);
            return self.is_ready(frames) || has_waited;
        }
        let saves_up = self.budget.as_ref().is_some_and(|budget| !budget.is_done());
        self.spends() && saves_up && !self.has_reached()
    }

    /// Whether the choice for `now` could be another than for `before`.
    pub(super) fn differs(&self, now: &Moment, before: &Moment) -> bool {
        let are_new = self.measured.are_new && self.needs_footprints();
        are_new || self.may_go_on(now.gaze.time.0) || differs(now, before, self.asked.policy)
    }

    /// Goes over to what is asked for, or to what stands in, whichever can choose now.
    fn go_over(&mut self, is_ready: bool) {
        let config = match is_ready {
            true => self.asked.clone(),
            false => self.asked.without_signatures(),
        };
        if self.using != config {
            self.using = config;
            self.running = None;
        }
    }

    /// Bytes of what was chosen so far for these frames, where the choice starts over, as under
    /// another policy or through another view: they are here or under way, and cost nothing more.
    fn paid(&self, frames: &[u32], head: &SessionHead) -> u64 {
        let mut running = self.running.iter();
        if running.any(|(_, running)| running == head) {
            return 0;
        }
        let bytes = self.last_at(frames).into_iter().map(|unit| {
            let content = &self.scene[usize::from(unit.asset.0)];
            let unit = content.unit(unit.unit);
            match unit.level < content.coarsest() {
                true => u64::from(unit.bytes.unwrap_or(0)),
                false => 0,
            }
        });
        bytes.sum()
    }

    /// What to show of the frames, one of each asset; what is brought until `until` can be spent.
    ///
    /// # Panics
    /// A policy that spends a budget needs content that knows what its units add.
    pub(super) fn choose(&mut self, frames: &[u32], moment: &Moment, until: Seconds) -> Picked {
        let now = moment.gaze.time.0;
        let is_ready = self.is_ready(frames);
        self.awaited = (!is_ready).then(|| frames.to_vec());
        if !is_ready && self.keeps(now) {
            return Picked {
                units: self.last_at(frames),
                ..Picked::default()
            };
        }
        self.go_over(is_ready);
        if self.spends() && !is_ready {
            // Nothing stands in for what weighs bytes alone.
            self.last = None;
            return Picked {
                units: self.base(frames),
                ..Picked::default()
            };
        }
        let passed = until.0 - self.until.replace(until.0).unwrap_or(until.0);
        let head = self.head(moment);
        let paid = self.paid(frames, &head);
        let spends = self.spends();
        let mut budget = self.budget.as_mut().filter(|_| spends);
        let bytes = budget.as_mut().map(|budget| {
            let saved = budget.after(Seconds(passed));
            saved.saturating_add(paid)
        });
        // What is hidden is not known before something is drawn.
        let is_blind = self.needs_footprints() && self.measured.now.is_empty();
        let bytes = if is_blind { Some(0) } else { bytes };
        let picked = self.pick(head, frames, moment, bytes);
        if let Some(budget) = self.budget.as_mut().filter(|_| spends) {
            let spent = self.running.as_ref().map_or(0, |(it, _)| it.spent());
            budget.spend(spent.saturating_sub(paid));
        }
        self.last = Some(Last {
            at: now,
            units: picked.units.clone(),
        });
        picked
    }

    /// The units that show at these frames what was chosen last.
    fn last_at(&self, frames: &[u32]) -> Vec<UnitRef> {
        let units = self.last.iter().flat_map(|last| &last.units);
        let at = units.map(|UnitRef { asset, unit }| {
            let number = usize::from(asset.0);
            UnitRef {
                asset: *asset,
                unit: self.scene[number].at_frame(*unit, frames[number]),
            }
        });
        at.collect()
    }

    /// The coarsest level of everything.
    fn base(&self, frames: &[u32]) -> Vec<UnitRef> {
        let assets = (0..).map(AssetId).zip(&self.scene).zip(frames);
        let units = assets.flat_map(|((asset, content), frame)| {
            let base = content.base(*frame).into_iter();
            base.map(move |unit| UnitRef { asset, unit })
        });
        units.collect()
    }

    fn pick(
        &mut self,
        head: SessionHead,
        frames: &[u32],
        moment: &Moment,
        budget: Option<u64>,
    ) -> Picked {
        let mut log = String::new();
        let needs_footprints = self.needs_footprints();
        let goes_on = |(_, running): &(Scheduler, SessionHead)| *running == head;
        if !self.running.as_ref().is_some_and(goes_on) {
            let part = SessionLogPart {
                head: head.clone(),
                frames: Vec::new(),
            };
            log = part.write();
            self.running = None;
            self.measured.logged.fill(Footprints::default());
        }
        let (scheduler, head) = self.running.get_or_insert_with(|| {
            let demand =
                |asset: &Arc<dyn Content>| Arc::clone(asset).demand(&asset.head(), &head.policy);
            let demands = self.scene.iter().map(demand).collect();
            (Scheduler::new(&head.policy, demands), head)
        });
        let mut changes = Vec::new();
        if needs_footprints {
            let units = &mut self.measured;
            units.are_new = false;
            for (asset, now) in units.now.iter().enumerate() {
                let recorded = recorded(now);
                changes.push(recorded.since(&units.logged[asset]));
                scheduler.see(asset, now);
                units.logged[asset] = recorded;
            }
        }
        let chosen = scheduler.choose(frames, moment, budget);
        let records: Vec<&Record> = chosen.iter().map(|chosen| &chosen.record).collect();
        let line = SessionFrame::of_scene(frames, moment, budget, &records).under(head);
        let line = (0..).zip(changes).fold(line, |line, (asset, changes)| {
            line.with_footprints(asset, changes)
        });
        log.push_str(&line.write());
        let assets = (0..).map(AssetId).zip(chosen);
        let units = assets.flat_map(|(asset, Chosen { units, .. })| {
            let units = units.into_iter();
            units.map(move |unit| UnitRef { asset, unit })
        });
        Picked {
            units: units.collect(),
            log,
            line: Some(line),
        }
    }

    /// The head of the part of the log that a choice for `moment` belongs to.
    pub(super) fn head(&self, moment: &Moment) -> SessionHead {
        let across = |view: &EyeView| {
            let Field { left, right, .. } = view.field;
            (libm::atan(left) + libm::atan(right)).abs() * MARGIN_SHARE
        };
        let views = moment.views.iter().filter(|_| self.zooms);
        let margin = views.map(across).fold(self.using.margin.0, f64::min);
        let config = PolicyConfig {
            margin: Radians(margin),
            ..self.using.clone()
        };
        let (content, more) = (&self.scene[0], self.scene.iter().skip(1));
        let more = more.map(|content| AssetHead {
            pack: content.name().to_owned(),
            content: content.head(),
        });
        let head = SessionHead::new(content.name(), content.head(), config, &moment.views);
        SessionHead {
            more: more.collect(),
            ..head.on_panels(&self.panels)
        }
    }
}

/// Whether a policy that spends no budget could choose otherwise for one moment than for another.
fn differs(now: &Moment, before: &Moment, policy: Policy) -> bool {
    let moved = angle_between(now.gaze.gaze_in_content, before.gaze.gaze_in_content);
    let gaze_counts = !matches!(
        policy,
        Policy::Full | Policy::Coarsest | Policy::Viewport | Policy::Uniform
    );
    now.views != before.views || gaze_counts && moved.to_degrees() > STILL_DEG
}
