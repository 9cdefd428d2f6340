//! What happens between a gaze and a picture, frame by frame?
//!
//! Select, decode, upload: the one path that every command that plays a pack goes through.

use crate::gaze_source::{GazeSource, Look};
use crate::options::decoding::Decoding;
use crate::options::policy::check_thresholds;
use crate::report::output;
use crate::run::canvas::{Canvas, Drawing, Showing};
use crate::run::sampling::Sampling;
use anyhow::{Context, bail};
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::content::video::bytes::cue_table::CueTable;
use foveal_core::content::video::bytes::signatures::Signatures;
use foveal_core::content::video::grid::level_map::{LevelMap, histogram};
use foveal_core::content::video::grid::tile_grid::{Tile, TileGrid};
use foveal_core::content::video::losses::LossMeter;
use foveal_core::content::video::rules::Selection;
use foveal_core::content::video::units::{Content, PackContent};
use foveal_core::content::video::worth::Worth;
use foveal_core::gaze::sample::{GazeSample, HeadPose};
use foveal_core::pack::unit::UnitId;
use foveal_core::perception::moment::Moment;
use foveal_core::perception::parameters::{EyeState, Parameters};
use foveal_core::selection::chooser::Chooser;
use foveal_core::session::budget::Budget;
use foveal_core::session::log::{Given, SessionFrame, SessionHead};
use foveal_core::units::Seconds;
use foveal_core::view::axes::angle_between;
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::picture::Picture;
use foveal_core::view::surface::{Projection, Screen};
use foveal_media::pack::pack_file::PackFile;
use foveal_media::tiles::decode_pool::{DecodePool, DecodedTile, TileError};
use foveal_media::tiles::decoders::DeviceUse;
use foveal_render::{Interpolation, RadialBlur, RgbaImage};
use std::collections::HashSet;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Plays a pack under one policy.
pub(crate) struct Player {
    file: Arc<PackFile>,
    grid: TileGrid,
    chooser: Chooser,
    config: PolicyConfig,
    tables: Tables,
    /// Tells how much of what the eye could see was shown, and what of it is missed, where somebody
    /// asks.
    judge: Option<(Worth, LossMeter)>,
    budget: Option<Budget>,
    shown_until: Seconds,
    pool: DecodePool,
    pub(crate) canvas: Canvas,
    view: EyeView,
    times_ns: Vec<i64>,
    fetched: HashSet<UnitId>,
    /// What the last frame showed; none before the first, with which time begins.
    before: Option<LevelMap>,
    paced: bool,
    /// Tiles that could not be decoded so far.
    failed: usize,
    /// Under a policy that shows samples.
    sampling: Option<Sampling>,
    blurs: bool,
}

/// The side tables that value units.
struct Tables {
    signatures: Option<Signatures>,
    cues: Option<CueTable>,
}

impl Tables {
    fn read(file: &PackFile) -> anyhow::Result<Self> {
        Ok(Self {
            signatures: file.signatures()?,
            cues: file.cues()?,
        })
    }

    fn content<'a>(&'a self, file: &'a PackFile) -> Option<PackContent<'a>> {
        Some(PackContent {
            pack: file.pack(),
            signatures: self.signatures.as_ref()?,
            cues: self.cues.as_ref(),
        })
    }
}

/// How a pack is played.
pub(crate) struct PlayerOptions {
    pub(crate) config: PolicyConfig,
    pub(crate) view: EyeView,
    pub(crate) screen: Screen,
    pub(crate) drawing: Drawing,
    pub(crate) showing: Showing,
    /// What a link brings, for policies that spend a budget; infinite for content at hand.
    pub(crate) bytes_per_s: f64,
    /// Show a frame when its time is over, complete or not.
    pub(crate) paced: bool,
    /// Judge every frame; takes some milliseconds each.
    pub(crate) judged: bool,
    pub(crate) decoding: Decoding,
}

/// Share of a frame's time after which a paced frame waits for no finer tile: what is left is for
/// uploading and drawing.
const READY: f64 = 0.8;

