// Which pixels are drawn? All of them: one triangle that covers the picture.
//
// A reconstruct pass draws in two steps, `cover` and `cover_rest`, which lies behind: its depth
// leaves what the first has drawn.

fn corner_at(corner: u32, depth: f32) -> vec4f {
    let x = select(-1.0, 3.0, corner == 1u);
    let y = select(-1.0, 3.0, corner == 2u);
    return vec4f(x, y, depth, 1.0);
}

@vertex
fn cover(@builtin(vertex_index) corner: u32) -> @builtin(position) vec4f {
    return corner_at(corner, 0.0);
}

@vertex
fn cover_rest(@builtin(vertex_index) corner: u32) -> @builtin(position) vec4f {
    return corner_at(corner, 0.5);
}
