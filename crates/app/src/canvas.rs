//! What draws the picture: the GPU, or the CPU twin of its passes?

use anyhow::Context;
use clap::ValueEnum;
use foveal_core::asset::picture::{Colour, Picture};
use foveal_core::asset::tile_grid::{Tile, TileGrid};
use foveal_core::view::eye_view::EyeView;
use foveal_render::twin::{self, TwinTiles};
use foveal_render::{Gpu, Overlay, Renderer, RgbaImage};

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
    Cpu(Box<TwinTiles>),
    None,
}

impl Canvas {
    /// A canvas for the tiles of `grid`.
    pub(crate) fn new(drawing: &Drawing, grid: &TileGrid, colour: Colour) -> anyhow::Result<Self> {
        Ok(match drawing {
            Drawing::Gpu(gpu) => {
                Self::Gpu(Box::new(Renderer::new(gpu, grid, colour, MOST_LAYERS)?))
            }
            Drawing::Cpu => Self::Cpu(Box::new(TwinTiles::new(grid, colour))),
            Drawing::None => Self::None,
        })
    }

    /// From now on source frame `frame` is shown.
    pub(crate) fn begin_frame(&mut self, frame: u32) {
        match self {
            Self::Gpu(renderer) => renderer.tiles().begin_frame(frame),
            Self::Cpu(tiles) => tiles.begin_frame(frame),
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
            Self::Cpu(tiles) => tiles.upload(tile, frame, &picture)?,
            Self::None => {}
        }
        Ok(())
    }

    /// Evicts all tiles but these and the coarsest level.
    pub(crate) fn retain(&mut self, wanted: &[Tile]) {
        match self {
            Self::Gpu(renderer) => renderer.tiles().retain(wanted),
            Self::Cpu(tiles) => tiles.retain(wanted),
            Self::None => {}
        }
    }

    /// Waits until what was uploaded is where it is drawn from.
    pub(crate) fn settle(&mut self) -> anyhow::Result<()> {
        match self {
            Self::Gpu(renderer) => Ok(renderer.tiles().settle()?),
            Self::Cpu(_) | Self::None => Ok(()),
        }
    }

    /// Resident tiles that hold another frame than the one shown.
    pub(crate) fn wrong_frame_tiles(&mut self) -> usize {
        match self {
            Self::Gpu(renderer) => renderer.tiles().wrong_frame_tiles(),
            _ => 0,
        }
    }

    /// Bytes of GPU memory in use.
    pub(crate) fn gpu_bytes(&mut self) -> u64 {
        match self {
            Self::Gpu(renderer) => renderer.tiles().gpu_bytes(),
            _ => 0,
        }
    }

    /// The samples of a resident tile, as whatever draws holds them.
    pub(crate) fn read_tile(&mut self, tile: Tile) -> anyhow::Result<Option<Picture>> {
        Ok(match self {
            Self::Gpu(renderer) => Some(renderer.tiles().read_tile(tile)?),
            Self::Cpu(tiles) => tiles.read_tile(tile),
            Self::None => None,
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
            (Self::Cpu(tiles), None) => Some(twin::reconstruct(tiles, view)),
            (Self::Cpu(tiles), Some(marks)) => Some(twin::heat_map(tiles, view, marks)),
            (Self::None, _) => None,
        })
    }
}
