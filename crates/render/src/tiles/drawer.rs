//! What draws the tiles of a video: the GPU, the CPU twin of its passes, or nothing?
//!
//! Tiles lie in an atlas or in a texture for every level, or samples of them round the gaze are
//! shown; what lies outside the fovea is blurred where that is wanted. What is chosen here can
//! change while it is looked at.

use crate::draw_device::{DrawDevice, DrawnPicture};
use crate::error::RenderError;
use crate::image::RgbaImage;
use crate::params::Overlay;
use crate::tiles::blur::RadialBlur;
use crate::tiles::frame::Renderer;
use crate::tiles::sampling::{GatheredSamples, Sampling, mask_shape};
use crate::tiles::sparse::Interpolation;
#[cfg(not(target_arch = "wasm32"))]
use crate::tiles::textures::TextureRenderer;
use crate::twin::{self, TwinSamples, TwinTiles};
use foveal_core::content::policy::PolicyConfig;
use foveal_core::content::unit::{AssetId, UnitRef};
use foveal_core::content::video::Video;
use foveal_core::content::video::grid::tile_grid::Tile;
use foveal_core::gaze::sample::GazeSample;
use foveal_core::perception::samples::sample_mask::MaskShape;
use foveal_core::session::unit_states::Piece;
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::picture::Picture;
use glam::DVec3;
use std::sync::Arc;

/// Most layers of the atlas: 256 is what a browser gives.
const MOST_LAYERS: u32 = 256;
/// Shares by which a pixel's angle may differ before a mask is made again.
const SAME_PITCH: f64 = 1e-6;

/// How tiles become a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TileStyle {
    /// A texture for every level in place of the atlas.
    pub has_textures: bool,
    /// How pixels between samples are filled.
    pub interpolation: Interpolation,
    /// Whether what lies outside the fovea is blurred.
    pub blurs: bool,
    /// Whether only samples round the gaze are shown over the coarsest level.
    pub samples: bool,
}

impl TileStyle {
    /// Whether tiles that were uploaded for one serve the other.
    fn keeps_tiles(self, other: Self) -> bool {
        let [a, b] = [self, other].map(|style| Self {
            blurs: false,
            ..style
        });
        a == b
    }
}

/// Resident tiles and what draws them.
pub struct TileDrawer {
    device: DrawDevice,
    video: Arc<Video>,
    style: TileStyle,
    engine: Engine,
    sampling: Option<(MaskShape, Sampling)>,
    /// What the samples that are shown were gathered for; `None` once tiles came.
    gathered: Option<(DVec3, EyeView)>,
    /// The frame that is shown.
    frame: u32,
    /// Tiles of frames that stay no longer, and are not reported yet.
    evicted: Vec<(Tile, u32)>,
}

enum Engine {
    Atlas(Box<Renderer>),
    #[cfg(not(target_arch = "wasm32"))]
    Textures(Box<TextureRenderer>),
    Twin(Box<Twin>),
    Nothing,
}

/// Tiles and samples in main memory, and what is done with them.
struct Twin {
    tiles: TwinTiles,
    samples: Option<TwinSamples>,
    blur: Option<RadialBlur>,
    has_textures: bool,
}

impl TileDrawer {
    /// Nothing is resident yet.
    ///
    /// # Errors
    /// The device cannot hold what the style needs.
    pub(crate) fn new(
        device: &DrawDevice,
        video: &Arc<Video>,
        style: TileStyle,
    ) -> Result<Self, RenderError> {
        Ok(Self {
            engine: Engine::new(device, video, style)?,
            device: device.clone(),
            video: Arc::clone(video),
            style,
            sampling: None,
            gathered: None,
            frame: 0,
            evicted: Vec::new(),
        })
    }

    /// How tiles become a picture.
    #[must_use]
    pub fn style(&self) -> TileStyle {
        self.style
    }

    /// From now on shows tiles like this; `true` where all of them must come again. What cannot be
    /// shown leaves everything as it was.
    ///
    /// # Errors
    /// The device cannot hold what the style needs.
    pub fn restyle(&mut self, style: TileStyle) -> Result<bool, RenderError> {
        if self.style.keeps_tiles(style) {
            self.style = style;
            return Ok(false);
        }
        *self = Self::new(&self.device, &self.video, style)?;
        Ok(true)
    }

