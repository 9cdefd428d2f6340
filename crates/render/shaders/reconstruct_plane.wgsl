// Which colour does a pixel of a view on flat content get?
//
// Reads the resident tiles; outside the content it is black. See shared/picture.wgsl.

// Draws the pixels whose samples lie in one tile, and leaves the others.
@fragment
fn reconstruct_plane_inside(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let seen = seen_by(position.xy);
    if (!seen.inside) {
        return vec4f(0.0, 0.0, 0.0, 1.0);
    }
    let found = picture_at(seen.face, seen.place, seen.footprint, false);
    if (!found.complete) {
        discard;
    }
    return vec4f(found.colour, 1.0);
}

@fragment
fn reconstruct_plane(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let seen = seen_by(position.xy);
    if (!seen.inside) {
        return vec4f(0.0, 0.0, 0.0, 1.0);
    }
    return vec4f(picture_at(seen.face, seen.place, seen.footprint, true).colour, 1.0);
}
