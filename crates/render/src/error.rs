//! What can go wrong between a picture and the GPU?

use foveal_core::asset::tile_grid::Tile;
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
    #[error("{what} would be {side} pixels on a side; this device draws at most {most}")]
    TooLarge {
        /// Which texture.
        what: &'static str,
        /// Its longer side in pixels.
        side: u32,
        /// The device's limit in pixels.
        most: u32,
    },
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
    /// The GPU did not hand a picture back.
    #[error("the GPU did not return the picture: {0}")]
    ReadBack(String),
}
