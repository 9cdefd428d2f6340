// Which red, green and blue do Y, U and V make?

fn rgb_from_yuv(yuv: vec3f) -> vec3f {
    let code = vec4f(yuv, 1.0);
    let red = dot(tiles.rgb_from_yuv[0], code);
    let green = dot(tiles.rgb_from_yuv[1], code);
    let blue = dot(tiles.rgb_from_yuv[2], code);
    return clamp(vec3f(red, green, blue), vec3f(0.0), vec3f(1.0));
}
