//! What does a layer do that draws one kind of a scene's units on the GPU?

use crate::error::RenderError;
use crate::gpu::room::TakenBytes;
use crate::idle::IdleUnits;
use crate::scene::coming::{Coming, Refiners};
use crate::scene::params::SceneStyle;
use crate::scene::phase::{Go, Phase};
use foveal_core::pack::unit::UnitId;
use foveal_core::view::eye_view::EyeView;
use std::collections::{BTreeMap, HashSet};
use std::sync::Arc;

/// What all layers draw one picture by.
#[derive(Clone, Copy)]
pub struct Frame<'a> {
    /// What is shown.
    pub view: &'a EyeView,
    /// How; others hide something only where a picture is drawn in two goes.
    pub style: &'a SceneStyle,
    /// What is drawn: colours, opaque and transparent, or units.
    pub phase: Phase,
    /// A `SceneParams`.
    pub scene: &'a wgpu::Buffer,
    /// A `PlacementParams` for each place where an object stands.
    pub placements: &'a wgpu::Buffer,
    /// How textures are read, where a layer holds some.
    pub textures: Option<&'a Textures>,
}

/// What shaders read textures by.
#[derive(Clone, Debug)]
pub struct Textures {
    /// Where each page lies.
    pub table: wgpu::Buffer,
    /// All pages.
    pub pages: wgpu::TextureView,
    /// How they are read between texels.
    pub sampler: wgpu::Sampler,
}

/// The units of one kind on the GPU, and what draws them into the pictures of a scene.
///
/// [`SceneLayer`](crate::SceneLayer) calls in this order: uploads and evictions; for a picture
/// [`Self::goes_twice`], [`Self::prepare`], then [`Self::draw`] in each go and phase, and
/// [`Self::take_depths`] after the first go. A layer knows no other; memory is asked for and given
/// back through the scene's ledger.
pub trait KindLayer {
    /// Whether a unit is of this kind.
    fn takes(&self, coming: &Coming<'_>) -> bool;

    /// Adds a unit after its prerequisites; one that is there stays as it is. `allowed` is what the
    /// whole layer may take, what it has already included. `false` where that is too little and
    /// what is coarser can be shown as well: other layers then give back what they hold and do not
    /// use, and the unit is tried once more.
    ///
    /// # Errors
    /// It does not fit to what is there, or, as [`RenderError::NoRoom`], into what was promised to
    /// units of this kind: then others must make room. Nothing changed.
    fn upload(&mut self, coming: &Coming<'_>, allowed: TakenBytes) -> Result<bool, RenderError>;

    /// Takes a unit away that is drawn; `false` where it was not there.
    fn remove(&mut self, unit: UnitId) -> bool;

    /// Draws only units that are wanted, what these need, and roots. Of the others those stay that
    /// are `staying`, first what is to stay longest, each after those that it needs: they count as
    /// free, and give way before anything grows.
    fn keep(&mut self, wanted: &HashSet<UnitId>, staying: &[UnitId]);

    /// Draws a unit again that stayed; `false` where it did not.
    fn show(&mut self, unit: UnitId) -> bool;

    /// What stays without being drawn and may give way; `None` of a layer in which nothing does.
    fn idle(&mut self) -> Option<&mut IdleUnits<UnitId>> {
        None
    }

    /// Bytes of units.
    fn taken(&self) -> TakenBytes;

    /// Bytes of tables besides.
    fn table_bytes(&self) -> u64 {
        0
    }

    /// Bytes of what it keeps of pictures of a size besides, or keeps already where that is more.
    fn picture_bytes(&self, _size: [u32; 2]) -> u64 {
        0
    }

    /// Gives back memory that it holds and does not use: all of it where a unit of another kind
    /// `must` have room, much of it where that would only be better.
    ///
    /// # Errors
    /// None that the layer did not have before.
    fn give_back(&mut self, must: bool) -> Result<(), RenderError>;

    /// From now on these are the units that would refine parts of others, of this kind or not.
    fn set_refiners(&mut self, _refiners: &Arc<Refiners>) {}

    /// From now on these units have gone so much of their way from what is coarser, 0 to 1, and all
    /// others are in their places.
    fn morph(&mut self, _shares: &BTreeMap<UnitId, f64>) {}

    /// The coarsest level that was ever there.
    fn coarsest(&self) -> u8 {
        0
    }

    /// What others read textures by, where this layer holds them.
    fn textures(&self) -> Option<Textures> {
        None
    }

    /// Whether pictures of this size and style are drawn in two goes: what hides others, then what
    /// is not hidden.
    ///
    /// # Errors
    /// The device binds no buffer that is large enough.
    fn goes_twice(&mut self, _size: [u32; 2], _style: &SceneStyle) -> Result<bool, RenderError> {
        Ok(false)
    }

    /// Writes what a picture is drawn by, and records what is computed before.
    ///
    /// # Errors
    /// More than the device binds.
    fn prepare(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame<'_>,
    ) -> Result<(), RenderError>;

    /// Draws what was prepared of a phase; in the first go only what hides others.
    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, phase: Phase, go: Go);

    /// Records what is made of the depths that the first go, or the only one, left.
    fn take_depths(
        &mut self,
        _encoder: &mut wgpu::CommandEncoder,
        _frame: &Frame<'_>,
        _depths: &wgpu::TextureView,
    ) {
    }

    /// Triangles that the last picture was drawn of, seen or not.
    fn triangles(&self) -> u64 {
        0
    }

    /// Number of clusters that each go of the last picture drew. Blocks.
    ///
    /// # Errors
    /// The device was lost.
    #[cfg(not(target_arch = "wasm32"))]
    fn clusters_drawn(&self) -> Result<[u32; 2], RenderError> {
        Ok([0; 2])
    }
}
