// What does the eye resolve at a place of the picture?
//
// No formula of the eye is here: tables come from core. The twin is `perception/eye.rs` of core.

struct Eye {
    // Turns (column, row, 1) into a ray: right of, above and along the gaze.
    gaze_from_pixel: mat3x3f,
    // Weights of the terms of a step's value.
    acuity: f32,
    constant: f32,
    error: f32,
    popping: f32,
    // Seen contrast from which Weber's law holds, in thresholds.
    omega: f32,
    // Log2 of pixels per degree where a ray has length one.
    density_octave: f32,
    // Log2 of the display's highest frequency in cycles per degree.
    display_octave: f32,
    // What a pixel of value one counts where a ray has length one, in quanta of the sums.
    quanta: f32,
    // Largest size of a sum of pixels in quanta.
    most_quanta: f32,
    // 1 where a pixel counts by its square degrees.
    by_area: u32,
    // The chord from the gaze at which its table is an octave in, and its entries per octave.
    first_chord: f32,
    chords_per_octave: f32,
    // Log2 of the frequency that sensitivities begin at, and their entries per octave.
    first_octave: f32,
    entries_per_octave: f32,
    // Rows of `places` per octave, and by which share eccentricity grows from one to the next.
    rows_per_octave: f32,
    row_growth: f32,
}

@group(0) @binding(2) var<uniform> eye: Eye;
// Row of `places`, not whole, by the chord from the gaze.
@group(0) @binding(3) var<storage, read> row_from_chord: array<f32>;
// Rows of `COLUMNS`: octaves by which frequency is raised at the cortex; then the finest spacing
// that is resolved (degrees per cycle), by how far up the place lies from the gaze.
@group(0) @binding(4) var<storage, read> places: array<f32>;

const COLUMNS = 66u;
// Spacings to either side of the horizontal meridian.
const HALF_COLUMNS = 32.0;

struct Place {
    // Length of the ray at unit depth.
    distance: f32,
    octaves_raised: f32,
    // Degrees per cycle.
    spacing: f32,
}

// Row of `places` for a chord (twice the sine of half the angle) from the gaze.
fn row_at(chord: f32) -> f32 {
    let last = arrayLength(&row_from_chord) - 1u;
    let along = log2(1.0 + chord / eye.first_chord) * eye.chords_per_octave;
    let entry = min(u32(along), last - 1u);
    let share = min(along - f32(entry), 1.0);
    return mix(row_from_chord[entry], row_from_chord[entry + 1u], share);
}

// Column of the spacings for a direction across the gaze: squares of its upward part are evenly
// spaced, signed; at the gaze itself the horizontal meridian.
fn column_at(across: vec2f) -> f32 {
    let length_squared = dot(across, across);
    if (length_squared < 1e-12) {
        return HALF_COLUMNS;
    }
    let upward = across.y * abs(across.y) / length_squared;
    return HALF_COLUMNS * (1.0 + clamp(upward, -1.0, 1.0));
}

fn entry_at(row: u32, share: f32, column: u32) -> f32 {
    let near = row * COLUMNS + column;
    return mix(places[near], places[near + COLUMNS], share);
}

fn place_at(place: vec2f) -> Place {
    let ray = eye.gaze_from_pixel * vec3f(place, 1.0);
    let distance = length(ray);
    let direction = ray / distance;
    let along = row_at(length(direction - vec3f(0.0, 0.0, 1.0)));
    let row = min(u32(along), arrayLength(&places) / COLUMNS - 2u);
    // Rows are an even part of an octave apart; what they hold is all but linear between them.
    let share = (exp2((along - f32(row)) / eye.rows_per_octave) - 1.0) / eye.row_growth;
    let column = column_at(direction.xy);
    let left = min(u32(column), 2u * u32(HALF_COLUMNS) - 1u);
    // Between meridians squares of spacings are what is linear.
    let near = entry_at(row, share, left + 1u);
    let far = entry_at(row, share, left + 2u);
    let spacing = sqrt(mix(near * near, far * far, column - f32(left)));
    return Place(distance, entry_at(row, share, 0u), spacing);
}
