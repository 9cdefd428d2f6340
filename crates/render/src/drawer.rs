//! What draws what a session shows: the GPU, the CPU twin of its passes, or nothing?

use crate::draw_device::{DrawDevice, DrawnPicture};
use crate::error::RenderError;
#[cfg(not(target_arch = "wasm32"))]
use crate::image::RgbaImage;
use crate::kinds::moves;
use crate::params::Overlay;
use crate::scene::coming::Coming;
use crate::scene::drawer::SceneDrawer;
use crate::scene::morphs::Morphs;
use crate::scene::params::SceneStyle;
use crate::tiles::drawer::{TileDrawer, TileStyle};
use foveal_core::content::demand::Content;
use foveal_core::content::payload::Payload;
use foveal_core::content::policy::PolicyConfig;
use foveal_core::content::scene::Scene;
use foveal_core::content::scene::showing::StepWitness;
#[cfg(not(target_arch = "wasm32"))]
use foveal_core::content::scene::worth::shares_of_worth;
use foveal_core::content::unit::UnitRef;
use foveal_core::content::video::Video;
use foveal_core::gaze::sample::GazeSample;
use foveal_core::pack::unit::UnitId;
#[cfg(not(target_arch = "wasm32"))]
use foveal_core::perception::footprints::Footprints;
use foveal_core::perception::moment::Moment;
#[cfg(not(target_arch = "wasm32"))]
use foveal_core::perception::parameters::Parameters;
use foveal_core::session::actions::{Cache, Now, SessionAction};
use foveal_core::session::session::Session;
use foveal_core::session::unit_states::Piece;
use foveal_core::units::Seconds;
use foveal_core::view::eye_view::EyeView;
#[cfg(not(target_arch = "wasm32"))]
use foveal_core::view::picture::Picture;
#[cfg(not(target_arch = "wasm32"))]
use std::collections::BTreeMap;
use std::sync::Arc;

/// Resident units of an asset and what draws them.
pub struct Drawer {
    device: DrawDevice,
    layer: Layer,
    /// Units that did not fit to what is there.
    refused: u64,
    on_the_way: OnTheWay,
}

/// A kind of content, and how it is drawn.
enum Layer {
    Tiles(Box<TileDrawer>),
    Scene(Box<SceneDrawer>, Arc<Scene>),
}

/// Units of a scene on their way, as what draws has them.
#[derive(Default)]
struct OnTheWay {
    morphs: Morphs,
    /// When they were moved last.
    at: Seconds,
}

impl Drawer {
    /// Draws a video; nothing is resident yet.
    ///
    /// # Errors
    /// The device cannot hold what the style needs.
    pub fn new(
        device: &DrawDevice,
        video: &Arc<Video>,
        style: TileStyle,
    ) -> Result<Self, RenderError> {
        let tiles = TileDrawer::new(device, video, style)?;
        Ok(Self {
            device: device.clone(),
            layer: Layer::Tiles(Box::new(tiles)),
            refused: 0,
            on_the_way: OnTheWay::default(),
        })
    }

    /// Draws a scene whose units may take `most_bytes` on the GPU; nothing is resident yet.
    ///
    /// # Errors
    /// Its objects stand in more places than the device binds.
    pub fn of_scene(
        device: &DrawDevice,
        scene: &Arc<Scene>,
        most_bytes: u64,
    ) -> Result<Self, RenderError> {
        let about = scene.pack().description();
        let mut drawer = SceneDrawer::new(device, &about.objects, &about.textures, most_bytes)?;
        drawer.set_refiners(scene.refiners());
        Ok(Self {
            device: device.clone(),
            layer: Layer::Scene(Box::new(drawer), Arc::clone(scene)),
            refused: 0,
            on_the_way: OnTheWay::default(),
        })
    }

    /// What draws.
    #[must_use]
    pub fn device(&self) -> &DrawDevice {
        &self.device
    }

    /// How tiles become a picture; of a scene as by default.
    #[must_use]
    pub fn style(&self) -> TileStyle {
        match &self.layer {
            Layer::Tiles(tiles) => tiles.style(),
            Layer::Scene(..) => TileStyle::default(),
        }
    }

    /// From now on shows tiles like this; `true` where all of them must come again. What cannot be
    /// shown leaves everything as it was.
    ///
    /// # Errors
    /// The device cannot hold what the style needs.
    pub fn restyle(&mut self, style: TileStyle) -> Result<bool, RenderError> {
        match &mut self.layer {
            Layer::Tiles(tiles) => tiles.restyle(style),
            Layer::Scene(..) => Ok(false),
        }
    }

