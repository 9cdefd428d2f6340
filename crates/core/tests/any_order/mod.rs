//! A session whose wishes are fulfilled in any order, and what must hold whatever happens. The same
//! schedules run natively and in wasm.

mod film;
#[path = "../looking/mod.rs"]
mod looking;
#[path = "../made_video/mod.rs"]
mod made_video;

use film::Film;
use foveal_core::content::demand::Content;
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::content::unit::{AssetId, UnitRef};
use foveal_core::content::video::Video;
use foveal_core::pack::PackError;
use foveal_core::pack::unit::UnitId;
use foveal_core::session::actions::{Now, Pace, SessionAction, SessionEvent};
use foveal_core::session::bounds::Bounds;
use foveal_core::session::session::{Session, SessionSettings};
use foveal_core::session::unit_states::{Piece, UnitState};
use foveal_core::view::random::Random;
use foveal_core::view::surface::Projection;
use looking::looking;
use made_video::Made;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// Steps of a schedule, before all comes that is asked for.
const STEPS: u32 = 32;
/// Steps within which a picture that stays is whole, once all comes.
const PATIENCE: u32 = 120;

/// Something that is under way.
struct Delivery {
    at: f64,
    piece: Piece,
    is_damaged: bool,
}

/// FNV-1a of all that is written.
struct Digest(u64);

impl Write for Digest {
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        for byte in text.bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
        Ok(())
    }
}

/// What schedules are run on: made once, as all viewers share it.
pub(crate) struct Stage {
    video: Arc<Video>,
}

impl Stage {
    /// # Errors
    /// What the video cannot be.
    pub(crate) fn new() -> Result<Self, PackError> {
        let made = Made::new(Projection::Flat, [100, 60], 16);
        Ok(Self {
            video: made.build()?,
        })
    }

    /// Runs the schedule of a seed, and returns a hash of all that the session did.
    ///
    /// # Panics
    /// Something that must hold did not.
    pub(crate) fn run(&self, seed: u64) -> u64 {
        let mut world = World::new(self, seed);
        for _ in 0..STEPS {
            match world.is_frame_by_frame {
                true => world.play_frame(),
                false => world.play(),
            }
        }
        if !world.is_frame_by_frame {
            world.come_to_rest();
        }
        world.digest.0
    }
}

/// A session, and all that is outside of it.
struct World {
    seed: u64,
    session: Session,
    scene: Vec<Arc<dyn Content>>,
    films: Vec<Film>,
    policies: &'static [Policy],
    bounds: Bounds,
    is_frame_by_frame: bool,
    random: Random,
    now: f64,
    media: f64,
    plays: bool,
    gaze: [f64; 2],
    under_way: Vec<Delivery>,
    /// What was decoded, and waits outside to be uploaded or dropped.
    held: BTreeSet<Piece>,
    /// What was uploaded.
    gpu: BTreeMap<UnitRef, u32>,
    /// What of it is not shown, first what is to stay longest.
    idle: Vec<UnitRef>,
    digest: Digest,
}

const RULES: [Policy; 3] = [Policy::Full, Policy::Coarsest, Policy::Acuity];
const ALL: [Policy; 5] = [
    Policy::Full,
    Policy::Coarsest,
    Policy::Acuity,
    Policy::Perceptual,
    Policy::Uniform,
];

