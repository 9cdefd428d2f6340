//! What draws the picture: the GPU, or the CPU twin of its passes?

use crate::run::sampling::Samples;
use anyhow::{Context, bail};
use clap::ValueEnum;
use foveal_core::content::video::grid::tile_grid::{Tile, TileGrid};
use foveal_core::perception::samples::sample_mask::SampleMask;
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::picture::{Colour, Picture};
use foveal_render::twin::TwinSamples;
use foveal_render::twin::{self, TwinTiles};
use foveal_render::{
    Gpu, Interpolation, Overlay, RadialBlur, Renderer, RgbaImage, TextureRenderer,
};

/// Which renderer was asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum RendererName {
    /// The GPU, or a software Vulkan driver in its place.
    Gpu,
    /// The plain CPU twin of the GPU's passes: slow, needs no driver.
    Cpu,
    /// Draw nothing: only decode.
    None,
}

/// What draws, ready: one can serve several canvases.
#[derive(Clone)]
pub(crate) enum Drawing {
    Gpu(Gpu),
    Cpu,
    None,
}

impl Drawing {
    /// Opens what was asked for.
    pub(crate) fn open(name: RendererName) -> anyhow::Result<Self> {
        Ok(match name {
            RendererName::Gpu => Self::Gpu(Gpu::open_blocking().context("or give --renderer cpu")?),
            RendererName::Cpu => Self::Cpu,
            RendererName::None => Self::None,
        })
    }

    /// Its name, for people.
    pub(crate) fn name(&self) -> &str {
        match self {
            Self::Gpu(gpu) => gpu.adapter_name(),
            Self::Cpu => "the CPU twin",
            Self::None => "nothing",
        }
    }
}

/// Most layers of the atlas: 256 is what a browser gives.
const MOST_LAYERS: u32 = 256;

/// Resident tiles and what draws them.
pub(crate) enum Canvas {
    Gpu(Box<Renderer>),
    Cpu(Box<CpuCanvas>),
    Textures(Box<TextureRenderer>),
    None,
}

/// Tiles and samples in main memory, and what is done with them.
pub(crate) struct CpuCanvas {
    tiles: TwinTiles,
    samples: Option<TwinSamples>,
    blur: Option<RadialBlur>,
    has_textures: bool,
}

/// How resident tiles become a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Showing {
    /// A texture for every level in place of the atlas.
    pub(crate) has_textures: bool,
    /// How pixels between samples are filled.
    pub(crate) interpolation: Interpolation,
    /// Whether what lies outside the fovea is blurred.
    pub(crate) blurs: bool,
}

impl Canvas {
    /// A canvas for the tiles of `grid`.
    pub(crate) fn new(
        drawing: &Drawing,
        grid: &TileGrid,
        colour: Colour,
        showing: Showing,
    ) -> anyhow::Result<Self> {
        Ok(match drawing {
            Drawing::Gpu(gpu) if showing.has_textures => {
                let renderer = TextureRenderer::new(gpu, grid, colour);
                Self::Textures(Box::new(renderer.context("--reconstruction textures")?))
            }
            Drawing::Gpu(gpu) => {
                Self::Gpu(Box::new(Renderer::new(gpu, grid, colour, MOST_LAYERS)?))
            }
            Drawing::Cpu => Self::Cpu(Box::new(CpuCanvas {
                tiles: TwinTiles::new(grid, colour),
                samples: None,
                blur: None,
                has_textures: showing.has_textures,
            })),
            Drawing::None => Self::None,
        })
    }

    /// From now on shows samples round the gaze over the coarsest level.
    pub(crate) fn sample_by(
        &mut self,
        mask: &SampleMask,
        interpolation: Interpolation,
    ) -> anyhow::Result<()> {
        match self {
            Self::Gpu(renderer) => renderer.sample_by(mask, interpolation)?,
            Self::Cpu(cpu) => cpu.samples = Some(TwinSamples::new(mask.clone(), interpolation)),
            Self::Textures(_) | Self::None => {}
        }
        Ok(())
    }

    /// Makes the samples of a frame those shown.
    pub(crate) fn show_samples(&mut self, samples: &Samples) -> anyhow::Result<()> {
        let Samples { corner, codes } = samples;
        match self {
            Self::Gpu(renderer) => renderer.show_samples(*corner, codes)?,
            Self::Cpu(cpu) => {
                if let Some(shown) = &mut cpu.samples {
                    shown.show(*corner, codes);
                }
            }
            Self::Textures(_) | Self::None => {}
        }
        Ok(())
    }

    /// Blurs the pictures drawn from now on outside the fovea of this gaze.
    pub(crate) fn set_blur(&mut self, blur: Option<RadialBlur>) {
        match self {
            Self::Gpu(renderer) => renderer.radial_blur = blur,
            Self::Cpu(cpu) => cpu.blur = blur,
            Self::Textures(renderer) => renderer.radial_blur = blur,
            Self::None => {}
        }
    }