    /// Makes the mask that samples are shown by, where there is none for this view; takes about a
    /// second. `true` where tiles must come again to be sampled.
    ///
    /// # Errors
    /// The mask is larger than the device binds.
    pub fn prepare(&mut self, config: &PolicyConfig, view: &EyeView) -> Result<bool, RenderError> {
        match &mut self.layer {
            Layer::Tiles(tiles) => tiles.prepare(config, view),
            Layer::Scene(..) => Ok(false),
        }
    }

    /// Number of samples that are shown; `None` where tiles or meshes are.
    #[must_use]
    pub fn samples(&self) -> Option<usize> {
        match &self.layer {
            Layer::Tiles(tiles) => tiles.samples(),
            Layer::Scene(..) => None,
        }
    }

    /// Triangles of a scene that the last picture drew; of video none.
    #[must_use]
    pub fn triangles_drawn(&self) -> u64 {
        match &self.layer {
            Layer::Tiles(_) => 0,
            Layer::Scene(scene, _) => scene.triangles_drawn(),
        }
    }

    /// Gives a session what parts of the view units would refine, where it chooses by that: what
    /// was measured since the last call. Begins to measure what is drawn now, where that is due.
    ///
    /// # Errors
    /// The device was lost, or binds no buffer for as many units.
    pub fn measure(&mut self, session: &mut Session, moment: &Moment) -> Result<(), RenderError> {
        match &mut self.layer {
            Layer::Tiles(_) => Ok(()),
            Layer::Scene(drawer, scene) => drawer.measure(session, moment, &style_of(scene, None)),
        }
    }

    /// The image of units that would refine what a view shows of a scene, as
    /// [`SceneLayer::ids`](crate::SceneLayer::ids) draws it; `None` of a video, and where no GPU
    /// draws.
    ///
    /// # Errors
    /// The picture is larger than the device draws.
    pub fn ids(&mut self, view: &EyeView) -> Result<Option<&wgpu::Texture>, RenderError> {
        let Layer::Scene(drawer, scene) = &mut self.layer else {
            return Ok(None);
        };
        let style = style_of(scene, None);
        let layer = drawer.layer();
        layer.map(|layer| layer.ids(view, &style)).transpose()
    }

    /// Moves what follows the gaze: the samples and the blur.
    ///
    /// # Errors
    /// The device was lost.
    pub fn follow(&mut self, gaze: &GazeSample, view: &EyeView) -> Result<(), RenderError> {
        match &mut self.layer {
            Layer::Tiles(tiles) => tiles.follow(gaze, view),
            Layer::Scene(..) => Ok(()),
        }
    }

    /// From now on source frame `frame` is shown.
    pub fn begin_frame(&mut self, frame: u32) {
        if let Layer::Tiles(tiles) = &mut self.layer {
            tiles.begin_frame(frame);
        }
    }

    /// Makes a piece resident.
    ///
    /// # Errors
    /// It is not what its unit should be, or the device was lost.
    pub fn upload(&mut self, piece: Piece, payload: Payload) -> Result<(), RenderError> {
        match (&mut self.layer, payload) {
            (Layer::Tiles(tiles), Payload::Picture(picture)) => tiles.upload(piece, picture),
            (Layer::Scene(drawer, scene), payload) if !matches!(payload, Payload::Picture(_)) => {
                let unit = piece.unit.unit;
                let row = scene.pack().row(unit);
                let is_there = drawer.upload(&Coming {
                    unit,
                    object: row.object,
                    level: scene.pack().level_of(unit),
                    needs: scene.needs(unit),
                    part: row.replaces.first().map(|it| it.cluster),
                    says: payload.view(),
                })?;
                self.refused += u64::from(!is_there);
                Ok(())
            }
            _ => Err(RenderError::OtherKind),
        }
    }

    /// Evicts all units but these and the coarsest level.
    pub fn keep(&mut self, units: &[UnitRef]) {
        match &mut self.layer {
            Layer::Tiles(tiles) => tiles.keep(units),
            Layer::Scene(scene, _) => scene.keep(&units.iter().map(|it| it.unit).collect()),
        }
    }