/// What one frame took.
#[derive(Clone, Debug)]
pub(crate) struct FrameReport {
    pub(crate) session: SessionFrame,
    /// Where the eye looked.
    pub(crate) gaze: GazeSample,
    /// How far from there it was expected, in degrees.
    pub(crate) gaze_error_deg: f64,
    /// Share of the detail that this eye could see that was shown; `None` where the pack does not
    /// tell what its units add, or nobody asked.
    pub(crate) detail_share: Option<f64>,
    /// Quality difference to every finest tile that is expected of what was shown, as
    /// [`expected_jod`](foveal_core::content::calibration::expected_jod) takes it.
    pub(crate) expected_loss: Option<f64>,
    pub(crate) view: EyeView,
    /// Tiles decoded and shown, coarsest first.
    pub(crate) tiles: Vec<Tile>,
    /// Tiles that were chosen and are not shown: late, or damaged.
    pub(crate) missing: Vec<Tile>,
    /// Tiles shown of each level, finest first.
    pub(crate) histogram: Vec<u32>,
    /// Pixels of the tiles that were asked for, the whole coarsest level included; the samples
    /// where only those are shown.
    pub(crate) pixels: u64,
    /// Those over the pixels of the finest level.
    pub(crate) share: f64,
    /// Pixels decoded, those to catch up included.
    pub(crate) decoded_pixels: u64,
    /// Bytes of units that were needed for the first time.
    pub(crate) new_bytes: u64,
    /// Choosing them.
    pub(crate) choose: Duration,
    /// From asking for the tiles until the last was there.
    pub(crate) decode: Duration,
    /// Making them resident.
    pub(crate) upload: Duration,
    /// Whether the frame's time was over before it could be shown, be it with coarser tiles in the
    /// place of missing ones. The first frame cannot be: time begins with it.
    pub(crate) late: bool,
    /// Tiles shown that hold another frame.
    pub(crate) wrong_frame_tiles: usize,
    /// Tiles that could not be decoded.
    pub(crate) failed_tiles: usize,
    /// Cells whose level changed since the frame before.
    pub(crate) level_changes: u64,
}

/// The policy in the place of one that weighs units, for a pack that does not tell what they add.
fn without_signatures(options: &PlayerOptions, file: &PackFile) -> anyhow::Result<PolicyConfig> {
    let config = options.config.without_signatures();
    if config.policy.spends_a_budget() || options.bytes_per_s.is_finite() {
        bail!(
            "{}: has no signatures, by which this policy values units; prepare it again",
            file.path().display(),
        );
    }
    output::say(&format!(
        "{}: has no signatures, which tell what units add, so levels are chosen by acuity alone",
        file.path().display(),
    ));
    Ok(config)
}

impl Player {
    /// A player of an open pack.
    pub(crate) fn new(file: Arc<PackFile>, options: PlayerOptions) -> anyhow::Result<Self> {
        let about = file.pack().description();
        let grid = about.grid(options.screen);
        let times_ns = file.frame_times()?;
        let tables = Tables::read(&file)?;
        let mut options = options;
        if options.config.needs_signatures() && tables.signatures.is_none() {
            options.config = without_signatures(&options, &file)?;
        }
        let spends = options.config.policy.spends_a_budget();
        check_thresholds(&options.config, &grid)?;
        if options.config.needs_cues() && (tables.cues.is_none() || tables.signatures.is_none()) {
            bail!(
                "{}: has no cues, which tell the variance of cells; prepare it again, or give \
                 --noisy-cells N in place of --noise-threshold",
                file.path().display(),
            );
        }
        let budget = spends.then(|| Budget::new(options.bytes_per_s));
        let mut canvas = Canvas::new(&options.drawing, &grid, about.colour, options.showing)?;
        let samples = options.config.policy == Policy::Sampled;
        let averages = options.showing.interpolation == Interpolation::Blended;
        let sampling = samples.then(|| Sampling::new(&options.config, &options.view, averages));
        if let Some(sampling) = &sampling {
            canvas.sample_by(&sampling.mask, options.showing.interpolation)?;
        }
        Ok(Self {
            chooser: Chooser::new(grid, options.config.clone()),
            judge: options.judged.then(|| {
                (
                    Worth::judge(&grid),
                    LossMeter::new(&grid, &Parameters::default()),
                )
            }),
            budget,
            shown_until: Seconds(0.0),
            tables,
            config: options.config,
            pool: options.decoding.pool(Arc::clone(&file))?,
            canvas,
            sampling,
            blurs: options.showing.blurs,
            view: options.view,
            grid,
            times_ns,
            fetched: HashSet::new(),
            before: None,
            paced: options.paced,
            failed: 0,
            file,
        })
    }

