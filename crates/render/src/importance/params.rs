//! Which numbers do the passes of importance need?
//!
//! The structs here have the layout of the WGSL structs whose names lack the `Params`;
//! `tests/shaders.rs` compares them.

use super::tables::{CHORDS_PER_OCTAVE, FIRST_CHORD, ROWS_PER_OCTAVE};
use bytemuck::{Pod, Zeroable};
use foveal_core::perception::gain::Weights;
use foveal_core::perception::importance::Onlooker;
use foveal_core::perception::measures::pyramid::{band_frequency, band_gain, half_size};
use foveal_core::perception::parameters::Parameters;
use foveal_core::perception::sensitivity_table::SensitivityTable;
use foveal_core::units::{Ppd, Radians};
use foveal_core::view::axes::{Axes, yaw_pitch_from_direction};
use glam::{DMat3, DVec3};

/// Where the texels of a band are.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct BandParams {
    /// Columns and rows.
    pub fine: [u32; 2],
    /// Columns and rows of the next coarser level.
    pub coarse: [u32; 2],
    /// Columns and rows of the whole picture.
    pub picture: [f32; 2],
    /// Pixels on a side of a texel.
    pub side: f32,
    /// 1 / what the filters leave of a grating at the band's centre.
    pub contrast_scale: f32,
    /// Log2 of the band's frequency in cycles per degree at one pixel per degree.
    pub octave: f32,
    /// 0 for the coarsest band, else 1.
    pub has_coarser: u32,
}

impl BandParams {
    /// The band `index` of `bands`, of a picture of `picture` pixels.
    #[must_use]
    pub(crate) fn new(picture: [u32; 2], index: usize, bands: usize) -> Self {
        let fine = (0..index).fold(picture, |size, _| half_size(size));
        Self {
            fine,
            coarse: half_size(fine),
            picture: picture.map(|side| side as f32),
            side: (1_u32 << index) as f32,
            contrast_scale: (1.0 / band_gain(index)) as f32,
            octave: band_frequency(index, Ppd(1.0)).0.log2() as f32,
            has_coarser: u32::from(index + 1 < bands),
        }
    }
}

/// Who looks, and what is worth how much to them.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct EyeParams {
    /// Columns of the matrix that turns (column, row, 1) into a ray: right of, above and along the
    /// gaze.
    pub gaze_from_pixel: [[f32; 4]; 3],
    /// Weight of acuity in cycles per degree.
    pub acuity: f32,
    /// Weight of one, for every pixel.
    pub constant: f32,
    /// Weight of visible error removed.
    pub error: f32,
    /// Weight of popping.
    pub popping: f32,
    /// Seen contrast from which Weber's law holds, in thresholds.
    pub omega: f32,
    /// Log2 of pixels per degree where a ray has length one.
    pub density_octave: f32,
    /// Log2 of the display's highest frequency in cycles per degree.
    pub display_octave: f32,
    /// What a pixel of value one counts where a ray has length one, in quanta of the sums.
    pub quanta: f32,
    /// Largest size of a sum of pixels in quanta.
    pub most_quanta: f32,
    /// 1 where a pixel counts by its square degrees.
    pub by_area: u32,
    /// The chord from the gaze at which its table is an octave in.
    pub first_chord: f32,
    /// Entries per octave of that table.
    pub chords_per_octave: f32,
    /// Log2 of the frequency that sensitivities begin at.
    pub first_octave: f32,
    /// Entries per octave of sensitivities.
    pub entries_per_octave: f32,
    /// Rows of places per octave of eccentricity.
    pub rows_per_octave: f32,
    /// By which share eccentricity grows from one row to the next.
    pub row_growth: f32,
}

/// Frequencies that no display shows less than, in octaves of cycles per degree.
const NO_LIMIT_OCTAVES: f64 = 64.0;
/// Factor between the value of a pixel that changes as much as black and white do, and the largest
/// that a pixel may have: sums keep room for that many bits.
const HEADROOM_BITS: i32 = 11;

impl EyeParams {
    /// The eye of `onlooker`. `most_seen` is the highest sensitivity, sustained and transient.
    ///
    /// Returns what one quantum of the sums is worth, too: a power of two.
    #[must_use]
    pub(crate) fn new(
        onlooker: &Onlooker,
        parameters: &Parameters,
        most_seen: [f64; 2],
    ) -> (Self, f64) {
        let weights = parameters.weights(onlooker.state);
        let ahead = onlooker.spot(axis_place(onlooker));
        let area = if weights.by_area {
            1.0 / (ahead.ppd.0 * ahead.ppd.0)
        } else {
            1.0
        };
        let [w, h] = onlooker.view.size.map(f64::from);
        // The largest sum of all pixels stays below 2^62 quanta.
        let sum_bits = 62 - (w * h).log2().ceil() as i32;
        let most = area * largest_value(&weights, parameters, most_seen);
        let most = if most > 0.0 { most } else { 1.0 };
        let quantum = f64::exp2(most.log2().ceil() - f64::from(sum_bits - HEADROOM_BITS));
        let limit = parameters.display_limit().0.log2();
        let eye = Self {
            gaze_from_pixel: gaze_from_pixel(onlooker),
            acuity: weights.acuity as f32,
            constant: weights.constant as f32,
            error: weights.error as f32,
            popping: weights.popping as f32,
            omega: parameters.omega as f32,
            density_octave: ahead.ppd.0.log2() as f32,
            display_octave: limit.min(NO_LIMIT_OCTAVES) as f32,
            quanta: (area / quantum) as f32,
            most_quanta: f64::exp2(f64::from(sum_bits)) as f32,
            by_area: u32::from(weights.by_area),
            first_chord: FIRST_CHORD as f32,
            chords_per_octave: CHORDS_PER_OCTAVE as f32,
            first_octave: SensitivityTable::FIRST_OCTAVE as f32,
            entries_per_octave: SensitivityTable::PER_OCTAVE as f32,
            rows_per_octave: ROWS_PER_OCTAVE as f32,
            row_growth: ((1.0 / ROWS_PER_OCTAVE).exp2() - 1.0) as f32,
        };
        (eye, quantum)
    }
}

/// The place in the picture (or outside it) that the view's axis goes through.
fn axis_place(onlooker: &Onlooker) -> [f64; 2] {
    let (field, [w, h]) = (onlooker.view.field, onlooker.view.size.map(f64::from));
    [
        field.left / (field.left + field.right) * w,
        field.up / (field.up + field.down) * h,
    ]
}

/// Value of a pixel at the gaze whose contrast comes up from nothing to one.
fn largest_value(weights: &Weights, parameters: &Parameters, most_seen: [f64; 2]) -> f64 {
    let [sustained, transient] = most_seen;
    let acuity = parameters.acuity_model().best_acuity(Radians(0.0)).0;
    weights.acuity.abs() * acuity
        + weights.constant.abs()
        + weights.error.abs() * sustained
        + weights.popping.abs() * transient / parameters.omega
}

fn gaze_from_pixel(onlooker: &Onlooker) -> [[f32; 4]; 3] {
    let (yaw, pitch) = yaw_pitch_from_direction(onlooker.gaze.direction);
    let gaze = Axes::from_yaw_pitch_roll(yaw, pitch, Radians(0.0));
    let gaze_from_world = DMat3::from_cols(gaze.right, -gaze.down, gaze.forward).transpose();
    let m = gaze_from_world * onlooker.view.ray_from_pixel();
    let column = |c: DVec3| [c.x as f32, c.y as f32, c.z as f32, 0.0];
    [m.x_axis, m.y_axis, m.z_axis].map(column)
}
