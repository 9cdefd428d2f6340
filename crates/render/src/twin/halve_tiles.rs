//! How does a tile look at the next coarser level's spacing? Twin of `shaders/halve_tiles.wgsl`.

use crate::params::HalvedParams;
use crate::tiles::samples::Samples;
use glam::{IVec2, UVec2};

fn code_at(finer: &Samples, texel: IVec2) -> u8 {
    finer.codes[(texel.y * finer.extent.size[0] as i32 + texel.x) as usize]
}

fn halve_tiles(
    tile: &HalvedParams,
    finer: &Samples,
    value_of: impl Fn(u8) -> i32,
    code_of: impl Fn(i32) -> u8,
    position: UVec2,
) -> u8 {
    let start = position.as_ivec2() * tile.ratio as i32 + IVec2::from(tile.shift);
    let low = start.max(UVec2::from(tile.low).as_ivec2());
    let high = (start + tile.ratio as i32).min(UVec2::from(tile.high).as_ivec2());
    let sides = high - low;
    let count = sides.x * sides.y;
    let mut sum = count / 2;
    for y in low.y..high.y {
        for x in low.x..high.x {
            sum += value_of(code_at(finer, IVec2::new(x, y)));
        }
    }
    code_of(sum / count)
}

/// One plane of a tile with samples `ratio` times as far apart. What codes stand for, and codes of
/// means, take the place of the shader's tables.
pub(crate) fn halved(
    finer: &Samples,
    ratio: u32,
    value_of: impl Fn(u8) -> i32,
    code_of: impl Fn(i32) -> u8,
) -> Samples {
    let tile = HalvedParams::new(finer.extent, [0; 3], ratio);
    let mut codes = Vec::with_capacity(tile.size[0] as usize * tile.size[1] as usize);
    for y in 0..tile.size[1] {
        for x in 0..tile.size[0] {
            let position = UVec2::new(x, y);
            codes.push(halve_tiles(&tile, finer, &value_of, &code_of, position));
        }
    }
    Samples {
        extent: finer.extent.reduced(ratio),
        codes,
    }
}
