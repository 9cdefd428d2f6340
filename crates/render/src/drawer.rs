//! What draws what a session shows: the GPU, the CPU twin of its passes, or nothing?

use crate::asset_drawer::AssetDrawer;
use crate::draw_device::{DrawDevice, DrawnPicture};
use crate::drawn_scene::DrawnScene;
use crate::error::RenderError;
#[cfg(not(target_arch = "wasm32"))]
use crate::image::RgbaImage;
use crate::params::Overlay;
use crate::tiles::drawer::{TileDrawer, TileStyle};
use foveal_core::content::opened::Opened;
use foveal_core::content::payload::Payload;
use foveal_core::content::scene::Scene;
use foveal_core::content::unit::{AssetId, UnitRef};
use foveal_core::content::video::Video;
use foveal_core::perception::footprints::{Footprints, Measured};
use foveal_core::perception::moment::Moment;
use foveal_core::session::actions::{Cache, Now, SessionAction, SessionEvent};
use foveal_core::session::session::Session;
use foveal_core::session::unit_states::Piece;
use foveal_core::view::eye_view::EyeView;
use std::collections::HashSet;
use std::sync::Arc;

/// Resident units of assets and what draws them, one drawer an asset, in a session's order.
///
/// Assets are drawn in that order into one picture, each over those before it: a scene stands in
/// front of a video, which covers all of the picture.
pub struct Drawer {
    device: DrawDevice,
    assets: Vec<AssetDrawer>,
    /// Units that did not fit to what is there.
    refused: u64,
    /// Units for which the bound of GPU memory left no room when they came.
    without_room: HashSet<UnitRef>,
    /// What was to be shown again and was not there.
    evicted: Vec<Piece>,
}

