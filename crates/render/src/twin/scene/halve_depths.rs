//! How near is the farthest of what is drawn in a square of pixels? Twin of
//! `shaders/halve_depths.wgsl` and `shaders/shared/depths.wgsl`.

use crate::meshes::hiding::sides;

/// Where a level begins.
pub(super) fn depth_start(picture: [u32; 2], level: u32) -> usize {
    let texels = |level| sides(picture, level).map(|side| side as usize);
    (1..level)
        .map(|finer| texels(finer).iter().product::<usize>())
        .sum()
}

/// The first level, of a picture's depths row by row.
pub(super) fn first_depths(picture: [u32; 2], drawn: &[f32]) -> Vec<f32> {
    let mut depths = Vec::new();
    add_level(&mut depths, sides(picture, 1), picture, |at| drawn[at]);
    depths
}

/// Adds a level behind those before it.
pub(super) fn halve_depths(picture: [u32; 2], level: u32, depths: &mut Vec<f32>) {
    let start = depth_start(picture, level - 1);
    let finer = depths[start..].to_vec();
    let sides_of = |level| sides(picture, level);
    add_level(depths, sides_of(level), sides_of(level - 1), |at| finer[at]);
}

fn add_level(
    depths: &mut Vec<f32>,
    [columns, rows]: [u32; 2],
    [finer_columns, finer_rows]: [u32; 2],
    depth: impl Fn(usize) -> f32,
) {
    let at = |x: u32, y: u32| {
        let [x, y] = [x.min(finer_columns - 1), y.min(finer_rows - 1)];
        depth((y * finer_columns + x) as usize)
    };
    for y in 0..rows {
        for x in 0..columns {
            let [low, high] = [[2 * x, 2 * y], [2 * x + 1, 2 * y + 1]];
            let above = at(low[0], low[1]).min(at(high[0], low[1]));
            let below = at(low[0], high[1]).min(at(high[0], high[1]));
            depths.push(above.min(below));
        }
    }
}