impl World {
    fn new(stage: &Stage, seed: u64) -> Self {
        let mut random = Random::new(seed);
        let lost = (random.unit() < 0.1).then_some(UnitId(7));
        let (films, has_video) = match seed % 8 {
            // What is bought is weighed, which takes long.
            0 if seed.is_multiple_of(256) => (Vec::new(), true),
            1 if seed % 64 == 1 => (vec![Film::new(1, lost)], true),
            2 => (vec![Film::new(1, lost)], false),
            3 | 4 => (vec![Film::new(1, None), Film::new(13, lost)], false),
            _ => (vec![Film::new(13, lost)], false),
        };
        let mut scene: Vec<Arc<dyn Content>> = Vec::new();
        for film in &films {
            scene.push(Arc::new(film.clone()));
        }
        if has_video {
            scene.push(Arc::clone(&stage.video) as Arc<dyn Content>);
        }
        let mut bound = |least: f64, most: f64| match random.unit() < 0.4 {
            true => (least + random.unit() * (most - least)) as u64,
            false => u64::MAX >> 1,
        };
        let bounds = Bounds {
            in_flight: bound(50.0, 3_000.0),
            cached: bound(1_000.0, 40_000.0),
            gpu: bound(1_000.0, 40_000.0),
            client: bound(1_000.0, 40_000.0),
        };
        let settings = SessionSettings {
            policy: PolicyConfig::new(Policy::Acuity),
            bytes_per_s: Some(20_000.0),
            since: None,
            zooms: false,
            measures: false,
            bounds,
        };
        Self {
            seed,
            session: Session::new(scene.clone(), settings),
            scene,
            policies: if films.is_empty() { &ALL } else { &RULES },
            films,
            bounds,
            is_frame_by_frame: seed % 16 == 5,
            random,
            now: 0.0,
            media: 0.0,
            plays: true,
            gaze: [0.0; 2],
            under_way: Vec::new(),
            held: BTreeSet::new(),
            gpu: BTreeMap::new(),
            idle: Vec::new(),
            digest: Digest(0xcbf2_9ce4_8422_2325),
        }
    }

    fn chance(&mut self, of: f64) -> bool {
        self.random.unit() < of
    }

    fn below(&mut self, count: f64) -> f64 {
        self.random.unit() * count
    }

    /// Something may happen, something may come, and the session moves on.
    fn play(&mut self) {
        self.meddle();
        self.deliver();
        self.evict();
        let pace = match self.plays {
            true => Pace::Playing,
            false => Pace::Standing,
        };
        self.step(pace);
        let passed = [0.002, 0.01, 0.04, 0.3][self.below(4.0) as usize];
        self.now += passed;
        self.media += if self.plays { passed } else { 0.0 };
    }

    /// A frame is made by itself.
    fn play_frame(&mut self) {
        let tick = self.below(30.0) as u64;
        let now = self.at(Pace::FrameByFrame);
        let actions = self.session.begin_frame(tick, &now);
        self.obey(actions);
        for _ in 0..self.below(6.0) as u32 {
            self.now += 0.05;
            self.deliver();
            self.step(Pace::FrameByFrame);
        }
        self.deliver();
        self.step(Pace::FrameIsOver);
    }

    fn meddle(&mut self) {
        if self.chance(0.3) {
            self.gaze = [self.below(2.0) - 1.0, self.below(1.0) - 0.5];
        }
        if self.chance(0.05) {
            let policy = self.policies[self.below(self.policies.len() as f64) as usize];
            let config = Box::new(PolicyConfig::new(policy));
            self.session.take(SessionEvent::PolicyChosen(config));
        }
        if self.chance(0.05) {
            self.media = self.below(3.0);
            self.session.take(SessionEvent::Jumped);
        }
        if self.chance(0.07) {
            self.plays = !self.plays;
        }
        if self.chance(0.02) {
            self.gpu.clear();
            self.idle.clear();
            self.session.take(SessionEvent::DeviceLost);
        }
        if self.chance(0.03) {
            for film in &self.films {
                film.lacks.fetch_xor(true, Ordering::Relaxed);
            }
        }
        if self.chance(0.05) {
            let now = self.at(Pace::Playing);
            self.session.pass(self.now as u64, &now);
        }
    }

    /// What is due comes.
    fn deliver(&mut self) {
        let now = self.now;
        let under_way = std::mem::take(&mut self.under_way);
        let (due, later) = under_way.into_iter().partition(|it| it.at <= now);
        self.under_way = later;
        for delivery in Vec::<Delivery>::into_iter(due) {
            self.bring(delivery.piece, delivery.is_damaged);
        }
    }

    fn bring(&mut self, piece: Piece, is_damaged: bool) {
        let frames = 1;
        if is_damaged {
            return self.session.take(SessionEvent::Damaged { piece, frames });
        }
        // One that is there already is replaced.
        self.held.insert(piece);
        self.session.take(SessionEvent::Decoded { piece, frames });
    }

