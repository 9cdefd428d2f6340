// Which colour stands for a level?

// Diverging colours from red (0) over yellow to blue (1): ColorBrewer's RdYlBu.
fn ramp(at: f32) -> vec3f {
    let red = vec3f(0.843, 0.098, 0.110);
    let orange = vec3f(0.992, 0.682, 0.380);
    let yellow = vec3f(1.0, 1.0, 0.749);
    let sky = vec3f(0.671, 0.851, 0.914);
    let blue = vec3f(0.173, 0.482, 0.714);
    let x = clamp(at, 0.0, 1.0) * 4.0;
    let warm = mix(mix(red, orange, clamp(x, 0.0, 1.0)), yellow, clamp(x - 1.0, 0.0, 1.0));
    return mix(mix(warm, sky, clamp(x - 2.0, 0.0, 1.0)), blue, clamp(x - 3.0, 0.0, 1.0));
}