    /// Does what of a session's actions is drawing, with the payloads that were kept for it, for a
    /// viewer at this moment. Returns whether the picture changed, and what is left to do.
    ///
    /// What a viewer would see change in a scene comes gradually over a fifth of a second:
    /// [`Self::is_morphing`] until then.
    ///
    /// # Errors
    /// A piece is not what its unit should be, or the device was lost.
    pub fn perform(
        &mut self,
        actions: Vec<SessionAction>,
        cache: &mut Cache<Payload>,
        now: &Now,
    ) -> Result<(bool, Vec<SessionAction>), RenderError> {
        let (mut changed, mut left, mut came) = (false, Vec::new(), Vec::new());
        for action in actions {
            match action {
                SessionAction::BeginFrame(frame) => {
                    self.begin_frame(frame);
                    changed = true;
                }
                SessionAction::Upload(piece) => {
                    if let Some(payload) = cache.take(piece) {
                        let moves = moves(payload.view());
                        match self.upload(piece, payload) {
                            Ok(()) => came.extend(moves.then_some(piece.unit.unit)),
                            // What is damaged so that it does not fit is left coarse.
                            Err(error) if error.is_of_unit() => self.refused += 1,
                            Err(other) => return Err(other),
                        }
                        changed = true;
                    }
                }
                SessionAction::Keep(units) => {
                    self.keep(&units);
                    changed = true;
                }
                SessionAction::Drop(piece) => drop(cache.take(piece)),
                other => left.push(other),
            }
        }
        changed |= self.morph(&came, now);
        Ok((changed, left))
    }

    /// Moves on what is on its way in a scene, with the units that `came`; whether there is any.
    fn morph(&mut self, came: &[UnitId], now: &Now) -> bool {
        let (Layer::Scene(drawer, scene), OnTheWay { morphs, at }) =
            (&mut self.layer, &mut self.on_the_way)
        else {
            return false;
        };
        let was_any = morphs.is_any();
        if !was_any && came.is_empty() {
            return false;
        }
        let witness = StepWitness::new(&now.moment);
        morphs.advance(&witness, now.wall);
        for unit in came {
            morphs.begin(scene, *unit, &witness, now.wall);
        }
        *at = now.wall;
        let changes = was_any || morphs.is_any();
        if changes {
            drawer.morph(&morphs.shares(*at));
        }
        changes
    }

    /// Whether units of a scene are on their way to their places: the picture changes by itself
    /// until they are there.
    #[must_use]
    pub fn is_morphing(&self) -> bool {
        self.on_the_way.morphs.is_any()
    }

    /// Units of a scene that did not fit to those that were there: they are damaged, and so are
    /// those that need them; coarser ones are shown.
    #[must_use]
    pub fn refused_units(&self) -> u64 {
        self.refused
    }

    /// Resident units that hold another frame than the one shown.
    pub fn wrong_frame_units(&mut self) -> usize {
        match &mut self.layer {
            Layer::Tiles(tiles) => tiles.wrong_frame_units(),
            Layer::Scene(..) => 0,
        }
    }

    /// Bytes of GPU memory in use.
    #[must_use]
    pub fn gpu_bytes(&self) -> u64 {
        match &self.layer {
            Layer::Tiles(tiles) => tiles.gpu_bytes(),
            Layer::Scene(scene, _) => scene.gpu_bytes(),
        }
    }

    /// The texture of the picture that a view shows on the GPU, with `marks` over it if there are
    /// any and tiles lie in the atlas; the next call reuses it. `None` where no GPU draws.
    ///
    /// # Errors
    /// The picture is larger than the device draws.
    pub fn draw(
        &mut self,
        view: &EyeView,
        marks: Option<&Overlay>,
    ) -> Result<Option<&wgpu::Texture>, RenderError> {
        match &mut self.layer {
            Layer::Tiles(tiles) => tiles.draw(view, marks),
            Layer::Scene(drawer, scene) => drawer.draw(view, &style_of(scene, marks)),
        }
    }

    /// The picture that a view shows, on its way to main memory; `None` when nothing draws, or
    /// tiles lie in a texture for every level.
    ///
    /// # Errors
    /// The picture is larger than the device draws.
    pub fn read(
        &mut self,
        view: &EyeView,
        marks: Option<&Overlay>,
    ) -> Result<Option<DrawnPicture>, RenderError> {
        match &mut self.layer {
            Layer::Tiles(tiles) => tiles.read(view, marks),
            Layer::Scene(drawer, scene) => drawer.read(view, &style_of(scene, marks)),
        }
    }
}

