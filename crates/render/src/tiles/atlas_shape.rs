//! How is the atlas divided?
//!
//! Into layers. The first hold the coarsest level of every face, always resident; the slots that
//! these leave free, and all slots of later layers, hold tiles of the other levels.

use foveal_core::content::video::grid::tile_grid::{Cut, TileGrid};

/// Pixels that a layer has on a side, at least, when there are tiles to fill it.
const LAYER_SIDE: u32 = 1024;

/// Most slots across a layer: a slot's column and row are 8 bits each.
const MOST_ACROSS: u32 = 255;

/// Sizes and places in luma pixels, all even.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct AtlasShape {
    /// Pixels of a slot: the largest tile, and room for its reductions.
    pub(crate) slot: [u32; 2],
    /// Pixels of a layer.
    pub(crate) layer: [u32; 2],
    /// Mips of the atlas: a tile, then its reductions to half, quarter, ...
    pub(crate) mips: u32,
    /// Pixels from one tile of the coarsest level to the next.
    pub(crate) base_step: [u32; 2],
    /// Pixels from one face of the coarsest level to the next.
    pub(crate) base_face: [u32; 2],
    /// Faces of the coarsest level in a layer, columns and rows.
    pub(crate) base_across: [u32; 2],
    faces: u32,
    has_slots: bool,
}

impl AtlasShape {
    /// Room for any tile of `grid`.
    pub(crate) fn new(grid: &TileGrid) -> Self {
        // Tiles are never reduced to the coarsest level, which is always there.
        let octaves = grid.ratio.trailing_zeros() * u32::from(grid.coarsest().saturating_sub(1));
        let unit = 2 << octaves;
        let aligned = match grid.cut {
            Cut::Grid(_) => true,
            Cut::Tile(px) => px % unit == 0 || grid.tiles(0) == [1, 1],
        };
        let spare = if aligned { 0 } else { unit };
        let slot = grid
            .largest_tile()
            .map(|side| side.next_multiple_of(unit) + spare);
        let coarsest = grid.tile_at(grid.coarsest(), 0);
        let base_step = grid.tile_size(coarsest).map(|s| s.next_multiple_of(2));
        let base_face = [0, 1].map(|k| grid.tiles(grid.coarsest())[k] * base_step[k]);
        let tiles = grid.tiles(0);
        let layer = [0, 1].map(|k| {
            let slots = LAYER_SIDE.div_ceil(slot[k]).min(tiles[k]).max(1);
            (slots * slot[k]).max(base_face[k].next_multiple_of(unit))
        });
        let wanted = if grid.faces() == 1 { [1, 1] } else { [3, 2] };
        Self {
            slot,
            layer,
            mips: octaves + 1,
            base_step,
            base_face,
            base_across: [0, 1].map(|k| (layer[k] / base_face[k]).min(wanted[k])),
            faces: grid.faces(),
            has_slots: grid.levels > 1,
        }
    }

    /// Layers that hold faces of the coarsest level.
    pub(crate) fn base_layers(&self) -> u32 {
        self.faces
            .div_ceil(self.base_across[0] * self.base_across[1])
    }

    /// Left, top and layer of a face of the coarsest level.
    pub(crate) fn base_place(&self, face: u32) -> [u32; 3] {
        let [columns, rows] = self.base_across;
        let in_layer = face % (columns * rows);
        [
            in_layer % columns * self.base_face[0],
            in_layer / columns * self.base_face[1],
            face / (columns * rows),
        ]
    }

    /// Column and row of every slot of a layer that no face of the coarsest level covers.
    pub(crate) fn slots_in(&self, layer: u32) -> Vec<[u32; 3]> {
        if !self.has_slots {
            return Vec::new();
        }
        let across = [0, 1].map(|k| (self.layer[k] / self.slot[k]).min(MOST_ACROSS));
        let covered = |[column, row, layer]: [u32; 3]| {
            let low = [column * self.slot[0], row * self.slot[1]];
            (0..self.faces).any(|face| {
                let [x, y, face_layer] = self.base_place(face);
                let meets = |k: usize, from: u32| {
                    from < low[k] + self.slot[k] && low[k] < from + self.base_face[k]
                };
                face_layer == layer && meets(0, x) && meets(1, y)
            })
        };
        (0..across[1])
            .flat_map(|row| (0..across[0]).map(move |column| [column, row, layer]))
            .filter(|&slot| !covered(slot))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use foveal_core::view::surface::Surface;

    #[test]
    fn the_faces_of_a_16k_cube_leave_room_in_their_layer() {
        let grid = TileGrid::new(Surface::cube(4096), Cut::Tile(256), 5, 2).unwrap();
        let shape = AtlasShape::new(&grid);
        assert_eq!((shape.layer, shape.base_layers()), ([1024, 1024], 1));
        assert_eq!((shape.slots_in(0).len(), shape.slots_in(1).len()), (10, 16));
    }

    #[test]
    fn a_face_as_large_as_a_layer_gets_one_of_its_own() {
        let grid = TileGrid::new(Surface::cube(2048), Cut::Tile(256), 2, 2).unwrap();
        let shape = AtlasShape::new(&grid);
        assert_eq!((shape.layer, shape.base_layers()), ([1024, 1024], 6));
        assert_eq!((shape.slots_in(5).len(), shape.slots_in(6).len()), (0, 16));
    }

    #[test]
    fn one_level_needs_no_slots() {
        let grid = TileGrid::new(Surface::cube(300), Cut::Tile(64), 1, 2).unwrap();
        let shape = AtlasShape::new(&grid);
        assert_eq!((shape.layer, shape.slots_in(9).len()), ([300, 300], 0));
    }
}
