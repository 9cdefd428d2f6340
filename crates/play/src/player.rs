//! What happens between a gaze and a picture, frame by frame?
//!
//! Choose, fetch, decode, draw: frames come one by one, as fast as they can be made.

mod expecting;

use crate::decoding::Decoding;
use crate::error::PlayError;
use crate::look::Look;
use crate::report::FrameReport;
use crate::step::step;
use foveal_core::content::demand::Content;
use foveal_core::content::payload::Payload;
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::content::unit::{AssetId, UnitRef};
use foveal_core::content::video::Video;
use foveal_core::content::video::grid::level_map::{LevelMap, histogram};
use foveal_core::content::video::grid::tile_grid::{Tile, TileGrid};
use foveal_core::content::video::losses::LossMeter;
use foveal_core::content::video::worth::Worth;
use foveal_core::gaze::sample::{GazeSample, HeadPose};
use foveal_core::pack::unit::UnitId;
use foveal_core::perception::moment::Moment;
use foveal_core::perception::parameters::Parameters;
use foveal_core::session::actions::{Cache, Now, Pace, SessionAction, SessionEvent};
use foveal_core::session::bounds::Bounds;
use foveal_core::session::log::{SessionFrame, SessionHead};
use foveal_core::session::session::{Session, SessionSettings};
use foveal_core::session::unit_states::{Piece, UnitState};
use foveal_core::units::Seconds;
use foveal_core::view::axes::angle_between;
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::mounted::MountedPanel;
use foveal_core::view::surface::{Projection, Screen};
use foveal_media::pack::pack_file::PackFile;
use foveal_media::tiles::decode_pool::{DecodePool, DecodedTile, TileError};
use foveal_media::tiles::decoders::DeviceUse;
use foveal_render::{DrawDevice, Drawer, RgbaImage, TileDrawer, TileStyle};
use std::collections::HashSet;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Share of a frame's time after which a paced frame waits for no finer unit: what is left is for
/// uploading and drawing.
const READY: f64 = 0.8;

/// How a pack is played.
#[derive(Clone)]
pub struct PlayerOptions {
    /// The policy with its parameters.
    pub config: PolicyConfig,
    /// What shows the picture, while the head looks ahead.
    pub view: EyeView,
    /// The screen that flat content fills.
    pub screen: Screen,
    /// What draws.
    pub drawing: DrawDevice,
    /// How tiles become a picture; whether samples do follows from the policy.
    pub style: TileStyle,
    /// What a link brings, for policies that spend a budget; infinite for content at hand.
    pub bytes_per_s: f64,
    /// Show a frame when its time is over, complete or not.
    pub paced: bool,
    /// Judge every frame; takes some milliseconds each.
    pub judged: bool,
    /// Who decodes.
    pub decoding: Decoding,
    /// Receives what a person should know but is not an error.
    pub tell: fn(&str),
}

/// Plays a pack under one policy, without a window.
pub struct Player {
    file: Arc<PackFile>,
    video: Arc<Video>,
    session: Session,
    cache: Cache<Payload>,
    pool: DecodePool,
    drawer: Drawer,
    /// Computes how much of what the eye could see was shown, and what it misses.
    judge: Option<(Worth, LossMeter)>,
    options: PlayerOptions,
    /// What shows the picture in the place of one view, if anything.
    panels: Vec<MountedPanel>,
    times_ns: Vec<i64>,
    /// Units that were needed so far.
    fetched: HashSet<UnitId>,
    /// What the last frame showed; none before the first, with which time begins.
    before: Option<LevelMap>,
    /// Tiles that could not be decoded so far.
    failed: usize,
}

/// What was decoded of a frame.
#[derive(Default)]
struct Decoded {
    pixels: u64,
    failed: usize,
}

