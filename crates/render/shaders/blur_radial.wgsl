// How does a finished picture look when it is blurred as far as the eye is blind to detail?
//
// Kastner 2016, section 4.4: a radial Gauss blur as a post-process that follows the acuity function
// and leaves the fovea untouched. The spread of the Gaussian grows from the edge of the fovea in
// proportion to the minimum angle of resolution; it is read from halved pictures, at the level that
// has its variance. Reads the picture and its halves.

struct Blur {
    ray_from_pixel: mat3x3f,
    gaze: vec3f,
    fovea_chord: f32,
    fovea: f32,
    growth: f32,
    pitch: f32,
    last: f32,
    // Variance of the first half in pixels².
    first: f32,
    unused: f32,
    unused_pair: vec2f,
}

@group(0) @binding(4) var<uniform> blur: Blur;
@group(0) @binding(5) var picture: texture_2d<f32>;
@group(0) @binding(6) var halves: texture_2d<f32>;
@group(0) @binding(7) var between: sampler;

// Variance in pixels² that reading between two texels of the first half adds: a sixth of a texel's
// square.
const READING_VARIANCE = 0.6666667;

// Variance in pixels² of the Gaussian at a ray, whose depth is 1.
fn variance_at(ray: vec3f, chord: f32) -> f32 {
    let eccentricity = 2.0 * asin(min(0.5 * chord, 1.0));
    let far = length(ray);
    let pixel_angle = blur.pitch / (far * sqrt(far));
    let sigma = blur.growth * (eccentricity - blur.fovea) / pixel_angle;
    return sigma * sigma;
}

@fragment
fn blur_radial(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let sharp = textureLoad(picture, vec2i(floor(position.xy)), 0);
    let ray = blur.ray_from_pixel * vec3f(position.xy, 1.0);
    let chord = length(normalize(ray) - blur.gaze);
    if (chord <= blur.fovea_chord) {
        return sharp;
    }
    let variance = variance_at(ray, chord);
    // k halvings, of which each but the first adds 0.75 of its texels, and reading between texels
    // make first - 1 + 4^k / 4 + 4^k / 6.
    let level = 0.5 * log2((variance + 1.0 - blur.first) / 0.4166667) - 1.0;
    let place = position.xy / vec2f(textureDimensions(picture));
    let soft = textureSampleLevel(halves, between, place, clamp(level, 0.0, blur.last));
    return mix(sharp, soft, min(variance / (blur.first + READING_VARIANCE), 1.0));
}
