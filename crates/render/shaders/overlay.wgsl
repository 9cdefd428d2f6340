// Which level does each place show, and where is the gaze?
//
// Drawn over a reconstructed picture by blending; reads the same tables. Warm is fine, blue coarse.

struct Overlay {
    gaze: vec2f,
    gaze_radius: f32,
    heat: f32,
    borders: f32,
    unused: f32,
}

@group(0) @binding(5) var<uniform> marks: Overlay;

// Share of a pixel that a line of `width` covers whose middle is `away`, all in output pixels.
fn line(away: f32, width: f32) -> f32 {
    return clamp(0.5 * width + 0.5 - away, 0.0, 1.0);
}

// Output pixels to the nearest border of the tile that shows a place.
fn to_border(seen: SeenPlace) -> f32 {
    let shown = shown_in(seen.face, cell_at(seen.place));
    let tile = source_at(level_in(shown), seen.face, seen.place, shown);
    let away = seen_apart(seen.place, min(seen.place - tile.low, tile.high - seen.place));
    return min(away.x, away.y) / max(seen.footprint, 1.0);
}

// Red, green, blue and coverage of colour `over` on top of `under`, both with straight alpha.
fn over(under: vec4f, colour: vec3f, cover: f32) -> vec4f {
    let alpha = cover + under.a * (1.0 - cover);
    let sum = colour * cover + under.rgb * under.a * (1.0 - cover);
    return vec4f(sum / max(alpha, 0.001), alpha);
}

@fragment
fn overlay(@builtin(position) position: vec4f) -> @location(0) vec4f {
    var drawn = vec4f(0.0);
    let seen = seen_by(position.xy);
    if (seen.inside) {
        let own = scale_of(level_in(shown_in(seen.face, cell_at(seen.place))));
        let footprint = shown_footprint(seen.face, seen.place, seen.footprint, own);
        let level = level_of(footprint) / max(f32(tiles.coarsest), 1.0);
        drawn = over(drawn, ramp(level), marks.heat);
        drawn = over(drawn, vec3f(0.05), line(to_border(seen), 1.0) * marks.borders);
    }
    if (marks.gaze_radius > 0.0) {
        let away = abs(length(position.xy - marks.gaze) - marks.gaze_radius);
        drawn = over(drawn, vec3f(0.0), line(away, 4.0) * 0.6);
        drawn = over(drawn, vec3f(1.0), line(away, 2.0));
    }
    return drawn;
}
