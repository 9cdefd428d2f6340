// What is a picture at half its size, without the detail that is too fine for it?
//
// A binomial of 1 3 3 1 over 8 on each axis, by four reads between texels: 0.75 from the middle
// lies the mean of one pair of weights 1 and 3. Adds a variance of 0.75 texels².

@group(0) @binding(5) var larger: texture_2d<f32>;
@group(0) @binding(6) var between: sampler;

@fragment
fn blur_halve(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let size = vec2f(textureDimensions(larger));
    let middle = position.xy * size / max(floor(0.5 * size), vec2f(1.0));
    var sum = vec4f(0.0);
    for (var corner = 0u; corner < 4u; corner = corner + 1u) {
        let beside = vec2f(vec2u(corner & 1u, corner >> 1u)) * 1.5 - 0.75;
        sum += textureSampleLevel(larger, between, (middle + beside) / size, 0.0);
    }
    return 0.25 * sum;
}