    /// From now on source frame `frame` is shown.
    pub(crate) fn begin_frame(&mut self, frame: u32) {
        match self {
            Self::Gpu(renderer) => renderer.tiles().begin_frame(frame),
            Self::Cpu(cpu) => cpu.tiles.begin_frame(frame),
            Self::Textures(renderer) => renderer.begin_frame(frame),
            Self::None => {}
        }
    }

    /// Makes a tile of a source frame resident.
    pub(crate) fn upload(
        &mut self,
        tile: Tile,
        frame: u32,
        picture: Picture,
    ) -> anyhow::Result<()> {
        match self {
            Self::Gpu(renderer) => renderer.tiles().upload(tile, frame, &picture)?,
            Self::Cpu(cpu) => cpu.tiles.upload(tile, frame, &picture)?,
            Self::Textures(renderer) => renderer.upload(tile, frame, &picture)?,
            Self::None => {}
        }
        Ok(())
    }

    /// Evicts all tiles but these and the coarsest level.
    pub(crate) fn retain(&mut self, wanted: &[Tile]) {
        match self {
            Self::Gpu(renderer) => renderer.tiles().retain(wanted),
            Self::Cpu(cpu) => cpu.tiles.retain(wanted),
            // Every tile has its place in its level's texture, in use or not.
            Self::Textures(_) | Self::None => {}
        }
    }

    /// Waits until what was uploaded is where it is drawn from.
    pub(crate) fn settle(&mut self) -> anyhow::Result<()> {
        match self {
            Self::Gpu(renderer) => Ok(renderer.tiles().settle()?),
            Self::Textures(renderer) => Ok(renderer.settle()?),
            Self::Cpu(_) | Self::None => Ok(()),
        }
    }

    /// Resident tiles that hold another frame than the one shown.
    pub(crate) fn wrong_frame_tiles(&mut self) -> usize {
        match self {
            Self::Gpu(renderer) => renderer.tiles().wrong_frame_tiles(),
            Self::Cpu(cpu) => cpu.tiles.wrong_frame_tiles(),
            Self::Textures(renderer) => renderer.wrong_frame_tiles(),
            Self::None => 0,
        }
    }

    /// Bytes of GPU memory in use.
    pub(crate) fn gpu_bytes(&mut self) -> u64 {
        match self {
            Self::Gpu(renderer) => renderer.gpu_bytes(),
            Self::Textures(renderer) => renderer.gpu_bytes(),
            Self::Cpu(_) | Self::None => 0,
        }
    }

    /// The samples of a resident tile, as whatever draws holds them.
    pub(crate) fn read_tile(&mut self, tile: Tile) -> anyhow::Result<Option<Picture>> {
        Ok(match self {
            Self::Gpu(renderer) => Some(renderer.tiles().read_tile(tile)?),
            Self::Cpu(cpu) => cpu.tiles.read_tile(tile),
            Self::Textures(_) | Self::None => None,
        })
    }

    /// The texture of the picture that a view shows on the GPU, with `marks` over it if there are
    /// any and tiles lie in the atlas; the next call reuses it. `None` where no GPU draws.
    pub(crate) fn draw(
        &mut self,
        view: &EyeView,
        marks: Option<&Overlay>,
    ) -> anyhow::Result<Option<&wgpu::Texture>> {
        Ok(match self {
            Self::Gpu(renderer) => Some(renderer.draw(view, marks)?),
            Self::Textures(renderer) => Some(renderer.draw(view)?),
            Self::Cpu(_) | Self::None => None,
        })
    }

    /// The picture that a view shows, with `marks` over it if there are any; `None` when nothing
    /// draws.
    pub(crate) fn picture(
        &mut self,
        view: &EyeView,
        marks: Option<&Overlay>,
    ) -> anyhow::Result<Option<RgbaImage>> {
        Ok(match (self, marks) {
            (Self::Gpu(renderer), None) => Some(renderer.reconstruct(view)?),
            (Self::Gpu(renderer), Some(marks)) => Some(renderer.heat_map(view, marks)?),
            (Self::Cpu(cpu), None) => Some(cpu.picture(view)),
            (Self::Cpu(cpu), Some(marks)) => {
                Some(twin::marked(&cpu.tiles, view, marks, cpu.picture(view)))
            }
            (Self::Textures(renderer), None) => Some(renderer.reconstruct(view)?),
            (Self::Textures(_), Some(_)) => {
                bail!("--heat-map marks the tiles of the atlas: leave --reconstruction textures")
            }
            (Self::None, _) => None,
        })
    }
}

impl CpuCanvas {
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