    /// Makes the mask that samples are shown by, where there is none for this view; takes about a
    /// second. `true` where tiles must come again to be sampled.
    ///
    /// # Errors
    /// The mask is larger than the device binds.
    pub fn prepare(&mut self, config: &PolicyConfig, view: &EyeView) -> Result<bool, RenderError> {
        if !self.style.samples {
            return Ok(false);
        }
        let shape = mask_shape(config, view);
        let same = |(made, _): &(MaskShape, Sampling)| {
            (made.pitch / shape.pitch - 1.0).abs() < SAME_PITCH
                && (made.side, &made.eye) == (shape.side, &shape.eye)
        };
        if self.sampling.as_ref().is_some_and(same) {
            return Ok(false);
        }
        let interpolation = self.style.interpolation;
        let averages = interpolation == Interpolation::Blended;
        let sampling = Sampling::new(config, view, averages);
        match &mut self.engine {
            Engine::Atlas(renderer) => renderer.sample_by(&sampling.mask, interpolation)?,
            Engine::Twin(twin) => {
                twin.samples = Some(TwinSamples::new(sampling.mask.clone(), interpolation));
            }
            #[cfg(not(target_arch = "wasm32"))]
            Engine::Textures(_) => {}
            Engine::Nothing => {}
        }
        self.sampling = Some((shape, sampling));
        self.gathered = None;
        Ok(true)
    }

    /// Number of samples that are shown; `None` where tiles are.
    #[must_use]
    pub fn samples(&self) -> Option<usize> {
        let sampling = self.sampling.as_ref();
        sampling.map(|(_, sampling)| sampling.mask.places.len())
    }

    /// Moves what follows the gaze: the samples and the blur.
    ///
    /// # Errors
    /// The device was lost.
    pub fn follow(&mut self, gaze: &GazeSample, view: &EyeView) -> Result<(), RenderError> {
        let direction = gaze.gaze_in_content;
        let blur = self.style.blurs.then(|| RadialBlur::round(direction));
        self.engine.set_blur(blur);
        let Some((_, sampling)) = &self.sampling else {
            return Ok(());
        };
        let wanted = (direction, *view);
        if self.gathered != Some(wanted) {
            let samples = sampling.gather(self.video.grid(), view, gaze);
            self.engine.show_samples(&samples)?;
            self.gathered = Some(wanted);
        }
        Ok(())
    }

    /// From now on source frame `frame` is shown.
    pub(crate) fn begin_frame(&mut self, frame: u32) {
        self.engine.begin_frame(frame);
        self.frame = frame;
        if let Some((_, sampling)) = &mut self.sampling {
            sampling.begin_frame(self.video.grid().coarsest());
        }
        self.gathered = None;
    }

    /// Makes a piece resident; where samples are shown, only the coarsest level is, and the samples
    /// are gathered from the others.
    ///
    /// # Errors
    /// It is not what its unit should be, or the device was lost.
    pub(crate) fn upload(&mut self, piece: Piece, picture: Picture) -> Result<(), RenderError> {
        let tile = self.tile_of(piece.unit);
        self.gathered = None;
        if let Some((_, sampling)) = &mut self.sampling {
            if tile.level != self.video.grid().coarsest() {
                sampling.keep(tile, picture);
                return Ok(());
            }
            sampling.keep(tile, picture.clone());
        }
        self.engine.upload(tile, piece.frame, &picture)
    }

    /// Shows only `shown` units and the coarsest level. Of the others those stay that are
    /// `staying`, first what is to stay longest; where samples are shown, none.
    pub(crate) fn keep(&mut self, shown: &[UnitRef], staying: &[UnitRef]) {
        let [shown, staying] = [shown, staying].map(|it| self.tiles_of(it));
        if let Some((_, sampling)) = &mut self.sampling {
            sampling.retain(self.video.grid().coarsest(), &shown);
            self.gathered = None;
            let frame = self.frame;
            self.evicted
                .extend(staying.iter().map(|tile| (*tile, frame)));
            self.engine.keep(&shown, &[]);
        } else {
            self.engine.keep(&shown, &staying);
        }
    }

    /// Shows a piece again that stayed; `false` where it did not.
    pub(crate) fn show(&mut self, piece: Piece) -> bool {
        let tile = self.tile_of(piece.unit);
        self.sampling.is_none() && self.engine.show(tile)
    }

    /// These do not give way, until others are spared: they are about to be shown again.
    pub(crate) fn spare(&mut self, units: &[UnitRef]) {
        let tiles = self.tiles_of(units);
        if let Engine::Atlas(renderer) = &mut self.engine {
            renderer.tiles().spare(&tiles);
        }
    }

    /// Pieces of an asset of this number that stayed and gave way since this was last asked.
    pub(crate) fn take_evicted(&mut self, asset: AssetId) -> Vec<Piece> {
        let mut evicted = std::mem::take(&mut self.evicted);
        if let Engine::Atlas(renderer) = &mut self.engine {
            evicted.extend(renderer.tiles().take_evicted());
        }
        let piece = |(tile, frame)| Piece {
            unit: UnitRef {
                asset,
                unit: self.video.pack().unit(tile, frame),
            },
            frame,
        };
        evicted.into_iter().map(piece).collect()
    }

