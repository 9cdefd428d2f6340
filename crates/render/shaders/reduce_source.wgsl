// What is a picture at about half its size, sharp and without what is too fine for it?
//
// Catmull-Rom's kernel, stretched to the texels of the coarser level: its negative lobes keep more
// detail than a mean of four and let less alias. In linear light.

@group(0) @binding(0) var finer: texture_2d<f32>;

// Catmull-Rom's kernel at a distance in texels of the coarser level.
fn kernel(distance: f32) -> f32 {
    let t = abs(distance);
    if (t >= 2.0) {
        return 0.0;
    }
    if (t < 1.0) {
        return 1.0 + t * t * (1.5 * t - 2.5);
    }
    return 2.0 + t * (-4.0 + t * (2.5 - 0.5 * t));
}

@fragment
fn reduce_source(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let size = vec2f(textureDimensions(finer));
    let ratio = size / max(floor(0.5 * size), vec2f(1.0));
    let middle = position.xy * ratio;
    let first = floor(middle - 2.0 * ratio);
    let count = vec2i(ceil(4.0 * ratio)) + 1;
    var sum = vec3f(0.0);
    var weights = 0.0;
    for (var row = 0; row < count.y; row = row + 1) {
        let y = first.y + f32(row);
        let weight_y = kernel((y + 0.5 - middle.y) / ratio.y);
        for (var column = 0; column < count.x; column = column + 1) {
            let x = first.x + f32(column);
            let weight = weight_y * kernel((x + 0.5 - middle.x) / ratio.x);
            let texel = clamp(vec2f(x, y), vec2f(0.0), size - 1.0);
            sum += weight * textureLoad(finer, vec2u(texel), 0).rgb;
            weights += weight;
        }
    }
    return vec4f(clamp(sum / weights, vec3f(0.0), vec3f(1.0)), 1.0);
}
