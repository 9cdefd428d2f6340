// luminance: how much light does every pixel of a level picture give, in cd/m2?
//
// Reads: the picture (sRGB codes), what each code adds. Writes: luminance. Size: the picture's.

@group(0) @binding(1) var picture: texture_2d<f32>;
// Luminance that a code of red, of green and of blue adds to black; black itself is in the last
// component.
@group(0) @binding(2) var<storage, read> codes: array<vec4f, 256>;
@group(0) @binding(3) var<storage, read_write> light: array<f32>;

@compute @workgroup_size(8, 8)
fn luminance(@builtin(global_invocation_id) id: vec3u) {
    let texel = id.xy;
    if (!is_texel(texel, band.fine)) {
        return;
    }
    let code = vec3u(round(textureLoad(picture, texel, 0).rgb * 255.0));
    let red = codes[code.r];
    let colour = red.r + codes[code.g].g + codes[code.b].b;
    light[index_of(texel, band.fine)] = colour + red.a;
}
