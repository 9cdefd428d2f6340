// Which colour does a pixel of a view on flat content get?
//
// Reads the resident tiles; beside the content it is black. See shared/picture.wgsl.

@fragment
fn reconstruct_plane(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let seen = seen_by(position.xy);
    if (!seen.inside) {
        return vec4f(0.0, 0.0, 0.0, 1.0);
    }
    return vec4f(picture_at(seen.face, seen.place, seen.footprint), 1.0);
}
