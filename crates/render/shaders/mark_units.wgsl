// mark_units: what is the unit worth that would refine what each pixel shows?
//
// Drawn over a picture by blending. Reads: the units that would refine what is drawn, and what each
// of them is worth, 0 to 1, less than 0 where that is not known. Writes: sRGB codes. Warm is worth
// much, blue is worth little; what no unit would refine stays as it is.

@group(0) @binding(0) var units: texture_2d<u32>;
@group(0) @binding(1) var<storage, read> worths: array<f32>;

const COVERED = 0.6;

@fragment
fn mark_units(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let unit = textureLoad(units, vec2u(position.xy), 0).x;
    if (unit >= arrayLength(&worths)) {
        return vec4f(0.0);
    }
    let worth = worths[unit];
    if (worth < 0.0) {
        return vec4f(0.0);
    }
    return vec4f(ramp(1.0 - worth), COVERED);
}
