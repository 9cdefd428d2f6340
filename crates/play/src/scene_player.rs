//! What happens between a gaze and a picture of a scene, step by step?
//!
//! Choose, fetch, parse, draw: steps come one by one, as fast as they can be made, at times that
//! the caller gives.

use crate::error::PlayError;
use crate::rendered_worth::RenderedWorth;
use crate::step::{decide, leave_room};
use foveal_core::content::demand::Content;
use foveal_core::content::payload::Payload;
use foveal_core::content::policy::{ImportanceSource, Policy, PolicyConfig};
use foveal_core::content::scene::Scene;
use foveal_core::content::scene::unit_table::UnitRow;
use foveal_core::content::scene::worth::detail_share;
use foveal_core::content::unit::{AssetId, UnitRef};
use foveal_core::pack::unit::UnitId;
use foveal_core::perception::moment::Moment;
use foveal_core::session::actions::{Cache, Now, Pace, SessionAction, SessionEvent};
use foveal_core::session::bounds::Bounds;
use foveal_core::session::session::{Session, SessionSettings};
use foveal_core::session::unit_states::Piece;
use foveal_core::units::Seconds;
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::mounted::MountedPanel;
use foveal_media::pack::scene_file::SceneFile;
use foveal_render::params::Overlay;
use foveal_render::{DrawDevice, Drawer, DrawnScene, RgbaImage};
use std::collections::HashSet;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Rounds in which what came is shown and more is asked for, at one time: where little may be under
/// way at once, more takes another round.
const MOST_ROUNDS: u32 = 10_000;

/// How a scene is played.
#[derive(Clone)]
pub struct ScenePlayerOptions {
    /// The policy with its parameters.
    pub config: PolicyConfig,
    /// What draws.
    pub drawing: DrawDevice,
    /// What a link brings, for policies that spend a budget; infinite for content at hand.
    pub bytes_per_s: f64,
    /// Bytes that units may take on the GPU.
    pub gpu_bytes: u64,
    /// Receives what a person should know but is not an error.
    pub tell: fn(&str),
}

/// Plays a scene under one policy, without a window.
pub struct ScenePlayer {
    file: Arc<SceneFile>,
    session: Session,
    cache: Cache<Payload>,
    drawer: Drawer,
    /// Units that were needed so far, and the pages of index and table that cover them.
    fetched: HashSet<UnitId>,
    pages: [HashSet<u32>; 2],
    /// What measures worth by pictures, where that is asked for.
    rendered: Option<RenderedWorth>,
    log: String,
    damaged: u64,
    /// Roots of meshes and clouds that are not known to be damaged.
    whole_roots: usize,
    tell: fn(&str),
}

/// What a step was, and what it took.
#[derive(Clone, Debug)]
pub struct SceneReport {
    /// Number of units on screen of each level, finest first.
    pub units_by_level: Vec<u32>,
    /// Bytes of units that this run had not needed before.
    pub unit_bytes: u64,
    /// These units.
    pub new_units: Vec<UnitId>,
    /// Bytes of the pages of index and table that cover them.
    pub page_bytes: u64,
    /// Time of choosing.
    pub choose: Duration,
    /// Time of choosing, parsing and handing what is new to what draws.
    pub cpu: Duration,
}

impl ScenePlayer {
    /// A player of an open scene.
    ///
    /// # Errors
    /// It cannot be drawn.
    pub fn new(file: Arc<SceneFile>, options: ScenePlayerOptions) -> Result<Self, PlayError> {
        let scene = Arc::clone(file.scene());
        let whole_roots = shape_roots(&file);
        // What draws may take an eighth more than units do.
        let most = options.gpu_bytes - options.gpu_bytes / 8;
        let drawer = Drawer::of_scene(&options.drawing, &scene, most)?;
        let config = &options.config;
        let is_rendered =
            config.policy == Policy::Perceptual && config.importance == ImportanceSource::Rendered;
        let rendered = match &options.drawing {
            DrawDevice::Gpu(gpu) if is_rendered => {
                Some(RenderedWorth::new(&file, gpu, &options.config.perception))
            }
            _ => None,
        };
        let spends = options.config.policy.spends_a_budget();
        let settings = SessionSettings {
            policy: options.config,
            bytes_per_s: spends.then_some(options.bytes_per_s),
            since: Some(Seconds(0.0)),
            zooms: false,
            measures: !matches!(options.drawing, DrawDevice::Nothing),
            bounds: Bounds {
                gpu: most,
                ..Bounds::default()
            },
        };
        Ok(Self {
            session: Session::new(vec![scene as Arc<dyn Content>], settings),
            cache: Cache::default(),
            drawer,
            fetched: HashSet::new(),
            pages: Default::default(),
            rendered,
            log: String::new(),
            damaged: 0,
            whole_roots,
            tell: options.tell,
            file,
        })
    }

