// How near is the farthest of what is drawn in a square of pixels?
//
// The nearest depth is the largest number. Level 1 has a depth for two by two pixels, each further
// level one for two by two of the level before. All lie one behind the other, row by row.

// Columns and rows of a level of a picture of this size.
fn depth_sides(picture: vec2u, level: u32) -> vec2u {
    return (picture + (1u << level) - 1u) >> vec2u(level);
}

// Where a level begins.
fn depth_start(picture: vec2u, level: u32) -> u32 {
    var start = 0u;
    for (var finer = 1u; finer < level; finer = finer + 1u) {
        let sides = depth_sides(picture, finer);
        start = start + sides.x * sides.y;
    }
    return start;
}