    /// Some of what stays gives way, as where its place is needed.
    fn evict(&mut self) {
        let mut evicted = Vec::new();
        while self.chance(0.3) {
            let Some(unit) = self.idle.pop() else { break };
            let frame = self.gpu.remove(&unit);
            evicted.extend(frame.map(|frame| Piece { unit, frame }));
        }
        if !evicted.is_empty() {
            self.session.take(SessionEvent::Evicted(evicted));
        }
    }

    fn at(&self, pace: Pace) -> Now {
        looking(self.now, self.media, pace, self.gaze, 64)
    }

    fn step(&mut self, pace: Pace) {
        let now = self.at(pace);
        let actions = self.session.step(&now);
        self.obey(actions);
        self.check();
    }

    fn obey(&mut self, actions: Vec<SessionAction>) {
        for action in actions {
            let _ = write!(self.digest, "{action:?}");
            match action {
                SessionAction::Want(pieces) => self.want(&pieces),
                SessionAction::Upload(piece) => {
                    assert!(
                        self.held.remove(&piece),
                        "{}: {piece:?} is not held",
                        self.seed
                    );
                    self.gpu.insert(piece.unit, piece.frame);
                }
                SessionAction::Show(piece) => {
                    let there = self.gpu.get(&piece.unit);
                    assert_eq!(there, Some(&piece.frame), "{}: {piece:?} went", self.seed);
                    self.idle.retain(|it| *it != piece.unit);
                }
                SessionAction::Drop(piece) => {
                    assert!(
                        self.held.remove(&piece),
                        "{}: {piece:?} is not held",
                        self.seed
                    );
                }
                SessionAction::Keep { shown, staying } => {
                    let kept: BTreeSet<UnitRef> = shown.iter().chain(&staying).copied().collect();
                    self.idle = staying;
                    let scene = &self.scene;
                    let is_base = |it: &UnitRef| {
                        let asset = &scene[usize::from(it.asset.0)];
                        asset.unit(it.unit).level == asset.coarsest()
                    };
                    self.gpu.retain(|it, _| kept.contains(it) || is_base(it));
                }
                SessionAction::BeginFrame(_)
                | SessionAction::Log(_)
                | SessionAction::Chosen(_)
                | SessionAction::Count => {}
            }
        }
    }

    /// Orders what was asked for; it comes when it comes, once, twice, damaged or never. Some of
    /// what is not wanted any more comes all the same.
    fn want(&mut self, pieces: &[Piece]) {
        let once: BTreeSet<Piece> = pieces.iter().copied().collect();
        assert_eq!(once.len(), pieces.len(), "{}: wanted twice", self.seed);
        let before = std::mem::take(&mut self.under_way);
        for delivery in before {
            if once.contains(&delivery.piece) || self.chance(0.5) {
                self.under_way.push(delivery);
            }
        }
        for piece in pieces {
            if self.under_way.iter().any(|it| it.piece == *piece) {
                continue;
            }
            let (fate, soon) = (self.random.unit(), self.below(0.1));
            let mut come = |after: f64, is_damaged| {
                self.under_way.push(Delivery {
                    at: self.now + after,
                    piece: *piece,
                    is_damaged,
                });
            };
            match fate {
                ..0.05 => {}
                ..0.1 => come(soon, true),
                ..0.15 => [true, false].into_iter().for_each(|it| come(soon, it)),
                ..0.25 => [false, false].into_iter().for_each(|it| come(soon, it)),
                ..0.35 => [soon, 3.0 * soon]
                    .into_iter()
                    .for_each(|at| come(at, false)),
                ..0.45 => come(10.0 * soon, false),
                _ => come(soon, false),
            }
        }
    }

    /// Once all comes that is asked for, and nothing else happens, a picture is whole.
    fn come_to_rest(&mut self) {
        for film in &self.films {
            film.lacks.store(false, Ordering::Relaxed);
        }
        self.under_way.clear();
        self.plays = false;
        self.session.take(SessionEvent::Jumped);
        for _ in 0..PATIENCE {
            self.now += 0.05;
            self.step(Pace::Standing);
            if self.session.is_settled() && !self.session.is_behind(&self.at(Pace::Standing).moment)
            {
                return;
            }
            for piece in self.session.requested().to_vec() {
                self.bring(piece, false);
            }
        }
        let is_saving = self.session.policy_in_use().policy.spends_a_budget();
        assert!(
            is_saving || self.session.is_settled(),
            "{}: {:?} {:?} {:?} {:?} is missing",
            self.seed,
            self.session.shown_tick(),
            self.session.wanted(),
            self.session.states(),
            self.bounds
        );
    }