    fn tiles_of(&self, units: &[UnitRef]) -> Vec<Tile> {
        units.iter().map(|unit| self.tile_of(*unit)).collect()
    }

    /// Resident units that hold another frame than the one shown.
    pub fn wrong_frame_units(&mut self) -> usize {
        match &mut self.engine {
            Engine::Atlas(renderer) => renderer.tiles().wrong_frame_tiles(),
            #[cfg(not(target_arch = "wasm32"))]
            Engine::Textures(renderer) => renderer.wrong_frame_tiles(),
            Engine::Twin(twin) => twin.tiles.wrong_frame_tiles(),
            Engine::Nothing => 0,
        }
    }

    /// Bytes of GPU memory in use.
    #[must_use]
    pub(crate) fn gpu_bytes(&self) -> u64 {
        match &self.engine {
            Engine::Atlas(renderer) => renderer.gpu_bytes(),
            #[cfg(not(target_arch = "wasm32"))]
            Engine::Textures(renderer) => renderer.gpu_bytes(),
            Engine::Twin(_) | Engine::Nothing => 0,
        }
    }

    /// The texture of the picture that a view shows on the GPU, with `marks` over it if there are
    /// any and tiles lie in the atlas; the next call reuses it. `None` where no GPU draws.
    ///
    /// # Errors
    /// The picture is larger than the device draws.
    pub(crate) fn draw(
        &mut self,
        view: &EyeView,
        marks: Option<&Overlay>,
    ) -> Result<Option<&wgpu::Texture>, RenderError> {
        Ok(match &mut self.engine {
            Engine::Atlas(renderer) => Some(renderer.draw(view, marks)?),
            #[cfg(not(target_arch = "wasm32"))]
            Engine::Textures(renderer) => Some(renderer.draw(view)?),
            Engine::Twin(_) | Engine::Nothing => None,
        })
    }

    /// The picture that a view shows, on its way to main memory; `None` when nothing draws, or
    /// tiles lie in a texture for every level.
    ///
    /// # Errors
    /// The picture is larger than the device draws.
    pub(crate) fn read(
        &mut self,
        view: &EyeView,
        marks: Option<&Overlay>,
    ) -> Result<Option<DrawnPicture>, RenderError> {
        Ok(match &mut self.engine {
            Engine::Atlas(renderer) => Some(DrawnPicture::Coming(renderer.read(view, marks)?)),
            Engine::Twin(twin) => Some(DrawnPicture::Here(twin.marked(view, marks))),
            #[cfg(not(target_arch = "wasm32"))]
            Engine::Textures(_) => None,
            Engine::Nothing => None,
        })
    }

    fn tile_of(&self, unit: UnitRef) -> Tile {
        self.video.pack().tile_of(unit.unit)
    }
}

#[cfg(not(target_arch = "wasm32"))]
impl TileDrawer {
    /// The picture that a view shows, with `marks` over it if there are any; `None` when nothing
    /// draws. Blocks.
    ///
    /// # Errors
    /// The picture is larger than the device draws, or marks are asked for where tiles lie in a
    /// texture for every level.
    pub(crate) fn picture(
        &mut self,
        view: &EyeView,
        marks: Option<&Overlay>,
    ) -> Result<Option<RgbaImage>, RenderError> {
        Ok(match (&mut self.engine, marks) {
            (Engine::Atlas(renderer), None) => Some(renderer.reconstruct(view)?),
            (Engine::Atlas(renderer), Some(marks)) => Some(renderer.heat_map(view, marks)?),
            (Engine::Twin(twin), marks) => Some(twin.marked(view, marks)),
            (Engine::Textures(renderer), None) => Some(renderer.reconstruct(view)?),
            (Engine::Textures(_), Some(_)) => return Err(RenderError::NoMarks),
            (Engine::Nothing, _) => None,
        })
    }

    /// Waits until what was uploaded is where it is drawn from.
    ///
    /// # Errors
    /// The device was lost.
    pub fn settle(&mut self) -> Result<(), RenderError> {
        match &mut self.engine {
            Engine::Atlas(renderer) => renderer.tiles().settle(),
            Engine::Textures(renderer) => renderer.settle(),
            Engine::Twin(_) | Engine::Nothing => Ok(()),
        }
    }

    /// The samples of a resident unit, as whatever draws holds them; `None` where it holds none by
    /// themselves. Blocks: for reports, not for playing.
    ///
    /// # Errors
    /// It is not resident.
    pub fn read_unit(&mut self, unit: UnitRef) -> Result<Option<Picture>, RenderError> {
        let tile = self.tile_of(unit);
        Ok(match &mut self.engine {
            Engine::Atlas(renderer) => Some(renderer.tiles().read_tile(tile)?),
            Engine::Twin(twin) => twin.tiles.read_tile(tile),
            Engine::Textures(_) | Engine::Nothing => None,
        })
    }
}

