// Which texels has a band, and which lie around one of them?
//
// Row by row in storage buffers. Borders repeat. The twin is `perception/pyramid.rs` of core.

struct Band {
    // Columns and rows of the band, and of the next coarser level.
    fine: vec2u,
    coarse: vec2u,
    // Columns and rows of the whole picture.
    picture: vec2f,
    // Pixels on a side of a texel.
    side: f32,
    // 1 / what the filters leave of a grating at the band's centre.
    contrast_scale: f32,
    // Log2 of the band's frequency where the picture has one pixel per degree.
    octave: f32,
    // 0 for the coarsest band.
    has_coarser: u32,
}

@group(0) @binding(0) var<uniform> band: Band;

fn is_texel(texel: vec2u, size: vec2u) -> bool {
    return all(texel < size);
}

fn index_of(texel: vec2u, size: vec2u) -> u32 {
    return texel.y * size.x + texel.x;
}

// The centre of a texel in the picture; the last one may reach over the border.
fn texel_place(texel: vec2u) -> vec2f {
    return min((vec2f(texel) + 0.5) * band.side, band.picture);
}