#[cfg(not(target_arch = "wasm32"))]
impl Drawer {
    /// The picture that a view shows, with `marks` over it if there are any; `None` when nothing
    /// draws. Blocks.
    ///
    /// # Errors
    /// The picture is larger than the device draws, or marks are asked for where tiles lie in a
    /// texture for every level.
    pub fn picture(
        &mut self,
        view: &EyeView,
        marks: Option<&Overlay>,
    ) -> Result<Option<RgbaImage>, RenderError> {
        match &mut self.layer {
            Layer::Tiles(tiles) => tiles.picture(view, marks),
            Layer::Scene(drawer, scene) => drawer.picture(view, &style_of(scene, marks)),
        }
    }

    /// [`Self::measure`], waiting for what is drawn now.
    ///
    /// # Errors
    /// The device was lost, or binds no buffer for as many units.
    pub fn measure_now(
        &mut self,
        session: &mut Session,
        moment: &Moment,
    ) -> Result<(), RenderError> {
        match &mut self.layer {
            Layer::Tiles(_) => Ok(()),
            Layer::Scene(drawer, scene) => {
                drawer.measure_now(session, moment, &style_of(scene, None))
            }
        }
    }

    /// What parts of the view units of a scene would refine of what is drawn now; of a video none.
    /// Blocks.
    ///
    /// # Errors
    /// The device was lost, or binds no buffer for as many units.
    pub fn footprints(&mut self, moment: &Moment) -> Result<Footprints, RenderError> {
        match &mut self.layer {
            Layer::Tiles(_) => Ok(Footprints::default()),
            Layer::Scene(drawer, scene) => drawer.footprints(moment, &style_of(scene, None)),
        }
    }

    /// From now on paints over pictures of a scene what each unit that would refine them is worth
    /// to this viewer, with these parameters, by the footprints measured now; or nothing. Over a
    /// video it paints nothing. Blocks.
    ///
    /// # Errors
    /// The device was lost, or binds no buffer for as many units.
    pub fn mark_worth(
        &mut self,
        viewer: Option<(&Parameters, &Moment)>,
    ) -> Result<(), RenderError> {
        let Layer::Scene(drawer, scene) = &mut self.layer else {
            return Ok(());
        };
        let Some((parameters, moment)) = viewer else {
            return drawer.mark(None);
        };
        let footprints = drawer.footprints(moment, &style_of(scene, None))?;
        let worths = shares_of_worth(scene, parameters, moment, &footprints);
        drawer.mark(Some(&worths))
    }

    /// [`Self::picture`] with every unit of a scene in its place already.
    ///
    /// # Errors
    /// As there.
    pub fn picture_in_place(&mut self, view: &EyeView) -> Result<Option<RgbaImage>, RenderError> {
        if let Layer::Scene(drawer, _) = &mut self.layer {
            drawer.morph(&BTreeMap::new());
        }
        let picture = self.picture(view, None);
        if let Layer::Scene(drawer, _) = &mut self.layer {
            let OnTheWay { morphs, at } = &self.on_the_way;
            drawer.morph(&morphs.shares(*at));
        }
        picture
    }

    /// Waits until what was uploaded is where it is drawn from.
    ///
    /// # Errors
    /// The device was lost.
    pub fn settle(&mut self) -> Result<(), RenderError> {
        match &mut self.layer {
            Layer::Tiles(tiles) => tiles.settle(),
            Layer::Scene(..) => Ok(()),
        }
    }

    /// The samples of a resident tile, as whatever draws holds them; `None` where it holds none by
    /// themselves, and of a scene. Blocks: for reports, not for playing.
    ///
    /// # Errors
    /// It is not resident.
    pub fn read_unit(&mut self, unit: UnitRef) -> Result<Option<Picture>, RenderError> {
        match &mut self.layer {
            Layer::Tiles(tiles) => tiles.read_unit(unit),
            Layer::Scene(..) => Ok(None),
        }
    }
}

/// Depth from which on a scene is drawn, in shares of its radius.
const NEAR: f64 = 1e-4;

/// How a scene is drawn with these marks: of them it has the colours of levels.
fn style_of(scene: &Scene, marks: Option<&Overlay>) -> SceneStyle {
    SceneStyle {
        tint: marks.map_or(0.0, |marks| marks.heat),
        look: scene.pack().description().look,
        near: (scene.bounds().radius * NEAR).max(f64::from(f32::MIN_POSITIVE)),
        ..SceneStyle::default()
    }
}
