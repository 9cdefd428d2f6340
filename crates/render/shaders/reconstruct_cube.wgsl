// Which colour does a pixel of a view into a cube get?
//
// Reads the resident tiles; a ray always meets a face. See shared/picture.wgsl.

@fragment
fn reconstruct_cube(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let seen = seen_by(position.xy);
    return vec4f(picture_at(seen.face, seen.place, seen.footprint), 1.0);
}
