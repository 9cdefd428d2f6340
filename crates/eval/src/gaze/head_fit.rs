//! Which saturating curve follows given recordings best?
//!
//! The one with the least mean angle to the true gaze. Newton's method on that sum, each row
//! weighted by the inverse of its error (iteratively reweighted least squares, so that rows far
//! off pull no harder than near ones), damped (Levenberg-Marquardt), from a steep and a wide start.
//! Deterministic; about a second for an hour of recording.

use super::angle_statistics::mean;
use super::head_recording::{HeadRecording, HeadRow};
use foveal_core::gaze::head_prediction::GazeInHead;
use foveal_core::gaze::head_prediction::saturating::{
    AxisCurve, HeadGazePreset, LINEAR_AT_DEG_S, MOST_ACCELERATION_DEG_S2,
};
use glam::DVec3;

/// Most rows that a fit looks at; more are thinned evenly.
const MOST_ROWS: usize = 24_000;
/// Parameters: five of each axis.
const COUNT: usize = 10;
/// Most steps from one start.
const MOST_STEPS: usize = 60;
/// A step that gains less than this share of the loss is the last.
const LEAST_GAIN: f64 = 1e-7;
/// Errors below this weigh like this one, in radians (0.25 degrees).
const LEAST_ERROR: f64 = 0.004;

/// What recordings teach: a law, and the mean gaze as its simplest rival.
#[derive(Clone, Debug, PartialEq)]
pub struct HeadFit {
    /// The law, with its spread.
    pub preset: HeadGazePreset,
    /// The mean gaze.
    pub mean: GazeInHead,
}

impl HeadFit {
    /// Mean gaze of the recordings behind [`HeadGazePreset::free_viewing`].
    const SHIPPED_MEAN: GazeInHead = GazeInHead {
        yaw_deg: 1.26,
        pitch_deg: -3.02,
    };

    /// A preset that is not fitted here, with the mean gaze that ships.
    #[must_use]
    pub fn shipped(preset: HeadGazePreset) -> Self {
        Self {
            preset,
            mean: Self::SHIPPED_MEAN,
        }
    }
}

/// The law of least mean angle over all rows, and their mean gaze. Cost: some milliseconds for each
/// thousand of at most 24,000 rows.
///
/// # Panics
/// Of no recording.
#[must_use]
pub fn fit_head(recordings: &[&HeadRecording]) -> HeadFit {
    let all = || recordings.iter().flat_map(|recording| recording.rows());
    let count = all().count();
    assert!(count > 0, "a fit needs a recording");
    let rows: Vec<HeadRow> = all().step_by(count.div_ceil(MOST_ROWS)).copied().collect();
    let starts = [HeadGazePreset::free_viewing(), HeadGazePreset::search()];
    let fits = starts.map(|start| descend(&rows, start));
    let [steep, wide] = fits;
    let (_, mut preset) = if wide.0 < steep.0 { wide } else { steep };
    preset.name = "fitted".to_owned();
    preset.spread_deg = spread_deg(&rows, &preset).clamp(0.1, 60.0);
    let mean_of = |axis: usize| {
        mean(
            &all()
                .map(|row| row.gaze.degrees()[axis])
                .collect::<Vec<_>>(),
        )
    };
    HeadFit {
        preset,
        mean: GazeInHead::within_reach([mean_of(0), mean_of(1)]),
    }
}

/// Standard deviation along any axis: root mean square angle over the square root of two.
fn spread_deg(rows: &[HeadRow], preset: &HeadGazePreset) -> f64 {
    let square = |row: &HeadRow| {
        let angle = preset.predict(&row.head.motion).angle_to(row.gaze);
        angle.to_degrees() * angle.to_degrees()
    };
    (rows.iter().map(square).sum::<f64>() / rows.len() as f64 / 2.0).sqrt()
}

/// Damped steps from a start to where no step gains; the loss there and the law.
fn descend(rows: &[HeadRow], start: HeadGazePreset) -> (f64, HeadGazePreset) {
    let mut best = start;
    let mut loss = loss_of(rows, &best);
    let mut damping = 1e-3;
    for _ in 0..MOST_STEPS {
        let (curvature, downhill) = normal_equations(rows, &best);
        let mut gained = 0.0;
        while gained <= 0.0 && damping < 1e6 {
            let tried = moved(&best, &solve(curvature, downhill, damping));
            let its_loss = loss_of(rows, &tried);
            gained = loss - its_loss;
            if gained > 0.0 {
                (best, loss) = (tried, its_loss);
                damping = (damping * 0.3).max(1e-9);
            } else {
                damping *= 4.0;
            }
        }
        if gained <= LEAST_GAIN * loss {
            break;
        }
    }
    (loss, best)
}