    /// What shows the picture, while the head looks ahead.
    pub(crate) fn view(&self) -> EyeView {
        self.view
    }

    /// The policy with its parameters.
    pub(crate) fn config(&self) -> &PolicyConfig {
        &self.config
    }

    /// The tiles of the pack.
    pub(crate) fn grid(&self) -> &TileGrid {
        &self.grid
    }

    /// What a graphics device decoded so far.
    pub(crate) fn device_use(&self) -> DeviceUse {
        self.pool.device_use()
    }

    /// A resident tile by itself, in its own pixels; `None` when nothing draws.
    pub(crate) fn read_tile(&mut self, tile: Tile) -> anyhow::Result<Option<RgbaImage>> {
        let colour = self.file.pack().description().colour;
        let picture = self.canvas.read_tile(tile)?;
        Ok(picture.map(|picture| RgbaImage::from_planes(&picture, colour)))
    }

    /// Media time of a frame.
    pub(crate) fn time(&self, frame: u32) -> Seconds {
        Seconds(self.times_ns[frame as usize] as f64 / 1e9)
    }

    /// Makes `frame` the first to be played: what is spent counts from there.
    pub(crate) fn begin_at(&mut self, frame: u32) {
        self.shown_until = self.time(frame);
    }

    /// The head of this run's session log.
    pub(crate) fn session_head(&self) -> SessionHead {
        let name = self
            .file
            .path()
            .file_name()
            .unwrap_or_default()
            .to_string_lossy();
        SessionHead::new(&name, &self.grid, self.config.clone(), &self.view)
    }

    /// Selects, decodes and uploads one frame for where the eye looks at its time.
    pub(crate) fn play(
        &mut self,
        frame: u32,
        source: &mut GazeSource,
    ) -> anyhow::Result<FrameReport> {
        let look = source.look(self.time(frame));
        self.show(frame, &look)
    }

    /// The same for a viewer who is known; shown at the time of the gaze.
    pub(crate) fn show(&mut self, frame: u32, look: &Look) -> anyhow::Result<FrameReport> {
        let (gaze, view) = (look.gaze, self.turned(look.head));
        let begun = Instant::now();
        let (given, selection) = self.choose(frame, look);
        let choose = begun.elapsed();
        let wanted = self.with_coarsest(&selection);
        let period = self.period(frame);
        let deadline = begun + period.mul_f64(READY);
        let begun = Instant::now();
        let decoded = self.decode(frame, &gaze, &wanted, deadline);
        let decode = begun.elapsed();
        let new_bytes = self.fetch(&wanted, frame);
        let decoded_pixels = decoded
            .iter()
            .map(|done| u64::from(done.decoded) * self.grid.tile_pixels(done.tile))
            .sum();
        let begun = Instant::now();
        let (tiles, failed_tiles) = self.make_resident(frame, decoded)?;
        self.show_round(&given.gaze, &view)?;
        let upload = begun.elapsed();
        let pixels = self.pixels(&wanted);
        let level_changes = self
            .before
            .as_ref()
            .map_or(0, |before| selection.levels.changes_from(before));
        let session = SessionFrame::new(frame, &given, &self.grid, &selection);
        let shown: HashSet<Tile> = tiles.iter().copied().collect();
        let missing: Vec<Tile> = wanted
            .into_iter()
            .filter(|tile| !shown.contains(tile))
            .collect();
        let stood_in = (!missing.is_empty()).then(|| self.levels_of(&shown));
        let seen = stood_in.as_ref().unwrap_or(&selection.levels);
        let judged = self.judged(frame, &gaze, view, seen);
        let follows = self.before.replace(selection.levels).is_some();
        Ok(FrameReport {
            session,
            gaze,
            gaze_error_deg: angle_between(gaze.gaze_in_content, given.gaze.gaze_in_content)
                .to_degrees(),
            detail_share: judged.map(|[share, _]| share),
            expected_loss: judged.map(|[_, loss]| loss),
            view,
            histogram: histogram(&self.grid, &tiles),
            late: follows && choose + decode > period,
            missing,
            tiles,
            pixels,
            share: pixels as f64 / self.grid.surface.pixels() as f64,
            decoded_pixels,
            new_bytes,
            choose,
            decode,
            upload,
            wrong_frame_tiles: self.canvas.wrong_frame_tiles(),
            failed_tiles,
            level_changes,
        })
    }

