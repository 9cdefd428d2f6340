//! What happens between a gaze and a picture of a video, frame by frame?
//!
//! Choose, fetch, decode, draw: frames come one by one, as fast as they can be made. An observer
//! measures what each of them showed.

mod expecting;

use crate::at_once::AtOnce;
use crate::error::PlayError;
use crate::judging::TileJudge;
use crate::making::Made;
use crate::options::{FrameOptions, PlayerOptions};
use crate::player::Player;
use crate::report::FrameReport;
use crate::watched_frame::WatchedFrame;
use foveal_core::content::demand::Content;
use foveal_core::content::opened::Opened;
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::content::unit::{AssetId, UnitRef};
use foveal_core::content::video::Video;
use foveal_core::content::video::grid::level_map::{LevelMap, histogram};
use foveal_core::content::video::grid::tile_grid::{Tile, TileGrid};
use foveal_core::gaze::sample::{GazeSample, HeadPose};
use foveal_core::perception::moment::Moment;
use foveal_core::session::actions::{Now, Pace, SessionEvent};
use foveal_core::session::bounds::Bounds;
use foveal_core::session::decoder::PackBytes;
use foveal_core::session::log::SessionHead;
use foveal_core::session::unit_states::UnitState;
use foveal_core::units::Seconds;
use foveal_core::view::axes::angle_between;
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::mounted::MountedPanel;
use foveal_core::view::surface::Projection;
use foveal_media::pack::pack_file::PackFile;
use foveal_media::tiles::decoders::{Decoders, DeviceUse};
use foveal_render::{Drawer, RgbaImage, TileDrawer};
use std::collections::HashSet;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Share of a frame's time after which a paced frame waits for no finer unit: what is left is for
/// uploading and drawing.
const READY: f64 = 0.8;

/// Plays a video under one policy, frame by frame.
pub struct FramePlayer {
    player: Player,
    video: Arc<Video>,
    options: FrameOptions,
    /// What shows the picture in the place of one view, if anything.
    panels: Vec<MountedPanel>,
    times_ns: Vec<i64>,
    /// Computes how much of what the eye could see was shown, and what it misses.
    judge: Option<TileJudge>,
    /// What the last frame showed; none before the first, with which time begins.
    before: Option<LevelMap>,
    decoders: Decoders,
}

impl FramePlayer {
    /// A player of an open pack.
    ///
    /// # Errors
    /// The pack lacks what the policy chooses by, or cannot be decoded or drawn.
    pub fn new(file: &Arc<PackFile>, options: FrameOptions) -> Result<Self, PlayError> {
        let mut options = options;
        let video = file.video(options.screen)?;
        if let Err(error) = file.calibration() {
            (options.player.tell)(&format!(
                "warning: {error}; targets are kept by constants instead, as for packs without a \
                 calibration"
            ));
        }
        check(file, &video, &mut options.player)?;
        let config = &options.player.config;
        options.style.samples = config.policy == Policy::Sampled;
        let mut drawer = Drawer::new(&options.player.drawing, &video, options.style)?;
        if let Some(tiles) = drawer.tiles_mut() {
            tiles.prepare(config, &options.view)?;
        }
        let judge = options.judged;
        let judge = judge.then(|| TileJudge::new(video.grid(), config.policy));
        let pool = options.decoding.pool(file)?;
        let decoders = pool.decoders().clone();
        let opened = Opened::Video(Arc::clone(&video));
        let bytes = PackBytes::new(opened.content(), file.source());
        let supply = Box::new(AtOnce::new(bytes, Box::new(pool)));
        let settings = options.player.settings(false, Bounds::default());
        Ok(Self {
            player: Player::new(opened, settings, drawer, supply, options.player.tell),
            times_ns: file.frame_times()?,
            panels: Vec::new(),
            before: None,
            video,
            options,
            judge,
            decoders,
        })
    }

