// halve_depths: how near is the farthest of what is drawn in a square of pixels?
//
// Reads: depths of a picture, or those of the level before. Writes: depths of a level. Size: the
// level.

struct Halving {
    picture: vec2u,
    level: u32,
    unused: u32,
}

@group(0) @binding(0) var<uniform> halving: Halving;
@group(0) @binding(1) var<storage, read_write> depths: array<f32>;
@group(0) @binding(2) var drawn: texture_depth_2d;

@compute @workgroup_size(8, 8)
fn first_depths(@builtin(global_invocation_id) at: vec3u) {
    let sides = depth_sides(halving.picture, 1u);
    if (at.x >= sides.x || at.y >= sides.y) {
        return;
    }
    let last = halving.picture - 1u;
    let low = min(2u * at.xy, last);
    let high = min(low + 1u, last);
    let above = min(textureLoad(drawn, low, 0), textureLoad(drawn, vec2u(high.x, low.y), 0));
    let below = min(textureLoad(drawn, vec2u(low.x, high.y), 0), textureLoad(drawn, high, 0));
    depths[at.y * sides.x + at.x] = min(above, below);
}

@compute @workgroup_size(8, 8)
fn halve_depths(@builtin(global_invocation_id) at: vec3u) {
    let sides = depth_sides(halving.picture, halving.level);
    if (at.x >= sides.x || at.y >= sides.y) {
        return;
    }
    let finer = depth_sides(halving.picture, halving.level - 1u);
    let start = depth_start(halving.picture, halving.level - 1u);
    let low = 2u * at.xy;
    let high = min(low + 1u, finer - 1u);
    let above = start + low.y * finer.x;
    let below = start + high.y * finer.x;
    let upper = min(depths[above + low.x], depths[above + high.x]);
    let lower = min(depths[below + low.x], depths[below + high.x]);
    let place = start + finer.x * finer.y + at.y * sides.x + at.x;
    depths[place] = min(upper, lower);
}
