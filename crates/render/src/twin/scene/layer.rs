//! What does a layer do that draws one kind of a scene's units in main memory?

use super::cull_clusters::DrawnDepths;
use crate::error::RenderError;
use crate::scene::coming::{Coming, Refiners};
use crate::scene::phase::{Go, Phase};
use crate::twin::shared::pages::TwinPages;
use crate::twin::shared::raster::{Covered, Fragment};
use crate::twin::shared::scene::SceneInView;
use crate::twin::shared::wgsl::code;
use foveal_core::pack::unit::UnitId;
use foveal_core::view::eye_view::EyeView;
use glam::Vec4;
use std::collections::{BTreeMap, HashSet};
use std::sync::Arc;

/// What all layers draw one picture by.
#[derive(Clone, Copy)]
pub(crate) struct TwinFrame<'a> {
    pub(crate) view: &'a EyeView,
    pub(crate) scene: &'a SceneInView,
    /// The pages of textures, where a layer holds them.
    pub(crate) pages: Option<&'a TwinPages>,
}

/// What is drawn on: colours or units, and how near what is drawn in each pixel is; larger is
/// nearer.
pub(crate) struct Canvas {
    pub(crate) size: [u32; 2],
    pub(crate) depths: Vec<f32>,
    /// Codes of colours, or units.
    pub(crate) pixels: Vec<u32>,
}

impl Canvas {
    /// Pixels that have this value where nothing stands.
    pub(crate) fn new(size: [u32; 2], value: u32) -> Self {
        Self::over(size, vec![value; size[0] as usize * size[1] as usize])
    }

    /// Pixels in front of which nothing stands so far.
    pub(crate) fn over(size: [u32; 2], pixels: Vec<u32>) -> Self {
        Self {
            size,
            depths: vec![0.0; pixels.len()],
            pixels,
        }
    }

    fn place(&self, [x, y]: [u32; 2]) -> usize {
        y as usize * self.size[0] as usize + x as usize
    }

    /// Whether something is in front of all before it.
    pub(crate) fn has_behind(&self, covered: &Covered<'_>) -> bool {
        covered.depth > self.depths[self.place(covered.pixel)]
    }

    /// Whether something is in front of all before it, which it is from now on.
    pub(crate) fn pass(&mut self, covered: &Covered<'_>) -> bool {
        let passes = self.has_behind(covered);
        let place = self.place(covered.pixel);
        let depth = &mut self.depths[place];
        *depth = depth.max(covered.depth);
        passes
    }

    /// Paints a colour.
    pub(crate) fn paint(&mut self, fragment: &Fragment, colour: Vec4) {
        self.mark(fragment, u32::from_le_bytes(code(colour)));
    }

    /// Writes a unit.
    pub(crate) fn mark(&mut self, fragment: &Fragment, unit: u32) {
        let place = self.place(fragment.pixel);
        self.pixels[place] = unit;
    }
}

/// The units of one kind in main memory, and what draws them: the twin of a
/// [`KindLayer`](crate::scene::kind::KindLayer).
pub(crate) trait TwinLayer {
    /// Whether a unit is of this kind.
    fn takes(&self, coming: &Coming<'_>) -> bool;

    /// Adds a unit after its prerequisites; one that is there stays as it is.
    ///
    /// # Errors
    /// It does not fit to what is there: nothing changed then.
    fn upload(&mut self, coming: &Coming<'_>) -> Result<(), RenderError>;

    /// Takes a unit away; `false` where it was not there.
    fn remove(&mut self, unit: UnitId) -> bool;

    /// Draws only units that are wanted, what these need, and roots; of the others those stay that
    /// are `staying`.
    fn keep(&mut self, wanted: &HashSet<UnitId>, staying: &[UnitId]);

    /// Draws a unit again that stayed; `false` where it did not.
    fn show(&mut self, unit: UnitId) -> bool;

    /// From now on these are the units that would refine parts of others.
    fn set_refiners(&mut self, _refiners: &Arc<Refiners>) {}

    /// From now on these units have gone so much of their way from what is coarser.
    fn morph(&mut self, _shares: &BTreeMap<UnitId, f64>) {}

    /// The coarsest level that was ever there.
    fn coarsest(&self) -> u8 {
        0
    }

    /// The pages of textures, where this layer holds them.
    fn pages(&self) -> Option<&TwinPages> {
        None
    }

    /// Draws a phase; in the first go only what hides others.
    fn draw(&self, frame: &TwinFrame<'_>, phase: Phase, go: Go, canvas: &mut Canvas);

    /// Triangles that a picture is drawn of, seen or not.
    fn triangles(&self) -> u64 {
        0
    }

    /// Number of clusters that are drawn, and of those of them that can be seen.
    fn clusters_seen(&self, _scene: &SceneInView) -> [usize; 2] {
        [0; 2]
    }

    /// Number of clusters that can be seen, but are hidden by what was drawn.
    fn clusters_hidden(&self, _scene: &SceneInView, _drawn: &DrawnDepths) -> usize {
        0
    }
}