/// Mean angle in degrees.
fn loss_of(rows: &[HeadRow], preset: &HeadGazePreset) -> f64 {
    let angle = |row: &HeadRow| {
        preset
            .predict(&row.head.motion)
            .angle_to(row.gaze)
            .to_degrees()
    };
    rows.iter().map(angle).sum::<f64>() / rows.len() as f64
}

/// Curvature and downhill direction of the reweighted sum of squared distances between directions.
fn normal_equations(
    rows: &[HeadRow],
    preset: &HeadGazePreset,
) -> ([[f64; COUNT]; COUNT], [f64; COUNT]) {
    let mut below = [[0.0; COUNT]; COUNT];
    let mut downhill = [0.0; COUNT];
    for row in rows {
        let predicted = preset.predict(&row.head.motion);
        let error = row.gaze.direction_in_head() - predicted.direction_in_head();
        let weight = 1.0 / error.length().max(LEAST_ERROR);
        let turns = turns(predicted);
        let slopes = [slopes(&preset.yaw, row, 0), slopes(&preset.pitch, row, 1)];
        let column = |k: usize| turns[k / 5] * slopes[k / 5][k % 5];
        let columns: [DVec3; COUNT] = core::array::from_fn(column);
        for (a, left) in columns.iter().enumerate() {
            downhill[a] += weight * left.dot(error);
            for (b, right) in columns.iter().enumerate().take(a + 1) {
                below[a][b] += weight * left.dot(*right);
            }
        }
    }
    let mirrored = |a: usize, b: usize| below[a.max(b)][a.min(b)];
    let curvature = core::array::from_fn(|a| core::array::from_fn(|b| mirrored(a, b)));
    (curvature, downhill)
}

/// How the direction turns with yaw and pitch, per degree.
fn turns(gaze: GazeInHead) -> [DVec3; 2] {
    let [x, y] = gaze.degrees().map(|degrees| degrees.to_radians().tan());
    let direction = DVec3::new(x, y, -1.0);
    let length = direction.length();
    let unit = direction / length;
    [(DVec3::X, x), (DVec3::Y, y)].map(|(axis, tangent)| {
        let along = axis * (1.0 + tangent * tangent).to_radians() / length;
        along - unit * along.dot(unit)
    })
}

/// Derivatives of one axis' gaze by gain, logarithm of the scale, linear part, offset and lead.
fn slopes(curve: &AxisCurve, row: &HeadRow, axis: usize) -> [f64; 5] {
    let motion = &row.head.motion;
    let drive = curve.drive(motion, axis);
    let reduced = drive / curve.scale_deg_s;
    let tanh = reduced.tanh();
    let bend = curve.gain_deg * (1.0 - tanh * tanh);
    let by_drive = bend / curve.scale_deg_s + curve.linear_deg / LINEAR_AT_DEG_S;
    let most = MOST_ACCELERATION_DEG_S2;
    [
        tanh,
        -bend * reduced,
        drive / LINEAR_AT_DEG_S,
        1.0,
        by_drive * motion.mean_acceleration_deg_s2[axis].clamp(-most, most),
    ]
}

/// The preset one step on, each parameter in its range.
fn moved(preset: &HeadGazePreset, step: &[f64; COUNT]) -> HeadGazePreset {
    let axis = |curve: &AxisCurve, step: &[f64]| {
        let held = |k: usize, value: f64| {
            let [least, most] = AxisCurve::RANGES[k].1;
            value.clamp(least, most)
        };
        AxisCurve {
            gain_deg: held(0, curve.gain_deg + step[0]),
            scale_deg_s: held(1, curve.scale_deg_s * step[1].clamp(-1.0, 1.0).exp()),
            linear_deg: held(2, curve.linear_deg + step[2]),
            offset_deg: held(3, curve.offset_deg + step[3]),
            lead_s: held(4, curve.lead_s + step[4]),
        }
    };
    HeadGazePreset {
        yaw: axis(&preset.yaw, &step[..5]),
        pitch: axis(&preset.pitch, &step[5..]),
        ..preset.clone()
    }
}