    /// Chooses for a frame that is not shown: what is chosen later depends on what was before.
    pub(crate) fn pass(&mut self, frame: u32, look: &Look) {
        let (_, selection) = self.choose(frame, look);
        self.before = Some(selection.levels);
    }

    /// The level of every cell where these tiles are all that is shown.
    fn levels_of(&self, shown: &HashSet<Tile>) -> LevelMap {
        let coarsest = self.grid.coarsest();
        LevelMap::from_cells(&self.grid, |cell| {
            let is_shown = |level: &u8| shown.contains(&self.grid.tile_over(cell, *level));
            (0..coarsest).find(is_shown).unwrap_or(coarsest)
        })
    }

    /// Pixels shown of these tiles.
    fn pixels(&self, wanted: &[Tile]) -> u64 {
        match &self.sampling {
            Some(sampling) => sampling.mask.places.len() as u64,
            None => wanted.iter().map(|tile| self.grid.tile_pixels(*tile)).sum(),
        }
    }

    /// Moves what follows the gaze: the samples and the blur.
    fn show_round(&mut self, gaze: &GazeSample, view: &EyeView) -> anyhow::Result<()> {
        self.canvas
            .set_blur(self.blurs.then(|| RadialBlur::round(gaze.gaze_in_content)));
        match &self.sampling {
            Some(sampling) => {
                let samples = sampling.gather(&self.grid, view, gaze);
                self.canvas.show_samples(&samples)
            }
            None => Ok(()),
        }
    }

    /// Makes a decoded tile resident; where samples are shown, only the coarsest level is, and the
    /// samples are gathered from the others.
    fn take(&mut self, tile: Tile, frame: u32, picture: Picture) -> anyhow::Result<()> {
        let is_base = tile.level == self.grid.coarsest();
        match &mut self.sampling {
            Some(sampling) if is_base => {
                sampling.keep(tile, picture.clone());
                self.canvas.upload(tile, frame, picture)
            }
            Some(sampling) => {
                sampling.keep(tile, picture);
                Ok(())
            }
            None => self.canvas.upload(tile, frame, picture),
        }
    }

    /// Chooses for what was expected of the viewer, within what can arrive until then.
    fn choose(&mut self, frame: u32, look: &Look) -> (Given, Selection) {
        let expected = &look.expected;
        let perception = &self.config.perception;
        let moment = Moment {
            gaze: expected.gaze,
            view: Some(self.turned(look.head_expected)),
            state: perception.eye_state(expected.event, expected.since_saccade),
        };
        let until = Seconds(look.gaze.time.0 + self.period(frame).as_secs_f64());
        let passed = Seconds(until.0 - self.shown_until.0);
        self.shown_until = until;
        let budget = self.budget.as_mut().map(|budget| budget.after(passed));
        let content = self.tables.content(&self.file);
        let content = content.as_ref().map(|content| content as &dyn Content);
        let selection = self.chooser.choose(content, frame, &moment, budget);
        if let Some(budget) = &mut self.budget {
            budget.spend(self.chooser.spent());
        }
        let given = Given {
            gaze: moment.gaze,
            head: look.head_expected,
            state: moment.state,
            budget,
        };
        (given, selection)
    }

    /// Share of the visible detail that is shown, and the quality difference that is expected of
    /// it.
    fn judged(
        &self,
        frame: u32,
        gaze: &GazeSample,
        view: EyeView,
        shown: &LevelMap,
    ) -> Option<[f64; 2]> {
        let (judge, meter) = self.judge.as_ref()?;
        let content = self.tables.content(&self.file)?;
        let moment = Moment {
            gaze: *gaze,
            view: Some(view),
            state: EyeState::Steady,
        };
        let gains = judge.gains(&self.grid, &content, frame, &moment);
        let losses = meter.losses(&self.grid, &content, frame, &moment);
        Some([gains.share(&self.grid, shown), losses.pooled(shown)])
    }

