//! What should be drawn of a scene's units?

pub(crate) mod cull_clusters;
mod draw_clusters;
mod draw_points;
mod footprints;
mod halve_depths;
pub(crate) mod layer;
mod mark_units;
pub(crate) mod meshes;
mod pages;
pub(crate) mod points;

use crate::error::RenderError;
use crate::image::RgbaImage;
use crate::scene::coming::{Coming, Refiners};
use crate::scene::footprints::{FootprintSums, GazedParams, footprints_of, pixel_deg2, small_view};
use crate::scene::params::{SceneParams, SceneStyle};
use crate::scene::phase::{Go, Phase};
use crate::scene::placements::Placements;
use crate::twin::shared::scene::SceneInView;
use crate::twin::shared::wgsl::code;
use cull_clusters::DrawnDepths;
use footprints::footprints;
use foveal_core::pack::unit::UnitId;
use foveal_core::perception::footprints::Footprint;
use foveal_core::perception::glance::Glance;
use foveal_core::view::eye_view::EyeView;
use glam::Vec4;
use layer::{Canvas, TwinFrame, TwinLayer};
use mark_units::mark_units;
use std::collections::{BTreeMap, HashSet};
use std::sync::Arc;

/// The units of a scene in main memory, and the pictures that are drawn of them: layers as those of
/// [`SceneLayer`](crate::SceneLayer), without a bound of memory.
pub struct TwinScene {
    layers: Vec<Box<dyn TwinLayer>>,
    placements: Arc<Placements>,
    /// What units are worth, where pictures are to show that.
    worths: Option<Vec<f32>>,
}

impl TwinScene {
    /// These layers of objects that stand there.
    pub(crate) fn of_layers(layers: Vec<Box<dyn TwinLayer>>, placements: Arc<Placements>) -> Self {
        Self {
            layers,
            placements,
            worths: None,
        }
    }

    /// From now on paints over pictures what the unit is worth that would refine what a pixel
    /// shows, 0 to 1 by its number, less than 0 where that is not known; or nothing.
    pub fn mark(&mut self, worths: Option<&[f32]>) {
        self.worths = worths.map(<[f32]>::to_vec);
    }

    /// Adds a unit after its prerequisites.
    ///
    /// # Errors
    /// It does not fit to what is there: nothing changed then.
    pub fn upload(&mut self, coming: &Coming<'_>) -> Result<(), RenderError> {
        let mut layers = self.layers.iter_mut();
        let layer = layers.find(|layer| layer.takes(coming));
        layer.ok_or(RenderError::OtherKind)?.upload(coming)
    }

    /// Takes a unit away.
    ///
    /// # Panics
    /// No other that is there may need it.
    pub fn remove(&mut self, unit: UnitId) {
        let mut layers = self.layers.iter_mut();
        let _ = layers.any(|layer| layer.remove(unit));
    }

    /// Takes all units away but those that are wanted, what these need, and roots.
    pub fn retain(&mut self, wanted: &HashSet<UnitId>) {
        self.keep(wanted, &[]);
    }

    /// Draws only units that are wanted, what these need, and roots; of the others those stay that
    /// are `staying`.
    pub fn keep(&mut self, wanted: &HashSet<UnitId>, staying: &[UnitId]) {
        self.layers
            .iter_mut()
            .for_each(|layer| layer.keep(wanted, staying));
    }

    /// Draws a unit again that stayed, after those that it needs; `false` where it did not stay.
    pub fn show(&mut self, unit: UnitId) -> bool {
        self.layers.iter_mut().any(|layer| layer.show(unit))
    }

    /// From now on these units have gone so much of their way from what is coarser, 0 to 1, and all
    /// others are in their places.
    pub fn morph(&mut self, shares: &BTreeMap<UnitId, f64>) {
        self.layers.iter_mut().for_each(|layer| layer.morph(shares));
    }

    /// Triangles of the clusters that a picture is drawn of, also of those that cannot be seen,
    /// each where it stands.
    #[must_use]
    pub fn triangles_drawn(&self) -> u64 {
        self.layers.iter().map(|layer| layer.triangles()).sum()
    }

    /// Number of clusters that are drawn, and of those of them that can be seen, each where it
    /// stands.
    #[must_use]
    pub fn clusters_seen(&self, view: &EyeView, style: &SceneStyle) -> [usize; 2] {
        let scene = self.scene(view, style);
        let mut sums = [0; 2];
        for layer in &self.layers {
            let seen = layer.clusters_seen(&scene);
            sums = [sums[0] + seen[0], sums[1] + seen[1]];
        }
        sums
    }

    /// Number of clusters that can be seen in `view`, but are hidden by what `before` shows.
    #[must_use]
    pub fn clusters_hidden(&self, view: &EyeView, before: &EyeView, style: &SceneStyle) -> usize {
        let scene = self.scene(view, style);
        let drawn = self.depths(before, style);
        let layers = self.layers.iter();
        layers
            .map(|layer| layer.clusters_hidden(&scene, &drawn))
            .sum()
    }