    /// The same, shown on panels that turn with the head in the place of its view; on flat content
    /// they stay as they are.
    #[must_use]
    pub fn through(mut self, panels: Vec<MountedPanel>) -> Self {
        let mounted = SessionEvent::Mounted(panels.clone());
        self.player.session_mut().take(mounted);
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
        &self.options.player.config
    }

    /// The tiles of the pack.
    #[must_use]
    pub fn grid(&self) -> &TileGrid {
        self.video.grid()
    }

    /// Bytes of units that were fetched again, because they had left the client's memory.
    #[must_use]
    pub fn refetched_bytes(&self) -> u64 {
        self.player.session().figures().refetched_bytes
    }

    /// What draws the frame that was played last.
    pub fn drawer(&mut self) -> &mut Drawer {
        self.player.drawer_mut()
    }

    /// What a graphics device decoded so far.
    #[must_use]
    pub fn device_use(&self) -> DeviceUse {
        self.decoders.device_use()
    }

    /// A resident tile by itself, in its own pixels; `None` when nothing draws.
    ///
    /// # Errors
    /// It is not resident.
    pub fn read_tile(&mut self, tile: Tile) -> Result<Option<RgbaImage>, PlayError> {
        let pack = self.video.pack();
        let (colour, unit) = (pack.description().colour, pack.unit(tile, 0));
        let tiles = self.player.drawer_mut().tiles_mut();
        let picture = tiles.map(|tiles| tiles.read_unit(AssetId::ONLY.unit(unit)));
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
        self.player.session().timeline().length()
    }

    /// Makes `frame` the first to be played: what is spent counts from there.
    pub fn begin_at(&mut self, frame: u32) {
        let time = self.time(frame);
        self.player.session_mut().take(SessionEvent::BeganAt(time));
    }

    /// The head of this run's session log.
    #[must_use]
    pub fn session_head(&self) -> SessionHead {
        let ahead = GazeSample::at(Seconds(0.0), Default::default(), Default::default());
        let watched = WatchedFrame::known(ahead, HeadPose::default());
        self.player.session().log_head(&self.moment(&watched))
    }

    /// Chooses for a frame that is not shown: what is chosen later depends on what was before.
    pub fn pass(&mut self, frame: u32, watched: &WatchedFrame) {
        let now = self.now(frame, watched);
        let picked = self.player.session_mut().pass(u64::from(frame), &now);
        self.before = Some(self.levels_of(&picked));
    }

    /// Chooses, decodes and uploads one frame for a viewer; it is shown at the time of the gaze.
    ///
    /// # Errors
    /// The coarsest level is damaged, or the device was lost.
    pub fn show(&mut self, frame: u32, watched: &WatchedFrame) -> Result<FrameReport, PlayError> {
        let period = self.period(frame);
        let now = self.now(frame, watched);
        let patience = self.options.paced.then(|| period.mul_f64(READY));
        let made = self.player.make(u64::from(frame), &now, patience)?;
        let settling = Instant::now();
        let view = self.views(watched.head)[0];
        if let Some(tiles) = self.player.drawer_mut().tiles_mut() {
            tiles.settle()?;
            tiles.follow(&now.moment.gaze, &view)?;
        }
        let upload = made.upload + settling.elapsed();
        let busy = made.choose + made.decode + upload;
        let patience = patience.map_or(Duration::ZERO, |_| period);
        Ok(FrameReport {
            upload,
            wait: patience.saturating_sub(busy),
            ..self.observed((frame, watched), &now, made)?
        })
    }

    /// Draws the frame that was shown last for a view, and waits until that is done; how long it
    /// took goes into the frame's report.
    ///
    /// # Errors
    /// The picture is larger than the device draws, or the device was lost.
    pub fn draw(&mut self, view: &EyeView, report: &mut FrameReport) -> Result<(), PlayError> {
        let begun = Instant::now();
        let drawer = self.player.drawer_mut();
        if drawer.draw(view, None)?.is_none() {
            drawer.picture(view, None)?;
        } else if let Some(tiles) = drawer.tiles_mut() {
            tiles.settle()?;
        }
        report.draw = begun.elapsed();
        report.wait = report.wait.saturating_sub(report.draw);
        Ok(())
    }

