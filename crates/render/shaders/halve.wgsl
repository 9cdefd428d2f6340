// halve: what is the next coarser level of a picture? Filtered by (1, 3, 3, 1) / 8 on both axes.
//
// Reads: luminance of a level. Writes: luminance of the next. Size: the next level's.

@group(0) @binding(1) var<storage, read> fine: array<f32>;
@group(0) @binding(2) var<storage, read_write> coarse: array<f32>;

// The four fine samples that one coarse sample covers, on one axis; the border repeats.
fn four_around(coarse: u32, count: u32) -> vec4u {
    let first = 2u * coarse;
    let around = vec4u(max(first, 1u) - 1u, first, first + 1u, first + 2u);
    return min(around, vec4u(count - 1u));
}

// Written so that equal samples give exactly themselves.
fn tap(values: vec4f) -> f32 {
    let inner = 0.5 * (values.y + values.z);
    let outer = 0.5 * (values.x + values.w);
    return inner + 0.25 * (outer - inner);
}

fn tap_row(row: u32, columns: vec4u) -> f32 {
    let at = row * band.fine.x + columns;
    return tap(vec4f(fine[at.x], fine[at.y], fine[at.z], fine[at.w]));
}

@compute @workgroup_size(8, 8)
fn halve(@builtin(global_invocation_id) id: vec3u) {
    let texel = id.xy;
    if (!is_texel(texel, band.coarse)) {
        return;
    }
    let columns = four_around(texel.x, band.fine.x);
    let rows = four_around(texel.y, band.fine.y);
    let above = vec2f(tap_row(rows.x, columns), tap_row(rows.y, columns));
    let below = vec2f(tap_row(rows.z, columns), tap_row(rows.w, columns));
    coarse[index_of(texel, band.coarse)] = tap(vec4f(above, below));
}
