//! What of a scene is drawn, and what is on its way there?

use crate::draw_device::{DrawDevice, DrawnPicture};
use crate::error::RenderError;
#[cfg(not(target_arch = "wasm32"))]
use crate::image::RgbaImage;
use crate::params::Overlay;
use crate::scene::coming::Coming;
use crate::scene::layer::SceneLayer;
use crate::scene::morphs::Morphs;
use crate::scene::params::SceneStyle;
use crate::scene_drawer::SceneDrawer;
use crate::under::Under;
use foveal_core::content::demand::Content;
use foveal_core::content::payload::Payload;
use foveal_core::content::scene::Scene;
use foveal_core::content::scene::showing::VisibleSteps;
#[cfg(not(target_arch = "wasm32"))]
use foveal_core::content::scene::worth::shares_of_worth;
use foveal_core::pack::unit::UnitId;
use foveal_core::perception::footprints::Footprints;
use foveal_core::perception::moment::Moment;
#[cfg(not(target_arch = "wasm32"))]
use foveal_core::perception::parameters::Parameters;
use foveal_core::session::actions::Now;
use foveal_core::units::Seconds;
use foveal_core::view::eye_view::EyeView;
#[cfg(not(target_arch = "wasm32"))]
use std::collections::BTreeMap;
use std::collections::HashSet;
use std::sync::Arc;

/// Depth from which on a scene is drawn, in shares of its radius.
const NEAR: f64 = 1e-4;

/// A scene that is an asset of what is shown, and what draws it.
pub struct DrawnScene {
    drawer: SceneDrawer,
    scene: Arc<Scene>,
    morphs: Morphs,
    /// When those on their way were moved last.
    moved: Seconds,
}

impl DrawnScene {
    /// A scene whose units may take `most_bytes` on the GPU; nothing is resident yet.
    ///
    /// # Errors
    /// Its objects stand in more places than the device binds.
    pub(crate) fn new(
        device: &DrawDevice,
        scene: &Arc<Scene>,
        most_bytes: u64,
    ) -> Result<Self, RenderError> {
        let about = scene.pack().description();
        let mut drawer = SceneDrawer::new(device, &about.objects, &about.textures, most_bytes)?;
        drawer.set_refiners(scene.refiners());
        Ok(Self {
            drawer,
            scene: Arc::clone(scene),
            morphs: Morphs::default(),
            moved: Seconds::default(),
        })
    }

    /// Makes a unit resident; `false` where there is no room for it and what is coarser is shown.
    ///
    /// # Errors
    /// It is not what it should be, or the device was lost.
    pub(crate) fn upload(&mut self, unit: UnitId, payload: &Payload) -> Result<bool, RenderError> {
        if payload.view().kind().is_none() {
            return Err(RenderError::OtherKind);
        }
        let row = self.scene.pack().row(unit);
        self.drawer.upload(&Coming {
            unit,
            object: row.object,
            level: self.scene.pack().level_of(unit),
            needs: self.scene.needs(unit),
            part: row.replaces.first().map(|it| it.part),
            payload: payload.view(),
        })
    }

    /// Draws only these units and the coarsest level. Of the others those stay that are `staying`,
    /// first what is to stay longest.
    pub(crate) fn keep(&mut self, units: &HashSet<UnitId>, staying: &[UnitId]) {
        self.drawer.keep(units, staying);
    }

    /// Draws a unit again that stayed; `false` where it did not.
    pub(crate) fn show(&mut self, unit: UnitId) -> bool {
        self.drawer.show(unit)
    }

    /// Whether a unit is on its way once it is drawn.
    pub(crate) fn morphs(&self, unit: UnitId) -> bool {
        self.scene.pack().row(unit).kind.facts().morphs
    }

    /// These do not give way, until others are spared: they are about to be drawn again.
    pub(crate) fn spare(&mut self, units: &[UnitId]) {
        if let Some(layer) = self.drawer.layer() {
            layer.spare(units);
        }
    }

    /// Units that stayed and gave way since this was last asked.
    pub(crate) fn take_evicted(&mut self) -> Vec<UnitId> {
        let layer = self.drawer.layer();
        layer.map(SceneLayer::take_evicted).unwrap_or_default()
    }

    /// Keeps room for the pictures of these views, and returns how many bytes units may use on the
    /// GPU next to them; `None` where no GPU draws.
    ///
    /// # Errors
    /// The device was lost.
    pub fn expect(&mut self, views: &[EyeView]) -> Result<Option<u64>, RenderError> {
        let layer = self.drawer.layer();
        layer.map(|layer| layer.expect(views)).transpose()
    }

    /// Moves on what is on its way, with the units that `came`; whether there is any.
    pub(crate) fn morph(&mut self, came: &[UnitId], now: &Now) -> bool {
        let was_any = self.morphs.is_any();
        if !was_any && came.is_empty() {
            return false;
        }
        let witness = VisibleSteps::new(&now.moment);
        self.morphs.advance(&witness, now.wall);
        for unit in came {
            self.morphs.begin(&self.scene, *unit, &witness, now.wall);
        }
        self.moved = now.wall;
        let changes = was_any || self.morphs.is_any();
        if changes {
            self.drawer.morph(&self.morphs.shares(self.moved));
        }
        changes
    }

