// gain: what do a band, and all coarser ones, add to the value of a step?
//
// Reads: contrasts before and after the step, sensitivities, the gain of the coarser bands.
// Writes: the gain of all bands from this one on. Size: the band's. The twin is
// `perception/gain.rs` of core.

@group(0) @binding(3) var<storage, read> contrast_before: array<f32>;
@group(0) @binding(4) var<storage, read> contrast_after: array<f32>;
@group(0) @binding(5) var<storage, read> seen: array<vec2f>;
@group(0) @binding(6) var<storage, read_write> gains: array<f32>;

// Weber's ratio with short-term memory: Chen et al. 2022, Eq. 2.
fn popping(transient: f32, before: f32, difference: f32) -> f32 {
    return transient * difference / (transient * before + eye.omega);
}

fn error_removed(sustained: f32, difference: f32) -> f32 {
    return sustained * difference;
}

fn band_gain(at: u32) -> f32 {
    let before = contrast_before[at];
    let difference = abs(before - contrast_after[at]);
    let sensitivity = seen[at];
    let error = eye.error * error_removed(sensitivity.x, difference);
    return error + eye.popping * popping(sensitivity.y, abs(before), difference);
}

@compute @workgroup_size(8, 8)
fn gain(@builtin(global_invocation_id) id: vec3u) {
    let texel = id.xy;
    if (!is_texel(texel, band.fine)) {
        return;
    }
    let at = index_of(texel, band.fine);
    var sum = band_gain(at);
    if (band.has_coarser != 0u) {
        sum = sum + doubled(texel);
    }
    gains[at] = sum;
}