impl Engine {
    fn new(device: &DrawDevice, video: &Video, style: TileStyle) -> Result<Self, RenderError> {
        let (grid, colour) = (video.grid(), video.pack().description().colour);
        Ok(match device {
            #[cfg(not(target_arch = "wasm32"))]
            DrawDevice::Gpu(gpu) if style.has_textures => {
                Self::Textures(Box::new(TextureRenderer::new(gpu, grid, colour)?))
            }
            DrawDevice::Gpu(gpu) => {
                Self::Atlas(Box::new(Renderer::new(gpu, grid, colour, MOST_LAYERS)?))
            }
            DrawDevice::Twin => Self::Twin(Box::new(Twin {
                tiles: TwinTiles::new(grid, colour),
                samples: None,
                blur: None,
                has_textures: style.has_textures,
            })),
            DrawDevice::Nothing => Self::Nothing,
        })
    }

    fn begin_frame(&mut self, frame: u32) {
        match self {
            Self::Atlas(renderer) => renderer.tiles().begin_frame(frame),
            #[cfg(not(target_arch = "wasm32"))]
            Self::Textures(renderer) => renderer.begin_frame(frame),
            Self::Twin(twin) => twin.tiles.begin_frame(frame),
            Self::Nothing => {}
        }
    }

    fn upload(&mut self, tile: Tile, frame: u32, picture: &Picture) -> Result<(), RenderError> {
        match self {
            Self::Atlas(renderer) => renderer.tiles().upload(tile, frame, picture),
            #[cfg(not(target_arch = "wasm32"))]
            Self::Textures(renderer) => renderer.upload(tile, frame, picture),
            Self::Twin(twin) => twin.tiles.upload(tile, frame, picture),
            Self::Nothing => Ok(()),
        }
    }

    fn keep(&mut self, shown: &[Tile], staying: &[Tile]) {
        match self {
            Self::Atlas(renderer) => renderer.tiles().keep(shown, staying),
            Self::Twin(twin) => twin.tiles.keep(shown, staying),
            // Every tile has its place in its level's texture, in use or not.
            #[cfg(not(target_arch = "wasm32"))]
            Self::Textures(_) => {}
            Self::Nothing => {}
        }
    }

    fn show(&mut self, tile: Tile) -> bool {
        match self {
            Self::Atlas(renderer) => renderer.tiles().show(tile),
            Self::Twin(twin) => twin.tiles.show(tile),
            #[cfg(not(target_arch = "wasm32"))]
            Self::Textures(_) => true,
            Self::Nothing => true,
        }
    }

    fn set_blur(&mut self, blur: Option<RadialBlur>) {
        match self {
            Self::Atlas(renderer) => renderer.radial_blur = blur,
            #[cfg(not(target_arch = "wasm32"))]
            Self::Textures(renderer) => renderer.radial_blur = blur,
            Self::Twin(twin) => twin.blur = blur,
            Self::Nothing => {}
        }
    }

    fn show_samples(
        &mut self,
        GatheredSamples { corner, codes }: &GatheredSamples,
    ) -> Result<(), RenderError> {
        match self {
            Self::Atlas(renderer) => renderer.show_samples(*corner, codes),
            Self::Twin(twin) => {
                if let Some(shown) = &mut twin.samples {
                    shown.show(*corner, codes);
                }
                Ok(())
            }
            #[cfg(not(target_arch = "wasm32"))]
            Self::Textures(_) => Ok(()),
            Self::Nothing => Ok(()),
        }
    }
}

impl Twin {
    fn marked(&self, view: &EyeView, marks: Option<&Overlay>) -> RgbaImage {
        let picture = self.picture(view);
        match marks {
            Some(marks) => twin::marked(&self.tiles, view, marks, picture),
            None => picture,
        }
    }

    fn picture(&self, view: &EyeView) -> RgbaImage {
        let picture = match &self.samples {
            Some(samples) => twin::interpolate_sparse(&self.tiles, samples, view),
            None if self.has_textures => twin::reconstruct_textures(&self.tiles, view),
            None => twin::reconstruct(&self.tiles, view),
        };
        let draws_halves = self.samples.is_none() && !self.has_textures;
        match &self.blur {
            Some(blur) => {
                let half = || twin::reconstruct(&self.tiles, &RadialBlur::half_view(view));
                twin::blur_radial(&picture, draws_halves.then(half), view, blur)
            }
            None => picture,
        }
    }
}
