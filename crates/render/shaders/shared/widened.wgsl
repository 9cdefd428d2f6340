// How coarse may a place of one face look, for the cells nearby?

// The footprint at a place of `face` (or, unfolded, next to it), given what is known to be shown.
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
