// seen: how strongly does the eye see contrast in one band, at every place?
//
// Reads: the tables of the eye. Writes: sustained and transient sensitivity. Size: the band's.

// Sustained and transient sensitivity by octaves of frequency at the cortex.
@group(0) @binding(5) var<storage, read> sensitivities: array<vec2f>;
@group(0) @binding(6) var<storage, read_write> seen_by_texel: array<vec2f>;

fn sensitivity_at(octave: f32) -> vec2f {
    let last = arrayLength(&sensitivities) - 1u;
    let along = (octave - eye.first_octave) * eye.entries_per_octave;
    let place = clamp(along, 0.0, f32(last));
    let entry = min(u32(place), last - 1u);
    return mix(sensitivities[entry], sensitivities[entry + 1u], place - f32(entry));
}

// How much of the octave round a frequency lies below a limit; both as log2.
fn share_of_octave_below(octave: f32, limit: f32) -> f32 {
    return clamp(limit - octave + 0.5, 0.0, 1.0);
}

@compute @workgroup_size(8, 8)
fn seen(@builtin(global_invocation_id) id: vec3u) {
    let texel = id.xy;
    if (!is_texel(texel, band.fine)) {
        return;
    }
    let place = place_at(texel_place(texel));
    // The solid angle of a pixel shrinks with the cube of its distance.
    let octave = band.octave + eye.density_octave + 1.5 * log2(place.distance);
    let limit = min(eye.display_octave, -log2(place.spacing));
    let share = share_of_octave_below(octave, limit);
    let sensitivity = sensitivity_at(octave + place.octaves_raised);
    seen_by_texel[index_of(texel, band.fine)] = sensitivity * share;
}
