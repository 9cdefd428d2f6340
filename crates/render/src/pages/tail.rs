//! Where do the levels lie that are coarser than the coarsest page?
//!
//! They are made of it, by halves down to one texel, and share one slot: the first at its left, the
//! others to its right, one below the other.

use foveal_core::content::images::halving::Halving;
use foveal_core::content::images::picture::TexturePicture;
use foveal_core::content::images::shape::{BORDER, PAGE_SIDE, SLOT_SIDE, TextureShape};
use foveal_core::content::images::wrap::Wrap;

/// Column and row in the slot of the first texel, without border, of the level that is `below`
/// halves coarser than the root, at least one.
pub(crate) fn place_in_tail(below: u8) -> [u32; 2] {
    if below == 1 {
        return [BORDER; 2];
    }
    let above = (2..below).map(|it| (PAGE_SIDE >> it) + 2 * BORDER);
    [(PAGE_SIDE >> 1) + 3 * BORDER, above.sum::<u32>() + BORDER]
}

/// The slot of all levels that are coarser than a root page with its border.
pub(crate) fn tail_of(
    root: &TexturePicture,
    shape: &TextureShape,
    wrap: [Wrap; 2],
) -> TexturePicture {
    let mut tail = TexturePicture {
        size: [SLOT_SIDE; 2],
        texels: vec![[0; 4]; (SLOT_SIDE * SLOT_SIDE) as usize],
    };
    let halving = Halving::default();
    let mut level = inner(root);
    for below in 1..shape.levels() - shape.root() {
        level = halving.halved(&level);
        let [left, top] = place_in_tail(below).map(|it| it - BORDER);
        let size = level.size.map(|side| side + 2 * BORDER);
        for row in 0..size[1] {
            for column in 0..size[0] {
                let along = |k: usize, at: u32| {
                    wrap[k].texel(i64::from(at) - i64::from(BORDER), level.size[k])
                };
                let at = (top + row) * SLOT_SIDE + left + column;
                tail.texels[at as usize] = level.at([along(0, column), along(1, row)]);
            }
        }
    }
    tail
}

/// A page without its border.
fn inner(page: &TexturePicture) -> TexturePicture {
    let size = page.size.map(|side| side - 2 * BORDER);
    let rows = (0..size[1]).flat_map(|row| (0..size[0]).map(move |column| [column, row]));
    TexturePicture {
        size,
        texels: rows.map(|at| page.at(at.map(|it| it + BORDER))).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_fit_into_a_slot_beside_each_other() {
        let mut taken = vec![false; (SLOT_SIDE * SLOT_SIDE) as usize];
        for below in 1..=8 {
            let side = PAGE_SIDE >> below;
            let [left, top] = place_in_tail(below).map(|it| it - BORDER);
            for row in top..top + side + 2 * BORDER {
                for column in left..left + side + 2 * BORDER {
                    let at = &mut taken[(row * SLOT_SIDE + column) as usize];
                    assert!(!std::mem::replace(at, true), "{below}: {column} {row}");
                }
            }
        }
    }
}