/// Solves for the step, the diagonal raised by the damping; by elimination, as the matrix is
/// positive definite with it. A parameter that nothing depends on stays.
fn solve(mut matrix: [[f64; COUNT]; COUNT], mut right: [f64; COUNT], damping: f64) -> [f64; COUNT] {
    for (k, row) in matrix.iter_mut().enumerate() {
        row[k] += damping * row[k] + 1e-12;
    }
    for k in 0..COUNT {
        let pivot = matrix[k];
        for below in k + 1..COUNT {
            let share = matrix[below][k] / pivot[k];
            for (value, from) in matrix[below].iter_mut().zip(pivot) {
                *value -= share * from;
            }
            right[below] -= share * right[k];
        }
    }
    let mut step = [0.0; COUNT];
    for k in (0..COUNT).rev() {
        let known: f64 = (k + 1..COUNT).map(|j| matrix[k][j] * step[j]).sum();
        step[k] = (right[k] - known) / matrix[k][k];
    }
    step
}

#[cfg(test)]
mod tests {
    use super::super::synthetic_viewer::viewer;
    use super::*;

    fn other_law() -> HeadGazePreset {
        let mut law = HeadGazePreset::search();
        law.yaw.gain_deg = 8.0;
        law.yaw.offset_deg = -3.0;
        law.yaw.lead_s = 0.15;
        law.pitch.scale_deg_s = 4.0;
        law
    }

    fn fitted(law: &HeadGazePreset, noise_deg: f64, seeds: core::ops::Range<u64>) -> HeadFit {
        let recordings: Vec<HeadRecording> =
            seeds.map(|seed| viewer(law, noise_deg, seed)).collect();
        fit_head(&recordings.iter().collect::<Vec<_>>())
    }

    #[test]
    fn a_law_without_noise_is_found_again() {
        for law in [other_law(), HeadGazePreset::free_viewing()] {
            let found = fitted(&law, 0.0, 1..3).preset;
            for (found, law) in [(found.yaw, law.yaw), (found.pitch, law.pitch)] {
                for (found, law) in found.parameters().into_iter().zip(law.parameters()) {
                    assert!(
                        (found - law).abs() < 0.02 * law.abs().max(1.0),
                        "{found} {law}"
                    );
                }
            }
        }
    }

    #[test]
    fn no_small_change_of_a_fit_is_better_on_its_rows() {
        let recording = viewer(&other_law(), 3.0, 4);
        let fit = fit_head(&[&recording]).preset;
        let best = loss_of(recording.rows(), &fit);
        for k in 0..COUNT {
            for sign in [-1.0, 1.0] {
                let mut step = [0.0; COUNT];
                step[k] = sign * if k % 5 == 4 { 0.02 } else { 0.3 };
                let loss = loss_of(recording.rows(), &moved(&fit, &step));
                assert!(loss > best - 1e-3, "{k} {sign}: {loss} {best}");
            }
        }
    }

    #[test]
    fn rows_far_off_pull_no_harder_than_near_ones() {
        let law = other_law();
        let clean = viewer(&law, 0.5, 1);
        let mut rows = clean.rows().to_vec();
        for row in rows.iter_mut().skip(7).step_by(10) {
            row.gaze = GazeInHead::within_reach([40.0, 30.0]);
        }
        let fit = fit_head(&[&HeadRecording::new(rows).unwrap()]).preset;
        assert!(
            (fit.yaw.offset_deg - law.yaw.offset_deg).abs() < 0.7,
            "{fit:?}"
        );
        assert!(
            (fit.pitch.offset_deg - law.pitch.offset_deg).abs() < 0.7,
            "{fit:?}"
        );
    }

    #[test]
    fn a_fit_is_the_same_every_time_and_in_range() {
        let [a, b] = [0, 1].map(|_| fitted(&other_law(), 4.0, 1..3));
        assert_eq!(a, b);
        assert!(a.preset.checked().is_ok());
        let still = HeadRow {
            gaze: GazeInHead::within_reach([3.0, -1.0]),
            head: Default::default(),
        };
        let fit = fit_head(&[&HeadRecording::new(vec![still]).unwrap()]).preset;
        let gaze = fit.predict(&still.head.motion);
        assert!(gaze.angle_to(still.gaze).to_degrees() < 0.1, "{gaze:?}");
        assert!(fit.checked().is_ok());
    }

    #[test]
    fn more_noise_is_more_spread() {
        let [calm, wild] = [1.0, 5.0].map(|noise| fitted(&other_law(), noise, 1..3).preset);
        assert!(calm.spread_deg < 0.4 * wild.spread_deg);
    }
}
