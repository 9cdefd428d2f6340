// How coarse may the picture look at a place, without a visible border between tiles?
//
// The shown footprint is the largest of: the footprint of a texel of the cell's own level; that of
// every cell nearby less its distance / growth; the footprint of the output pixel. Each grows by at
// most 1 / growth per level-0 pixel, so their maximum does, and it has no step where cells meet.

// The footprint to show at a place, given that of the output pixel and of the cell's own level.
fn shown_footprint(face: u32, place: vec2f, display: f32, own: f32) -> f32 {
    let widest = widened(face, place, max(display, own));
    return widened_across(face, place, widest);
}

// Levels between the finest and a footprint, from 0 to the coarsest; not whole.
fn level_of(footprint: f32) -> f32 {
    let level = log2(footprint) / f32(tiles.octaves);
    return clamp(level, 0.0, f32(tiles.coarsest));
}