    fn frames_of(&self, tick: u64) -> Vec<u32> {
        let frame = self.session.timeline().frame_of(tick);
        let frame_of = |asset: &Arc<dyn Content>| match asset.timeline().is_still() {
            true => 0,
            false => frame,
        };
        self.scene.iter().map(frame_of).collect()
    }

    fn bytes(
        &self,
        pieces: &[Piece],
        of: impl Fn(&foveal_core::content::unit::Unit) -> u64,
    ) -> u64 {
        let asset = |piece: &Piece| &self.scene[usize::from(piece.unit.asset.0)];
        let bytes = pieces.iter().map(|it| of(&asset(it).unit(it.unit.unit)));
        bytes.sum()
    }

    fn is_base(&self, piece: &Piece) -> bool {
        let asset = &self.scene[usize::from(piece.unit.asset.0)];
        asset.unit(piece.unit.unit).level == asset.coarsest()
    }

    /// What must hold after every step.
    fn check(&self) {
        let (seed, states) = (self.seed, self.session.states());
        let cached = states.in_state(UnitState::Cached);
        let held: Vec<Piece> = self.held.iter().copied().collect();
        assert_eq!(held, cached, "{seed}: what is held is what waits");
        let resident = states.resident();
        for piece in &resident {
            let there = self.gpu.get(&piece.unit);
            assert_eq!(there, Some(&piece.frame), "{seed}: {piece:?} is not there");
        }
        let shown = self.session.shown_tick().map(|tick| self.frames_of(tick));
        let Some(shown) = shown else {
            assert!(resident.is_empty(), "{seed}: nothing is shown");
            return self.check_bounds(&cached, &resident);
        };
        for piece in &resident {
            let frame = shown[usize::from(piece.unit.asset.0)];
            assert_eq!(piece.frame, frame, "{seed}: {piece:?} is of another frame");
        }
        let idle: BTreeSet<UnitRef> = self.idle.iter().copied().collect();
        let stays = states.in_state(UnitState::Resident).into_iter();
        let stays: BTreeSet<UnitRef> = stays.map(|it| it.unit).collect();
        assert_eq!(idle, stays, "{seed}: what stays is what is not shown");
        for (asset, (content, frame)) in (0..).map(AssetId).zip(self.scene.iter().zip(&shown)) {
            for unit in content.base(*frame) {
                let unit = UnitRef { asset, unit };
                let piece = Piece {
                    unit,
                    frame: *frame,
                };
                assert!(states.is_resident(piece), "{seed}: {piece:?} was dropped");
            }
        }
        self.check_bounds(&cached, &resident);
    }

    fn check_bounds(&self, cached: &[Piece], resident: &[Piece]) {
        let (seed, states) = (self.seed, self.session.states());
        let requested = self.session.requested();
        let in_flight = self.bytes(requested, |unit| u64::from(unit.bytes.unwrap_or(0)));
        let fits = in_flight <= self.bounds.in_flight || requested.len() == 1;
        assert!(fits, "{seed}: {in_flight} bytes in flight");
        for (pieces, most) in [(cached, self.bounds.cached), (resident, self.bounds.gpu)] {
            let bytes = self.bytes(pieces, |unit| unit.gpu_bytes);
            let fits = bytes <= most || pieces.iter().all(|piece| self.is_base(piece));
            assert!(fits, "{seed}: {bytes} bytes of {most}: {pieces:?}");
        }
        // Nothing is remembered but of the frame on screen and of the one that is worked on.
        let ticks = [
            self.session.shown_tick(),
            self.session.wanted().map(|wanted| wanted.0),
        ];
        let frames = ticks.map(|tick| tick.map(|tick| self.frames_of(tick)));
        for state in [UnitState::Requested, UnitState::Cached, UnitState::Damaged] {
            for piece in states.in_state(state) {
                let at = usize::from(piece.unit.asset.0);
                let mut known = frames.iter().flatten();
                let is_known = known.any(|frames| frames[at] == piece.frame);
                assert!(is_known, "{seed}: {piece:?} is still {state:?}");
            }
        }
    }
}
