// What has the next coarser level at a fine texel? Bilinear between centres of cells.

@group(0) @binding(1) var<storage, read> coarse: array<f32>;

// The coarse sample that a fine one lies in, and the one that it lies next to, on one axis.
fn two_around(fine: u32, count: u32) -> vec2u {
    let near = fine / 2u;
    let before = max(near, 1u) - 1u;
    let far = select(near + 1u, before, (fine & 1u) == 0u);
    return vec2u(near, min(far, count - 1u));
}

// Three quarters of one and a quarter of the other; exact where both are the same.
fn leaned(near: f32, far: f32) -> f32 {
    return near + 0.25 * (far - near);
}

fn doubled(texel: vec2u) -> f32 {
    let columns = two_around(texel.x, band.coarse.x);
    let rows = two_around(texel.y, band.coarse.y) * band.coarse.x;
    let near = leaned(coarse[rows.x + columns.x], coarse[rows.x + columns.y]);
    let far = leaned(coarse[rows.y + columns.x], coarse[rows.y + columns.y]);
    return leaned(near, far);
}