    /// What a frame that was made shows a viewer.
    fn observed(
        &mut self,
        (frame, watched): (u32, &WatchedFrame),
        now: &Now,
        made: Made,
    ) -> Result<FrameReport, PlayError> {
        let (gaze, views) = (watched.gaze, self.views(watched.head));
        let session = made.chosen.ok_or_else(|| PlayError::Lacks {
            pack: self.video.name().to_owned(),
            what: "has too little to choose by",
        })?;
        let states = self.player.session().states();
        let shown: HashSet<UnitRef> = {
            let shown = states.in_state(UnitState::Shown).into_iter();
            shown.map(|piece| piece.unit).collect()
        };
        let is_missing = |unit: &&UnitRef| !shown.contains(unit);
        let missing: Vec<UnitRef> = made.wanted.iter().filter(is_missing).copied().collect();
        let tiles = self.tiles(&shown);
        let levels = self.levels_of(&made.wanted);
        let changes = |before: &LevelMap| levels.changes_from(before);
        let level_changes = self.before.as_ref().map_or(0, changes);
        let stood_in = (!missing.is_empty()).then(|| self.levels_of(&shown));
        let seen = stood_in.as_ref().unwrap_or(&levels);
        let judged = self.judge.as_ref();
        let judged = judged.and_then(|it| it.judged(&self.video, (frame, &gaze, &views), seen));
        let follows = self.before.replace(levels).is_some();
        let pixels = self.pixels(&made.wanted);
        let off = angle_between(gaze.gaze_in_content, now.moment.gaze.gaze_in_content);
        Ok(FrameReport {
            session: *session,
            gaze,
            gaze_error_deg: watched.gaze_is_known.then(|| off.to_degrees()),
            detail_share: judged.map(|(share, _)| share),
            expected: judged.map(|(_, expected)| expected),
            view: views[0],
            views,
            histogram: histogram(self.grid(), &tiles),
            late: follows && made.choose + made.decode > self.period(frame),
            missing: self.tiles(&missing),
            tiles,
            pixels,
            share: pixels as f64 / self.grid().surface.pixels() as f64,
            decoded_pixels: made.decoded_samples,
            decodes: made.decodes,
            new_bytes: made.new_bytes,
            choose: made.choose,
            decode: made.decode,
            upload: made.upload,
            draw: Duration::ZERO,
            wait: Duration::ZERO,
            wrong_frame_tiles: self.wrong_frame_units(),
            failed_tiles: made.damaged,
            level_changes,
        })
    }

    /// What was expected of the viewer.
    fn moment(&self, watched: &WatchedFrame) -> Moment {
        let (expected, perception) = (&watched.expected, &self.config().perception);
        Moment {
            gaze: expected.gaze,
            views: self.views(watched.head_expected),
            head: watched.head_expected,
            state: perception.eye_state(expected.event, expected.since_saccade),
            behind_sound: None,
        }
    }

    fn now(&self, frame: u32, watched: &WatchedFrame) -> Now {
        Now {
            wall: Seconds(0.0),
            media: self.player.session().timeline().time_of(u64::from(frame)),
            pace: Pace::FrameByFrame,
            drawing: Seconds(0.0),
            until: Seconds(watched.gaze.time.0 + self.period(frame).as_secs_f64()),
            moment: self.moment(watched),
        }
    }

    /// Resident tiles that hold another frame than the one shown.
    fn wrong_frame_units(&mut self) -> usize {
        let tiles = self.player.drawer_mut().tiles_mut();
        tiles.map_or(0, TileDrawer::wrong_frame_units)
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
        let samples = self.player.drawer().tiles().and_then(TileDrawer::samples);
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

/// Whether the pack has what the policy chooses by; `acuity` stands in for one that weighs units,
/// where the pack has no signatures.
fn check(file: &PackFile, video: &Video, options: &mut PlayerOptions) -> Result<(), PlayError> {
    let lacks = |what| PlayError::Lacks {
        pack: file.path().display().to_string(),
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
