// Which colour does a pixel of a view into an equirectangular picture get?
//
// Reads the resident tiles. See shared/picture.wgsl.

// Draws the pixels whose samples lie in one tile, and leaves the others.
@fragment
fn reconstruct_equirect_inside(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let seen = seen_by(position.xy);
    let found = picture_at(seen.face, seen.place, seen.footprint, false);
    if (!found.complete) {
        discard;
    }
    return vec4f(found.colour, 1.0);
}

@fragment
fn reconstruct_equirect(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let seen = seen_by(position.xy);
    return vec4f(picture_at(seen.face, seen.place, seen.footprint, true).colour, 1.0);
}