    fn turned(&self, head: HeadPose) -> EyeView {
        match self.grid.surface.projection {
            Projection::Flat => self.view,
            Projection::Cube => EyeView {
                axes: head.axes(),
                ..self.view
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
        let nominal = 1e9 / self.file.pack().description().fps();
        Duration::from_nanos(next.map_or(nominal as u64, |ns| ns.max(1) as u64))
    }

    /// The chosen tiles and the whole coarsest level, which is always resident.
    fn with_coarsest(&self, selection: &Selection) -> Vec<Tile> {
        let coarsest = self.grid.coarsest();
        let finer = selection
            .tiles
            .iter()
            .copied()
            .filter(|tile| tile.level != coarsest);
        self.grid.tiles_of(coarsest).chain(finer).collect()
    }

    /// Decodes tiles, nearest to the gaze first; paced, only those that are there in time and the
    /// coarsest level.
    fn decode(
        &mut self,
        frame: u32,
        gaze: &GazeSample,
        wanted: &[Tile],
        deadline: Instant,
    ) -> Vec<DecodedTile> {
        let coarsest = self.grid.coarsest();
        let mut order: Vec<(u8, f64, Tile)> = wanted
            .iter()
            .map(|tile| {
                let centre = self.grid.centre(*tile);
                let angle = angle_between(gaze.gaze_in_content, centre).0;
                (u8::from(tile.level != coarsest), angle, *tile)
            })
            .collect();
        order.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        order
            .iter()
            .for_each(|(_, _, tile)| self.pool.request(*tile, frame));
        let mut base = order.iter().filter(|(finer, ..)| *finer == 0).count();
        let mut done = Vec::with_capacity(wanted.len());
        while done.len() < wanted.len() {
            let deadline = (self.paced && base == 0).then_some(deadline);
            let Some(tile) = self.pool.receive(deadline) else {
                break;
            };
            // Tiles of an earlier frame that came too late for it.
            if tile.frame != frame {
                continue;
            }
            base -= usize::from(tile.tile.level == coarsest && base > 0);
            done.push(tile);
        }
        self.pool.cancel();
        done
    }

    /// Bytes of the units of these tiles that this run had not needed before.
    fn fetch(&mut self, tiles: &[Tile], frame: u32) -> u64 {
        let pack = self.file.pack();
        let units = tiles.iter().map(|tile| pack.unit(*tile, frame));
        let new = units.filter(|unit| self.fetched.insert(*unit));
        new.map(|unit| u64::from(pack.entry(unit).bytes)).sum()
    }

    /// Says once that tiles are damaged; a coarser level stands in for them.
    fn report_failure(&self, tile: Tile, frame: u32, error: &TileError) {
        let Tile { level, face, x, y } = tile;
        output::say(&format!(
            "{}: level {level}, face {face}, column {x}, row {y} cannot be decoded at frame \
             {frame}; a coarser level is shown ({error}; `foveal verify` lists all damage)",
            self.file.path().display(),
        ));
    }

    /// Uploads what was decoded for `frame`; a finer tile that failed leaves the coarser level.
    fn make_resident(
        &mut self,
        frame: u32,
        decoded: Vec<DecodedTile>,
    ) -> anyhow::Result<(Vec<Tile>, usize)> {
        self.canvas.begin_frame(frame);
        self.sampling.iter_mut().for_each(Sampling::begin_frame);
        let (mut tiles, mut failed) = (Vec::with_capacity(decoded.len()), 0);
        for DecodedTile { tile, picture, .. } in decoded {
            match picture {
                Ok((picture, number)) if number == i64::from(frame) => {
                    self.take(tile, frame, picture)?;
                    tiles.push(tile);
                }
                Ok((_, number)) => bail!(
                    "{}: asked for frame {frame} of {tile:?}, the decoder gave {number}",
                    self.file.path().display()
                ),
                Err(error) if tile.level == self.grid.coarsest() => {
                    let pack = self.file.path().display();
                    return Err(error).with_context(|| {
                        format!("{pack}: frame {frame} of the coarsest level, which must be whole")
                    });
                }
                Err(error) => {
                    if self.failed == 0 {
                        self.report_failure(tile, frame, &error);
                    }
                    self.failed += 1;
                    failed += 1;
                }
            }
        }
        self.canvas.retain(&tiles);
        self.canvas.settle()?;
        tiles.sort_by_key(|tile| (std::cmp::Reverse(tile.level), self.grid.rank(*tile)));
        Ok((tiles, failed))
    }
}