    /// The same, every moment of which is seen through panels that turn with its head.
    #[must_use]
    pub fn through(mut self, panels: Vec<MountedPanel>) -> Self {
        self.session.take(SessionEvent::Mounted(panels));
        self
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &Arc<Scene> {
        self.file.scene()
    }

    /// What draws what the last step showed.
    pub fn drawer(&mut self) -> &mut Drawer {
        &mut self.drawer
    }

    /// Bytes of units that were fetched again, because they had left the client's memory.
    #[must_use]
    pub fn refetched_bytes(&self) -> u64 {
        self.session.figures().refetched_bytes
    }

    /// The session log so far.
    #[must_use]
    pub fn log(&self) -> &str {
        &self.log
    }

    /// Triangles that the last picture drew.
    #[must_use]
    pub fn triangles_drawn(&self) -> u64 {
        let scene = self.drawer.scene();
        scene.map_or(0, DrawnScene::triangles_drawn)
    }

    /// Units that could not be read so far, or did not fit to what they refine; coarser ones stand
    /// in for them.
    #[must_use]
    pub fn damaged_units(&self) -> u64 {
        self.damaged + self.drawer.refused_units()
    }

    /// The units that were needed so far.
    pub fn fetched(&self) -> impl Iterator<Item = UnitId> {
        self.fetched.iter().copied()
    }

    /// The pack.
    #[must_use]
    pub fn file(&self) -> &SceneFile {
        &self.file
    }

    /// Whether a first frame shows only the roots: what parts of the view units would refine, by
    /// which `perceptual` chooses, is measured on what was drawn before.
    #[must_use]
    pub fn first_is_blind(&self) -> bool {
        self.session.needs_footprints()
    }

    /// Bytes that come before any unit and page: header, description, directory of the table.
    #[must_use]
    pub fn head_bytes(&self) -> u64 {
        self.file.pack().head_bytes(self.file.header())
    }

    /// Chooses, fetches and hands to what draws what a viewer gets who looks so at `time`, until
    /// which the link has brought what is spent.
    ///
    /// # Errors
    /// All roots are damaged, or the device was lost.
    pub fn show(&mut self, time: Seconds, moment: &Moment) -> Result<SceneReport, PlayError> {
        let begun = Instant::now();
        let now = Now {
            wall: time,
            media: Seconds(0.0),
            pace: Pace::Standing,
            drawing: Seconds(0.0),
            until: time,
            moment: moment.clone(),
        };
        leave_room(&mut self.session, &mut self.drawer, moment)?;
        let (mut unit_bytes, mut page_bytes, mut choose) = (0, 0, Duration::ZERO);
        let mut new_units = Vec::new();
        let mut has_measured = false;
        for round in 0..MOST_ROUNDS {
            if !has_measured && self.session.shown_tick().is_some() {
                self.measure(moment)?;
                has_measured = true;
            }
            if let Some(evicted) = self.drawer.take_evicted() {
                self.session.take(evicted);
            }
            let choosing = Instant::now();
            let actions = decide(&mut self.session, &now);
            if round == 0 {
                choose = choosing.elapsed();
            }
            self.perform(actions, &now)?;
            let wanted = self.session.requested().to_vec();
            if wanted.is_empty() {
                break;
            }
            for piece in wanted {
                let unit = piece.unit.unit;
                page_bytes += self.load_pages(unit);
                if self.fetched.insert(unit) {
                    unit_bytes += u64::from(self.file.pack().entry(unit).bytes);
                    new_units.push(unit);
                }
                self.fetch(piece)?;
            }
        }
        self.session
            .take(SessionEvent::Charged { bytes: page_bytes });
        Ok(SceneReport {
            units_by_level: self.session.figures().histogram.clone(),
            unit_bytes,
            new_units,
            page_bytes,
            choose,
            cpu: begun.elapsed(),
        })
    }

    /// Gives the session what parts of the view units would refine.
    fn measure(&mut self, moment: &Moment) -> Result<(), PlayError> {
        let events = match &mut self.rendered {
            Some(rendered) => vec![SessionEvent::Measured {
                asset: AssetId::ONLY,
                measured: rendered.measured(moment)?,
            }],
            None => self.drawer.measure_now(&self.session, moment)?,
        };
        events
            .into_iter()
            .for_each(|event| self.session.take(event));
        Ok(())
    }

    fn perform(&mut self, actions: Vec<SessionAction>, now: &Now) -> Result<(), PlayError> {
        let (_, left) = self.drawer.perform(actions, &mut self.cache, now)?;
        for action in left {
            if let SessionAction::Log(lines) = action {
                self.log.push_str(&lines);
            }
        }
        Ok(())
    }

    /// Reads and parses a unit; one that is damaged leaves coarser ones, and a root all other
    /// objects.
    fn fetch(&mut self, piece: Piece) -> Result<(), PlayError> {
        let unit = piece.unit.unit;
        let event = match self.file.read_unit(unit) {
            Ok(payload) => {
                self.cache.insert(piece, payload);
                SessionEvent::Decoded { piece, frames: 1 }
            }
            Err(error) => {
                if self.is_root_of_shape(unit) {
                    self.whole_roots -= 1;
                    if self.whole_roots == 0 {
                        return Err(error.into());
                    }
                }
                if self.damaged == 0 {
                    let more = "what there is else is shown; `foveal verify` lists all damage";
                    (self.tell)(&format!("{error}; {more}"));
                }
                self.damaged += 1;
                SessionEvent::Damaged { piece, frames: 1 }
            }
        };
        self.session.take(event);
        Ok(())
    }

    fn is_root_of_shape(&self, unit: UnitId) -> bool {
        let row = self.file.pack().row(unit);
        row.needs.is_empty() && row.kind.facts().is_shape
    }

    /// Share of the detail that a viewer could see who looks so, hidden or not, that is on screen.
    #[must_use]
    pub fn detail_share(&self, moment: &Moment) -> f64 {
        let states = self.session.states();
        detail_share(self.scene(), moment, |unit| {
            let asset = AssetId::ONLY;
            states.is_shown(Piece {
                unit: UnitRef { asset, unit },
                frame: 0,
            })
        })
    }

    /// Bytes of the pages that cover a unit and were not loaded before.
    fn load_pages(&mut self, unit: UnitId) -> u64 {
        let pages = self
            .file
            .pack()
            .pages_of(unit)
            .into_iter()
            .zip(&mut self.pages);
        let new = pages.filter_map(|((page, bytes), loaded)| loaded.insert(page).then_some(bytes));
        new.sum()
    }

    /// The picture that a view shows; `None` when nothing draws. What a viewer would see change
    /// comes gradually: in a picture soon after [`Self::show`] it is on its way.
    ///
    /// # Errors
    /// The picture is larger than the device draws.
    pub fn picture(&mut self, view: &EyeView) -> Result<Option<RgbaImage>, PlayError> {
        Ok(self.drawer.picture(view, None)?)
    }

    /// The same with the colours of levels over it.
    ///
    /// # Errors
    /// As there.
    pub fn picture_of_levels(&mut self, view: &EyeView) -> Result<Option<RgbaImage>, PlayError> {
        Ok(self.drawer.picture(view, Some(&Overlay::default()))?)
    }

    /// The same with everything that came in its place.
    ///
    /// # Errors
    /// As there.
    pub fn picture_in_place(&mut self, view: &EyeView) -> Result<Option<RgbaImage>, PlayError> {
        let scene = self.drawer.scene_mut();
        let picture = scene
            .map(|scene| scene.picture_in_place(view))
            .transpose()?;
        Ok(picture.flatten())
    }
}

/// Number of roots that are no pages of textures.
fn shape_roots(file: &SceneFile) -> usize {
    let is_one = |row: &&UnitRow| row.needs.is_empty() && row.kind.facts().is_shape;
    file.pack().rows().iter().filter(is_one).count()
}