    /// How near what `view` shows is at least, in squares of pixels.
    fn depths(&self, view: &EyeView, style: &SceneStyle) -> DrawnDepths {
        let scene = self.scene(view, style);
        let mut canvas = Canvas::new(view.size, 0);
        self.draw((view, &scene), Phase::Opaque, Go::First, &mut canvas);
        DrawnDepths::new(scene, &canvas.depths)
    }

    /// From now on these are the units that would refine parts of others: what [`Self::ids`] shows.
    pub fn set_refiners(&mut self, refiners: Refiners) {
        let refiners = Arc::new(refiners);
        self.layers
            .iter_mut()
            .for_each(|layer| layer.set_refiners(&refiners));
    }

    /// The picture that `view` shows.
    #[must_use]
    pub fn picture(&self, view: &EyeView, style: &SceneStyle) -> RgbaImage {
        self.picture_over(None, view, style)
    }

    /// The same in front of a picture of the view's size, in place of the style's background.
    #[must_use]
    pub fn picture_over(
        &self,
        under: Option<&RgbaImage>,
        view: &EyeView,
        style: &SceneStyle,
    ) -> RgbaImage {
        let scene = self.scene(view, style);
        let mut canvas = match under {
            Some(image) => {
                let codes = image.pixels.as_chunks().0.iter();
                let codes = codes.map(|code| u32::from_le_bytes(*code));
                Canvas::over(view.size, codes.collect())
            }
            None => Canvas::new(view.size, u32::from_le_bytes(style.background())),
        };
        self.draw((view, &scene), Phase::Opaque, Go::Only, &mut canvas);
        let codes = canvas.pixels.iter();
        let mut image = RgbaImage {
            size: view.size,
            pixels: codes.flat_map(|code| code.to_le_bytes()).collect(),
        };
        if let Some(worths) = &self.worths {
            self.paint(worths, &mut image, &self.ids(view, style));
        }
        image
    }

    /// Paints what units are worth over a picture of what they would refine.
    fn paint(&self, worths: &[f32], image: &mut RgbaImage, ids: &[u32]) {
        for (pixel, unit) in image.pixels.as_chunks_mut::<4>().0.iter_mut().zip(ids) {
            let mark = mark_units(worths, *unit);
            let under = Vec4::from(pixel.map(|it| f32::from(it) / 255.0));
            *pixel = code(under.lerp(mark.truncate().extend(1.0), mark.w));
        }
    }

    /// For each pixel of `view`, row by row, the unit that would refine what is drawn there,
    /// by its number; 4294967295 where none would, and where nothing stands.
    #[must_use]
    pub fn ids(&self, view: &EyeView, style: &SceneStyle) -> Vec<u32> {
        let scene = self.scene(view, style);
        let mut canvas = Canvas::new(view.size, u32::MAX);
        self.draw((view, &scene), Phase::Ids, Go::Only, &mut canvas);
        canvas.pixels
    }

    /// What of a glance's view each unit would refine; nothing where it has no view.
    #[must_use]
    pub fn footprints(&self, glance: &Glance, style: &SceneStyle) -> Vec<Footprint> {
        let Some(view) = glance.view.as_ref().map(small_view) else {
            return Vec::new();
        };
        let gazed = GazedParams::new(glance, &view);
        let mut sums: Vec<FootprintSums> = Vec::new();
        let ids = self.ids(&view, style);
        for (place, unit) in (0..).zip(ids).filter(|(_, unit)| *unit != u32::MAX) {
            let unit = unit as usize;
            sums.resize(sums.len().max(unit + 1), FootprintSums::default());
            let pixel = [place % view.size[0], place / view.size[0]];
            footprints(&gazed, pixel, view.size, &mut sums[unit]);
        }
        footprints_of(&sums, pixel_deg2(&gazed, view.size))
    }

    fn scene(&self, view: &EyeView, style: &SceneStyle) -> SceneInView {
        let coarsest = self.layers.iter().map(|layer| layer.coarsest()).max();
        SceneInView {
            params: SceneParams::new(view, style, coarsest.unwrap_or_default()),
            placements: self.placements.seen_by(view),
        }
    }

    /// Draws all layers' part of a picture, phase by phase.
    fn draw(
        &self,
        (view, scene): (&EyeView, &SceneInView),
        phase: Phase,
        go: Go,
        canvas: &mut Canvas,
    ) {
        let frame = TwinFrame {
            view,
            scene,
            pages: self.layers.iter().find_map(|layer| layer.pages()),
        };
        for phase in phase.all() {
            for layer in &self.layers {
                layer.draw(&frame, *phase, go, canvas);
            }
        }
    }
}
