// contrast: how much contrast has a picture in one band? Band-passed luminance over the mean below
// the band: Peli 1990.
//
// Reads: luminance of the band's level and of the next coarser one. Writes: signed contrast.
// Size: the band's.

@group(0) @binding(2) var<storage, read> fine: array<f32>;
@group(0) @binding(3) var<storage, read_write> contrasts: array<f32>;

@compute @workgroup_size(8, 8)
fn contrast(@builtin(global_invocation_id) id: vec3u) {
    let texel = id.xy;
    if (!is_texel(texel, band.fine)) {
        return;
    }
    let at = index_of(texel, band.fine);
    let mean = doubled(texel);
    contrasts[at] = (fine[at] - mean) / mean * band.contrast_scale;
}
