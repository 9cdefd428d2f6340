//! Does a tile come back from the GPU as it went there?

use foveal_core::content::video::grid::tile_grid::{Cut, Tile, TileGrid};
use foveal_core::view::picture::{Colour, Matrix, Picture};
use foveal_core::view::surface::{Screen, Surface};
use foveal_render::{Gpu, RenderError, Renderer};

const COLOUR: Colour = Colour {
    matrix: Matrix::Bt709,
    full_range: false,
    chroma_left: true,
};

/// A picture whose every sample differs from its neighbours and from tile to tile.
fn patterned([width, height]: [u32; 2], tile: Tile) -> Picture {
    let mut picture = Picture::filled(width, height, [0; 3]);
    let shift = usize::from(tile.level) * 50 + usize::from(tile.x) * 7 + usize::from(tile.y) * 13;
    for (p, plane) in picture.planes.iter_mut().enumerate() {
        for (at, sample) in plane.iter_mut().enumerate() {
            *sample = ((at * 31 + shift + p * 101) % 251) as u8;
        }
    }
    picture
}

#[test]
fn every_resident_tile_is_read_back_as_it_was_uploaded() -> Result<(), RenderError> {
    // Odd sizes: the last tiles of a row and of a column are narrow.
    let surface = Surface::flat([333, 201], Screen::default());
    let grid = TileGrid::new(surface, Cut::Tile(64), 3, 2).unwrap();
    let mut renderer = Renderer::new(&Gpu::open_blocking()?, &grid, COLOUR, 16)?;
    let all: Vec<Tile> = (0..grid.levels).flat_map(|l| grid.tiles_of(l)).collect();
    for &tile in &all {
        let picture = patterned(grid.tile_size(tile), tile);
        renderer.tiles().upload(tile, 0, &picture)?;
    }
    for &tile in &all {
        let expected = patterned(grid.tile_size(tile), tile);
        assert_eq!(renderer.tiles().read_tile(tile)?, expected, "{tile:?}");
    }
    renderer.tiles().retain(&[]);
    let gone = renderer.tiles().read_tile(all[0]);
    assert!(matches!(gone, Err(RenderError::NotResident(_))));
    Ok(())
}
