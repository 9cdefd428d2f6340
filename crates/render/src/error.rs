//! What can go wrong between a picture and the GPU?

use foveal_core::content::video::grid::tile_grid::Tile;
use foveal_core::pack::PackError;
use thiserror::Error;

/// Why nothing can be drawn, in words for the person at the screen.
#[derive(Debug, Error)]
pub enum RenderError {
    /// No driver offers an adapter, not even a software one.
    #[error(
        "no GPU adapter was found ({0}); install a driver, or Mesa's software one: \
         apt-get install mesa-vulkan-drivers libvulkan1 (in a browser: turn WebGPU on)"
    )]
    NoAdapter(String),
    /// The adapter was found and then refused a device.
    #[error("the adapter {adapter} gives no device: {reason}")]
    NoDevice {
        /// Name of the adapter.
        adapter: String,
        /// What the driver said.
        reason: String,
    },
    /// A texture would be larger than the device allows.
    #[error(
        "{what} would be {side} pixels on a side; this device draws at most {most} \
         (its max_texture_dimension_2d): ask for a smaller picture, or take another GPU"
    )]
    TooLarge {
        /// Which texture.
        what: &'static str,
        /// Its longer side in pixels.
        side: u32,
        /// The device's limit in pixels.
        most: u32,
    },
    /// Marks over tiles that lie in a texture for every level.
    #[error("--heat-map marks the tiles of the atlas: leave --reconstruction textures")]
    NoMarks,
    /// What was decoded is of another kind of content than what is drawn.
    #[error("a tile came for a scene, or a mesh for a video: the pack changed while it was read")]
    OtherKind,
    /// A tile that the grid does not have.
    #[error("{0:?} is no tile of this picture")]
    NoSuchTile(Tile),
    /// A tile that was asked back and is not on the GPU.
    #[error("{0:?} is not on the GPU; upload it first")]
    NotResident(Tile),
    /// A decoded tile has another size than its place in the grid.
    #[error(
        "{tile:?} came as {found:?} pixels with planes of {planes:?} bytes; it is {expected:?}"
    )]
    TileSize {
        /// The tile.
        tile: Tile,
        /// Size in the grid, in pixels.
        expected: [u32; 2],
        /// Size of the picture given, in pixels.
        found: [u32; 2],
        /// Bytes of its planes.
        planes: [usize; 3],
    },
    /// A level picture or an image of unit ids does not fit what it is compared with.
    #[error("{what} is {found}; it must be {expected}")]
    Misfit {
        /// Which picture.
        what: String,
        /// What it must be.
        expected: String,
        /// What it is.
        found: String,
    },
    /// Pixels name units that do not exist.
    #[error("unit ids must be below {units}, or 4294967295 for none; {runs} runs of pixels differ")]
    StrayUnits {
        /// How many units there are.
        units: usize,
        /// Runs of pixels with another id.
        runs: u32,
    },
    /// A buffer would be larger than the device allows.
    #[error(
        "{what} would take {bytes} bytes; this device binds at most {most} \
         (its max_storage_buffer_binding_size): ask for less at once, or take another GPU"
    )]
    TooMuch {
        /// What it holds.
        what: &'static str,
        /// Its size in bytes.
        bytes: u64,
        /// The device's limit in bytes.
        most: u64,
    },
    /// A pass needs more of something than the device has.
    #[error(
        "{what} takes {needs} of this device's {limit}, which are {has}: draw by --renderer cpu, \
         or take another GPU"
    )]
    Lacks {
        /// What is drawn.
        what: &'static str,
        /// The limit, as WebGPU names it.
        limit: &'static str,
        /// How many are needed.
        needs: u32,
        /// How many there are.
        has: u32,
    },
    /// A texture or buffer that the device allows and its memory does not hold.
    #[error(
        "{what} would take {bytes} bytes, for which the GPU's memory has no room: close what else \
         uses it, or ask for less"
    )]
    OutOfMemory {
        /// What it holds.
        what: &'static str,
        /// Its size in bytes.
        bytes: u64,
    },
    /// A unit of a mesh does not fit to those that are there.
    #[error("{0}; the pack is damaged, or the unit came before its prerequisites")]
    Unit(#[from] PackError),
    /// The units of a scene would take more of the GPU's memory than they may.
    #[error(
        "units would take {bytes} bytes of GPU memory, of at most {most}; \
         raise --gpu-memory, or evict units first"
    )]
    NoRoom {
        /// What all units would take.
        bytes: u64,
        /// What they may take.
        most: u64,
    },
    /// The GPU did not hand its result back.
    #[error("the GPU did not return its result: {0}")]
    ReadBack(String),
}