    /// Whether units are on their way to their places: the picture changes by itself until they are
    /// there.
    #[must_use]
    pub fn is_morphing(&self) -> bool {
        self.morphs.is_any()
    }

    /// Triangles that the last picture drew.
    #[must_use]
    pub fn triangles_drawn(&self) -> u64 {
        self.drawer.triangles_drawn()
    }

    /// Bytes of GPU memory in use.
    #[must_use]
    pub(crate) fn gpu_bytes(&self) -> u64 {
        self.drawer.gpu_bytes()
    }

    /// The image of units that would refine what a view shows, as
    /// [`SceneLayer::ids`](crate::SceneLayer::ids) draws it; `None` where no GPU draws.
    ///
    /// # Errors
    /// The picture is larger than the device draws.
    pub fn ids(&mut self, view: &EyeView) -> Result<Option<&wgpu::Texture>, RenderError> {
        let style = self.style(None);
        let layer = self.drawer.layer();
        layer.map(|layer| layer.ids(view, &style)).transpose()
    }

    /// What parts of the view units would refine, where that was being measured and is known now.
    ///
    /// # Errors
    /// The device was lost.
    pub(crate) fn measured(&mut self) -> Result<Option<Footprints>, RenderError> {
        self.drawer.measured()
    }

    /// Whether something is being measured.
    pub(crate) fn is_measuring(&self) -> bool {
        self.drawer.is_measuring()
    }

    /// Whether a moment is to be measured that was not.
    pub(crate) fn is_due(&self, moment: &Moment) -> bool {
        self.drawer.is_due(moment)
    }

    /// Begins to measure what is drawn now.
    ///
    /// # Errors
    /// The device was lost, or binds no buffer for as many units.
    pub(crate) fn begin_measuring(&mut self, moment: &Moment) -> Result<(), RenderError> {
        self.drawer.begin_measuring(moment, &self.style(None))
    }

    /// The texture of the picture that a view shows in front of what is under it, with the colours
    /// of levels that `marks` ask for; the next call reuses it. `None` where no GPU draws.
    ///
    /// # Errors
    /// The picture is larger than the device draws.
    pub(crate) fn draw(
        &mut self,
        under: &Under,
        view: &EyeView,
        marks: Option<&Overlay>,
    ) -> Result<Option<&wgpu::Texture>, RenderError> {
        self.drawer.draw(under, view, &self.style(marks))
    }

    /// The same, on its way to main memory; `None` when nothing draws.
    ///
    /// # Errors
    /// The picture is larger than the device draws.
    pub(crate) fn read(
        &mut self,
        under: &Under,
        view: &EyeView,
        marks: Option<&Overlay>,
    ) -> Result<Option<DrawnPicture>, RenderError> {
        self.drawer.read(under, view, &self.style(marks))
    }

    /// How it is drawn with these marks: of them it has the colours of levels.
    fn style(&self, marks: Option<&Overlay>) -> SceneStyle {
        let scene = &self.scene;
        SceneStyle {
            tint: marks.map_or(0.0, |marks| marks.heat),
            look: scene.pack().description().look,
            near: (scene.bounds().radius * NEAR).max(f64::from(f32::MIN_POSITIVE)),
            ..SceneStyle::default()
        }
    }
}

#[cfg(not(target_arch = "wasm32"))]
impl DrawnScene {
    /// The same, once it is there. Blocks.
    ///
    /// # Errors
    /// The picture is larger than the device draws.
    pub(crate) fn picture(
        &mut self,
        under: &Under,
        view: &EyeView,
        marks: Option<&Overlay>,
    ) -> Result<Option<RgbaImage>, RenderError> {
        self.drawer.picture(under, view, &self.style(marks))
    }

    /// The picture that a view shows with every unit in its place already, and of no other asset.
    /// Blocks.
    ///
    /// # Errors
    /// The picture is larger than the device draws.
    pub fn picture_in_place(&mut self, view: &EyeView) -> Result<Option<RgbaImage>, RenderError> {
        self.drawer.morph(&BTreeMap::new());
        let picture = self.picture(&Under::default(), view, None);
        self.drawer.morph(&self.morphs.shares(self.moved));
        picture
    }

    /// What parts of the view units would refine of what is drawn now. Blocks.
    ///
    /// # Errors
    /// The device was lost, or binds no buffer for as many units.
    pub fn footprints(&mut self, moment: &Moment) -> Result<Footprints, RenderError> {
        self.drawer.footprints(moment, &self.style(None))
    }

    /// From now on paints over pictures what each unit that would refine them is worth to this
    /// viewer, with these parameters, by the footprints measured now; or nothing. Blocks.
    ///
    /// # Errors
    /// The device was lost, or binds no buffer for as many units.
    pub fn mark_worth(
        &mut self,
        viewer: Option<(&Parameters, &Moment)>,
    ) -> Result<(), RenderError> {
        let Some((parameters, moment)) = viewer else {
            return self.drawer.mark(None);
        };
        let footprints = self.footprints(moment)?;
        let worths = shares_of_worth(&self.scene, parameters, moment, &footprints);
        self.drawer.mark(Some(&worths))
    }
}