fn of_asset(units: &[UnitRef], asset: AssetId) -> Vec<UnitRef> {
    let of_asset = units.iter().filter(|unit| unit.asset == asset);
    of_asset.copied().collect()
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
        Ok(Self::of(device, AssetDrawer::Tiles(Box::new(tiles))))
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
        let scene = DrawnScene::new(device, scene, most_bytes)?;
        Ok(Self::of(device, AssetDrawer::Scene(Box::new(scene))))
    }

    /// Draws what was opened: tiles in a style, units of a scene in so many bytes on the GPU.
    ///
    /// # Errors
    /// The device cannot hold what that needs.
    pub fn of_opened(
        device: &DrawDevice,
        opened: &Opened,
        style: TileStyle,
        most_bytes: u64,
    ) -> Result<Self, RenderError> {
        match opened {
            Opened::Video(video) => Self::new(device, video, style),
            Opened::Scene(scene) => Self::of_scene(device, scene, most_bytes),
        }
    }

    fn of(device: &DrawDevice, asset: AssetDrawer) -> Self {
        Self {
            device: device.clone(),
            assets: vec![asset],
            refused: 0,
            without_room: HashSet::new(),
            evicted: Vec::new(),
        }
    }

    /// Draws the assets of another after its own, on its own device: both must be of the same.
    #[must_use]
    pub fn then(mut self, other: Self) -> Self {
        self.assets.extend(other.assets);
        self
    }

    /// What draws.
    #[must_use]
    pub fn device(&self) -> &DrawDevice {
        &self.device
    }

    /// What only tiles have, of the first asset that is of tiles.
    #[must_use]
    pub fn tiles(&self) -> Option<&TileDrawer> {
        self.assets.iter().find_map(|asset| match asset {
            AssetDrawer::Tiles(tiles) => Some(&**tiles),
            AssetDrawer::Scene(_) => None,
        })
    }

    /// The same, to be changed.
    pub fn tiles_mut(&mut self) -> Option<&mut TileDrawer> {
        self.assets.iter_mut().find_map(|asset| match asset {
            AssetDrawer::Tiles(tiles) => Some(&mut **tiles),
            AssetDrawer::Scene(_) => None,
        })
    }

    /// What only scenes have, of the first asset that is one.
    #[must_use]
    pub fn scene(&self) -> Option<&DrawnScene> {
        self.assets.iter().find_map(|asset| match asset {
            AssetDrawer::Scene(scene) => Some(&**scene),
            AssetDrawer::Tiles(_) => None,
        })
    }

    /// The same, to be changed.
    pub fn scene_mut(&mut self) -> Option<&mut DrawnScene> {
        self.scenes().next().map(|(_, scene)| scene)
    }

    /// All scenes, each with its asset.
    fn scenes(&mut self) -> impl Iterator<Item = (AssetId, &mut DrawnScene)> {
        let numbered = (0..).map(AssetId).zip(&mut self.assets);
        numbered.filter_map(|(asset, drawer)| match drawer {
            AssetDrawer::Scene(scene) => Some((asset, &mut **scene)),
            AssetDrawer::Tiles(_) => None,
        })
    }

    /// What a session that chooses by it is to take of what parts of the view units would refine:
    /// what was measured since the last call. Begins to measure what is drawn now, where that is
    /// due.
    ///
    /// # Errors
    /// The device was lost, or binds no buffer for as many units.
    pub fn measure(
        &mut self,
        session: &Session,
        moment: &Moment,
    ) -> Result<Vec<SessionEvent>, RenderError> {
        let (mut events, mut measuring) = (Vec::new(), None);
        if !session.needs_footprints() {
            return Ok(events);
        }
        let is_shown = session.shown_tick().is_some();
        for (asset, scene) in self.scenes() {
            events.extend(scene.measured()?.map(|seen| measured(asset, seen)));
            if is_shown && scene.is_due(moment) {
                scene.begin_measuring(moment)?;
            }
            measuring = Some(measuring.unwrap_or(false) | scene.is_measuring());
        }
        events.extend(measuring.map(|is_under_way| SessionEvent::Measuring { is_under_way }));
        Ok(events)
    }

    /// What a session is to take of how much is in use, where it asks for that.
    pub fn count(&mut self) -> SessionEvent {
        let tiles = self.tiles_mut();
        let wrong = tiles.map_or(0, TileDrawer::wrong_frame_units);
        SessionEvent::Counted {
            gpu_bytes: self.gpu_bytes(),
            wrong_frame_units: wrong as u64,
        }
    }

    /// Keeps room for the pictures of these views; what a session is to take of how many bytes
    /// units may use on the GPU next to them, and nothing where that is not bounded.
    ///
    /// # Errors
    /// The device was lost.
    pub fn expect(&mut self, views: &[EyeView]) -> Result<Option<SessionEvent>, RenderError> {
        let mut least = None;
        for (_, scene) in self.scenes() {
            let room = scene.expect(views)?;
            least = least.into_iter().chain(room).min();
        }
        Ok(least.map(|bytes| SessionEvent::GpuRoom { bytes }))
    }

    /// Makes a piece resident.
    ///
    /// # Errors
    /// It is not what its unit should be, or the device was lost.
    pub fn upload(&mut self, piece: Piece, payload: Payload) -> Result<(), RenderError> {
        let asset = self.assets.get_mut(usize::from(piece.unit.asset.0));
        let asset = asset.ok_or(RenderError::OtherKind)?;
        match asset.upload(piece, payload)? {
            true => self.without_room.remove(&piece.unit),
            false => self.without_room.insert(piece.unit),
        };
        Ok(())
    }

    /// Draws only `shown` units and the coarsest level. Of the others those stay that are
    /// `staying`, first what is to stay longest, each after those that it needs.
    pub fn keep(&mut self, shown: &[UnitRef], staying: &[UnitRef]) {
        for (asset, drawer) in (0..).map(AssetId).zip(&mut self.assets) {
            drawer.keep(&of_asset(shown, asset), &of_asset(staying, asset));
        }
    }

    /// Draws a piece again that stayed; one that did not is reported as evicted.
    fn show(&mut self, piece: Piece) -> bool {
        let asset = self.assets.get_mut(usize::from(piece.unit.asset.0));
        let is_there = asset.is_some_and(|asset| asset.show(piece));
        self.evicted.extend((!is_there).then_some(piece));
        is_there
    }

    /// What a session is to take before its next step of what gave way to something else; `None`
    /// where nothing did.
    pub fn take_evicted(&mut self) -> Option<SessionEvent> {
        let mut evicted = std::mem::take(&mut self.evicted);
        for (asset, drawer) in (0..).map(AssetId).zip(&mut self.assets) {
            evicted.extend(drawer.take_evicted(asset));
        }
        (!evicted.is_empty()).then_some(SessionEvent::Evicted(evicted))
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
        self.spare(&actions);
        for action in actions {
            match action {
                SessionAction::BeginFrame(frame) => {
                    self.begin_frame(frame);
                    changed = true;
                }
                SessionAction::Upload(piece) => {
                    if let Some(payload) = cache.take(piece) {
                        match self.upload(piece, payload) {
                            Ok(()) => came.push(piece.unit),
                            // What is damaged so that it does not fit is left coarse.
                            Err(error) if error.is_of_unit() => self.refused += 1,
                            Err(other) => return Err(other),
                        }
                        changed = true;
                    }
                }
                SessionAction::Show(piece) => {
                    let is_shown = self.show(piece);
                    came.extend(is_shown.then_some(piece.unit));
                    changed = true;
                }
                SessionAction::Keep { shown, staying } => {
                    self.keep(&shown, &staying);
                    changed = true;
                }
                SessionAction::Drop(piece) => drop(cache.take(piece)),
                other => left.push(other),
            }
        }
        for (asset, scene) in self.scenes() {
            let came = came.iter().filter(|unit| unit.asset == asset);
            let came = came.map(|it| it.unit).filter(|unit| scene.morphs(*unit));
            let came: Vec<_> = came.collect();
            changed |= scene.morph(&came, now);
        }
        Ok((changed, left))
    }

    /// What is to be shown again does not give way to what comes before.
    fn spare(&mut self, actions: &[SessionAction]) {
        let shown = actions.iter().filter_map(|action| match action {
            SessionAction::Show(piece) => Some(piece.unit),
            _ => None,
        });
        let shown: Vec<UnitRef> = shown.collect();
        for (asset, drawer) in (0..).map(AssetId).zip(&mut self.assets) {
            drawer.spare(&of_asset(&shown, asset));
        }
    }

    /// From now on source frame `frame` of videos is shown.
    fn begin_frame(&mut self, frame: u32) {
        for asset in &mut self.assets {
            if let AssetDrawer::Tiles(tiles) = asset {
                tiles.begin_frame(frame);
            }
        }
    }

    /// Whether units of a scene are on their way to their places: the picture changes by itself
    /// until they are there.
    #[must_use]
    pub fn is_morphing(&self) -> bool {
        self.assets.iter().any(|asset| match asset {
            AssetDrawer::Tiles(_) => false,
            AssetDrawer::Scene(scene) => scene.is_morphing(),
        })
    }

    /// Units for which the bound of GPU memory left no room when they last came: coarser ones are
    /// shown.
    #[must_use]
    pub fn units_without_room(&self) -> usize {
        self.without_room.len()
    }

    /// Units that did not fit to those that were there: they are damaged, and so are those that
    /// need them; coarser ones are shown.
    #[must_use]
    pub fn refused_units(&self) -> u64 {
        self.refused
    }

    /// Bytes of GPU memory in use: of tiles, samples and tables of a video; of a scene also of
    /// pictures and their depths, which count against its bound.
    #[must_use]
    pub fn gpu_bytes(&self) -> u64 {
        self.assets.iter().map(AssetDrawer::gpu_bytes).sum()
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
        let Some((last, before)) = self.assets.split_last_mut() else {
            return Ok(None);
        };
        let under = AssetDrawer::all_under(before, &self.device, view, marks)?;
        last.draw(&under, view, marks)
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
        let Some((last, before)) = self.assets.split_last_mut() else {
            return Ok(None);
        };
        let under = AssetDrawer::all_under(before, &self.device, view, marks)?;
        last.read(&under, view, marks)
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
        let Some((last, before)) = self.assets.split_last_mut() else {
            return Ok(None);
        };
        let under = AssetDrawer::all_under(before, &self.device, view, marks)?;
        last.picture(&under, view, marks)
    }

    /// [`Self::measure`], waiting for what is drawn now.
    ///
    /// # Errors
    /// The device was lost, or binds no buffer for as many units.
    pub fn measure_now(
        &mut self,
        session: &Session,
        moment: &Moment,
    ) -> Result<Vec<SessionEvent>, RenderError> {
        let is_shown = session.needs_footprints() && session.shown_tick().is_some();
        let due = self
            .scenes()
            .filter(|(_, scene)| is_shown && scene.is_due(moment));
        due.map(|(asset, scene)| Ok(measured(asset, scene.footprints(moment)?)))
            .collect()
    }
}

fn measured(asset: AssetId, footprints: Footprints) -> SessionEvent {
    let measured = Measured::Footprints(footprints);
    SessionEvent::Measured { asset, measured }
}