impl Player {
    /// A player of an open pack.
    ///
    /// # Errors
    /// The pack lacks what the policy chooses by, or cannot be decoded or drawn.
    pub fn new(file: Arc<PackFile>, options: PlayerOptions) -> Result<Self, PlayError> {
        let mut options = options;
        let video = file.video(options.screen)?;
        if let Err(error) = file.calibration() {
            (options.tell)(&format!(
                "warning: {error}; targets are kept by constants instead, as for packs without a \
                 calibration"
            ));
        }
        check(&file, &video, &mut options)?;
        options.style.samples = options.config.policy == Policy::Sampled;
        let mut drawer = Drawer::new(&options.drawing, &video, options.style)?;
        if let Some(tiles) = drawer.tiles_mut() {
            tiles.prepare(&options.config, &options.view)?;
        }
        let spends = options.config.policy.spends_a_budget();
        let settings = SessionSettings {
            policy: options.config.clone(),
            bytes_per_s: spends.then_some(options.bytes_per_s),
            since: Some(Seconds(0.0)),
            zooms: false,
            measures: false,
            bounds: Bounds::default(),
        };
        let grid = video.grid();
        Ok(Self {
            session: Session::new(vec![Arc::clone(&video) as Arc<dyn Content>], settings),
            judge: options.judged.then(|| {
                let meter = LossMeter::new(grid, &Parameters::default());
                (Worth::judge(grid), meter)
            }),
            pool: options.decoding.pool(Arc::clone(&file))?,
            cache: Cache::default(),
            drawer,
            times_ns: file.frame_times()?,
            fetched: HashSet::new(),
            before: None,
            failed: 0,
            panels: Vec::new(),
            video,
            file,
            options,
        })
    }

    /// The same, shown on panels that turn with the head in the place of its view; on flat content
    /// they stay as they are.
    #[must_use]
    pub fn through(mut self, panels: Vec<MountedPanel>) -> Self {
        self.session.take(SessionEvent::Mounted(panels.clone()));
        self.panels = panels;
        self
    }

    /// What shows the picture, while the head looks ahead.
    #[must_use]
    pub fn view(&self) -> EyeView {
        self.options.view
    }

    /// The policy with its parameters.
    #[must_use]
    pub fn config(&self) -> &PolicyConfig {
        &self.options.config
    }

    /// The tiles of the pack.
    #[must_use]
    pub fn grid(&self) -> &TileGrid {
        self.video.grid()
    }

    /// Bytes of units that were fetched again, because they had left the client's memory.
    #[must_use]
    pub fn refetched_bytes(&self) -> u64 {
        self.session.figures().refetched_bytes
    }

    /// What draws the frame that was played last.
    pub fn drawer(&mut self) -> &mut Drawer {
        &mut self.drawer
    }

    /// What a graphics device decoded so far.
    #[must_use]
    pub fn device_use(&self) -> DeviceUse {
        self.pool.device_use()
    }

    /// A resident tile by itself, in its own pixels; `None` when nothing draws.
    ///
    /// # Errors
    /// It is not resident.
    pub fn read_tile(&mut self, tile: Tile) -> Result<Option<RgbaImage>, PlayError> {
        let colour = self.video.pack().description().colour;
        let unit = self.video.pack().unit(tile, 0);
        let tiles = self.drawer.tiles_mut();
        let picture = tiles.map(|tiles| tiles.read_unit(of_video(unit)));
        Ok(picture
            .transpose()?
            .flatten()
            .map(|picture| RgbaImage::from_planes(&picture, colour)))
    }

    /// Media time of a frame.
    #[must_use]
    pub fn time(&self, frame: u32) -> Seconds {
        Seconds(self.times_ns[frame as usize] as f64 / 1e9)
    }

