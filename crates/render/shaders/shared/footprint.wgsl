// How coarse may the picture look at a place, without a visible border between tiles?
//
// The shown footprint is the largest of: the footprint of a texel of the cell's own level; that of
// every cell nearby less its distance / growth; the footprint of the output pixel. Each grows by at
// most 1 / growth per level-0 pixel, so their maximum does, and it has no step where cells meet.

// The footprint at a place of `face` (or, unfolded, beside it), given what is known to be shown.
fn widened(face: u32, place: vec2f, known: f32) -> f32 {
    let reach = tiles.growth * (tiles.coarsest_scale - known);
    if (reach <= 0.0) {
        return known;
    }
    let from_cell = cell_at(place - reach);
    let to_cell = cell_at(place + reach);
    var widest = known;
    for (var y = from_cell.y; y <= to_cell.y; y = y + 1u) {
        for (var x = from_cell.x; x <= to_cell.x; x = x + 1u) {
            let low = vec2f(vec2u(x, y)) * tiles.cell;
            let high = min(low + tiles.cell, tiles.size);
            let away = length(max(max(low - place, place - high), vec2f(0.0)));
            let scale = scale_of(level_in(shown_in(face, vec2u(x, y))));
            widest = max(widest, scale - away / tiles.growth);
        }
    }
    return widest;
}

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