    /// Frames of a round.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.times_ns.len()
    }

    /// Length of a round: the last frame lasts as long as frames do.
    #[must_use]
    pub fn length(&self) -> Seconds {
        self.session.timeline().length()
    }

    /// Makes `frame` the first to be played: what is spent counts from there.
    pub fn begin_at(&mut self, frame: u32) {
        self.session.take(SessionEvent::BeganAt(self.time(frame)));
    }

    /// The head of this run's session log.
    #[must_use]
    pub fn session_head(&self) -> SessionHead {
        let ahead = GazeSample::at(Seconds(0.0), Default::default(), Default::default());
        let look = Look::known(ahead, HeadPose::default());
        let moment = Moment {
            views: self.views(HeadPose::default()),
            ..self.moment(&look)
        };
        self.session.log_head(&moment)
    }

    /// Chooses for a frame that is not shown: what is chosen later depends on what was before.
    pub fn pass(&mut self, frame: u32, look: &Look) {
        let now = self.now(frame, look, Pace::FrameByFrame);
        let picked = self.session.pass(u64::from(frame), &now);
        self.before = Some(self.levels_of(&picked));
    }

    /// Chooses, decodes and uploads one frame for a viewer; it is shown at the time of the gaze.
    ///
    /// # Errors
    /// The coarsest level is damaged, or the device was lost.
    pub fn show(&mut self, frame: u32, look: &Look) -> Result<FrameReport, PlayError> {
        let (gaze, views) = (look.gaze, self.views(look.head));
        let view = views[0];
        let period = self.period(frame);
        let begun = Instant::now();
        let now = self.now(frame, look, Pace::FrameByFrame);
        let actions = self.session.begin_frame(u64::from(frame), &now);
        let choose = begun.elapsed();
        let (_, left) = self.drawer.perform(actions, &mut self.cache, &now)?;
        let Some(session) = self.order(left) else {
            return Err(self.lacks("has too little to choose by"));
        };
        let wanted = self.wanted();
        let deadline = begun + period.mul_f64(READY);
        let begun = Instant::now();
        let decoded = self.decode(frame, deadline)?;
        let decode = begun.elapsed();
        let new_bytes = self.fetch(&wanted);
        let begun = Instant::now();
        let shown = self.present(frame, look)?;
        if let Some(tiles) = self.drawer.tiles_mut() {
            tiles.follow(&now.moment.gaze, &view)?;
        }
        let upload = begun.elapsed();
        let tiles = self.tiles(&shown);
        let levels = self.levels_of(&wanted);
        let changes = |before: &LevelMap| levels.changes_from(before);
        let level_changes = self.before.as_ref().map_or(0, changes);
        let is_missing = |unit: &&UnitRef| !shown.contains(unit);
        let missing: Vec<UnitRef> = wanted.iter().filter(is_missing).copied().collect();
        let stood_in = (!missing.is_empty()).then(|| self.levels_of(&shown));
        let seen = stood_in.as_ref().unwrap_or(&levels);
        let judged = self.judged(frame, &gaze, &views, seen);
        let follows = self.before.replace(levels).is_some();
        let pixels = self.pixels(&wanted);
        let off = angle_between(gaze.gaze_in_content, now.moment.gaze.gaze_in_content);
        Ok(FrameReport {
            session,
            gaze,
            gaze_error_deg: look.gaze_is_known.then(|| off.to_degrees()),
            detail_share: judged.map(|(share, _)| share),
            expected: judged.map(|(_, expected)| expected),
            view,
            views,
            histogram: histogram(self.grid(), &tiles),
            late: follows && choose + decode > period,
            missing: self.tiles(&missing),
            tiles,
            pixels,
            share: pixels as f64 / self.grid().surface.pixels() as f64,
            decoded_pixels: decoded.pixels,
            new_bytes,
            choose,
            decode,
            upload,
            wrong_frame_tiles: self.wrong_frame_units(),
            failed_tiles: decoded.failed,
            level_changes,
        })
    }

    /// What was expected of the viewer.
    fn moment(&self, look: &Look) -> Moment {
        let (expected, perception) = (&look.expected, &self.options.config.perception);
        Moment {
            gaze: expected.gaze,
            views: self.views(look.head_expected),
            head: look.head_expected,
            state: perception.eye_state(expected.event, expected.since_saccade),
            behind_sound: None,
        }
    }

    fn now(&self, frame: u32, look: &Look, pace: Pace) -> Now {
        Now {
            wall: Seconds(0.0),
            media: self.session.timeline().time_of(u64::from(frame)),
            pace,
            drawing: Seconds(0.0),
            until: Seconds(look.gaze.time.0 + self.period(frame).as_secs_f64()),
            moment: self.moment(look),
        }
    }

    /// Orders what is wanted; returns the line of the log, where something was chosen.
    fn order(&mut self, left: Vec<SessionAction>) -> Option<SessionFrame> {
        let mut line = None;
        for action in left {
            match action {
                SessionAction::Want(pieces) => {
                    for piece in pieces {
                        self.pool.request(piece.unit.unit, piece.frame);
                    }
                }
                SessionAction::Chosen(chosen) => line = Some(*chosen),
                _ => {}
            }
        }
        line
    }

    fn lacks(&self, what: &'static str) -> PlayError {
        PlayError::Lacks {
            path: self.file.path().to_owned(),
            what,
        }
    }

    /// The units of the frame that is worked on.
    fn wanted(&self) -> Vec<UnitRef> {
        let wanted = self.session.wanted().map(|(_, wanted)| wanted);
        wanted
            .unwrap_or_default()
            .iter()
            .map(|it| it.unit)
            .collect()
    }

    /// Decodes what was ordered; paced, only what is there in time and the coarsest level.
    fn decode(&mut self, frame: u32, deadline: Instant) -> Result<Decoded, PlayError> {
        let coarsest = self.grid().coarsest();
        let pack = Arc::clone(self.video.pack());
        let is_base = |unit: UnitId| pack.tile_of(unit).level == coarsest;
        let ordered = self.session.requested().iter().map(|piece| piece.unit.unit);
        let mut left: HashSet<UnitId> = ordered.collect();
        let mut base = left.iter().filter(|unit| is_base(**unit)).count();
        let mut decoded = Decoded::default();
        while !left.is_empty() {
            let deadline = (self.options.paced && base == 0).then_some(deadline);
            let Some(done) = self.pool.receive(deadline) else {
                break;
            };
            // Others are of an earlier order, and came too late for it.
            if done.frame != frame || !left.remove(&done.unit) {
                continue;
            }
            base -= usize::from(is_base(done.unit));
            let samples = Content::unit(&*self.video, done.unit).samples;
            decoded.pixels += u64::from(done.decoded) * samples;
            self.take(done, &mut decoded)?;
        }
        self.pool.cancel();
        Ok(decoded)
    }

    /// Keeps a decoded tile until it is shown; a finer one that failed leaves the coarser level.
    fn take(&mut self, done: DecodedTile, decoded: &mut Decoded) -> Result<(), PlayError> {
        let (frame, frames) = (done.frame, done.decoded);
        let tile = self.video.pack().tile_of(done.unit);
        let piece = Piece {
            unit: of_video(done.unit),
            frame,
        };
        let path = || self.file.path().to_owned();
        match done.picture {
            Ok((picture, number)) if number == i64::from(frame) => {
                self.cache.insert(piece, Payload::Picture(picture));
                self.session.take(SessionEvent::Decoded { piece, frames });
            }
            Ok((_, number)) => {
                return Err(PlayError::WrongFrame {
                    path: path(),
                    tile,
                    frame,
                    number,
                });
            }
            Err(source) if tile.level == self.grid().coarsest() => {
                return Err(PlayError::Coarsest {
                    path: path(),
                    frame,
                    source,
                });
            }
            Err(error) => {
                if self.failed == 0 {
                    self.tell_failure(tile, frame, &error);
                }
                self.failed += 1;
                decoded.failed += 1;
                self.session.take(SessionEvent::Damaged { piece, frames });
            }
        }
        Ok(())
    }

    /// Says once that tiles are damaged; a coarser level stands in for them.
    fn tell_failure(&self, tile: Tile, frame: u32, error: &TileError) {
        let Tile { level, face, x, y } = tile;
        (self.options.tell)(&format!(
            "{}: level {level}, face {face}, column {x}, row {y} cannot be decoded at frame \
             {frame}; a coarser level is shown ({error}; `foveal verify` lists all damage)",
            self.file.path().display(),
        ));
    }

    /// Shows the frame with what was decoded, and returns its units.
    fn present(&mut self, frame: u32, look: &Look) -> Result<HashSet<UnitRef>, PlayError> {
        let now = self.now(frame, look, Pace::FrameIsOver);
        let (cache, drawer) = (&mut self.cache, &mut self.drawer);
        let (_, left) = step(&mut self.session, &now, cache, drawer)?;
        let _ = self.order(left);
        if let Some(tiles) = self.drawer.tiles_mut() {
            tiles.settle()?;
        }
        let shown = self.session.states().in_state(UnitState::Shown);
        Ok(shown.into_iter().map(|piece| piece.unit).collect())
    }

    /// Resident tiles that hold another frame than the one shown.
    fn wrong_frame_units(&mut self) -> usize {
        let tiles = self.drawer.tiles_mut();
        tiles.map_or(0, TileDrawer::wrong_frame_units)
    }

    /// Bytes of the units that this run had not needed before.
    fn fetch(&mut self, units: &[UnitRef]) -> u64 {
        let pack = self.video.pack();
        let units = units.iter().map(|unit| unit.unit);
        let new = units.filter(|unit| self.fetched.insert(*unit));
        new.map(|unit| u64::from(pack.entry(unit).bytes)).sum()
    }

    /// The tiles of units, coarsest first, by rank.
    fn tiles<'a>(&self, units: impl IntoIterator<Item = &'a UnitRef>) -> Vec<Tile> {
        let tiles = units
            .into_iter()
            .map(|it| self.video.pack().tile_of(it.unit));
        let mut tiles: Vec<Tile> = tiles.collect();
        tiles.sort_by_key(|tile| (std::cmp::Reverse(tile.level), self.grid().rank(*tile)));
        tiles
    }

    /// The level of every cell where these units are all that is shown.
    fn levels_of<'a>(&self, units: impl IntoIterator<Item = &'a UnitRef>) -> LevelMap {
        let grid = self.grid();
        let mut levels = LevelMap::filled(grid, grid.coarsest());
        for unit in units {
            let tile = self.video.pack().tile_of(unit.unit);
            if tile.level < grid.coarsest() {
                let cells = grid.cells_under(tile);
                cells.for_each(|cell| levels.refine(grid, cell, tile.level));
            }
        }
        levels
    }

    /// Pixels shown of these units.
    fn pixels(&self, units: &[UnitRef]) -> u64 {
        let of_tile = |unit: &UnitRef| Content::unit(&*self.video, unit.unit).samples;
        let samples = self.drawer.tiles().and_then(TileDrawer::samples);
        samples.map_or_else(|| units.iter().map(of_tile).sum(), |count| count as u64)
    }

    /// What shows the picture where the head is turned to, at least one view.
    fn views(&self, head: HeadPose) -> Vec<EyeView> {
        let head = match self.grid().surface.projection {
            Projection::Flat => HeadPose::default(),
            Projection::Cube | Projection::Equirect => head,
        };
        match self.panels.as_slice() {
            [] => vec![self.turned(head)],
            panels => MountedPanel::views_from(panels, &head, Default::default()),
        }
    }

    fn turned(&self, head: HeadPose) -> EyeView {
        match self.grid().surface.projection {
            Projection::Flat => self.options.view,
            Projection::Cube | Projection::Equirect => EyeView {
                axes: head.axes(),
                ..self.options.view
            },
        }
    }

    /// Nominal time that a frame is shown.
    fn period(&self, frame: u32) -> Duration {
        let frame = frame as usize;
        let next = self
            .times_ns
            .get(frame + 1)
            .map(|next| next - self.times_ns[frame]);
        let nominal = 1e9 / self.video.pack().description().fps();
        Duration::from_nanos(next.map_or(nominal as u64, |ns| ns.max(1) as u64))
    }
}

/// A unit of the only asset.
fn of_video(unit: UnitId) -> UnitRef {
    UnitRef {
        asset: AssetId::ONLY,
        unit,
    }
}

/// Whether the pack has what the policy chooses by; `acuity` stands in for one that weighs units,
/// where the pack has no signatures.
fn check(file: &PackFile, video: &Video, options: &mut PlayerOptions) -> Result<(), PlayError> {
    let lacks = |what| PlayError::Lacks {
        path: file.path().to_owned(),
        what,
    };
    let has = Content::has(video);
    if options.config.needs_signatures() && !has.signatures {
        let config = options.config.without_signatures();
        if config.policy.spends_a_budget() || options.bytes_per_s.is_finite() {
            return Err(lacks(
                "has no signatures, by which this policy values units; prepare it again",
            ));
        }
        (options.tell)(&format!(
            "{}: has no signatures, so levels are chosen by acuity \
             alone",
            file.path().display(),
        ));
        options.config = config;
    }
    if options.config.needs_cues() && !(has.cues && has.signatures) {
        return Err(lacks(
            "has no cues, which hold the variance of cells; prepare it again, or give \
             --noisy-cells N in place of --noise-threshold",
        ));
    }
    Ok(())
}
