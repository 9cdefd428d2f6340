//! Do signatures order units as pictures of all levels do?

use super::conditions::BenchConditions;
use super::place::{Extent, looking};
use super::row::{BenchRow, Turns};
use super::subject::Subject;
use crate::report::output;
use foveal_core::view::eye_view::EyeView;
use foveal_play::worth_both_ways;
use foveal_render::DrawDevice;

/// Where the eye looks, in degrees to the right and up.
const GAZES: [[f64; 2]; 3] = [[0.0, 0.0], [12.0, -7.0], [-9.0, 6.0]];
const SIZE: [u32; 2] = [960, 540];
const ACROSS_DEG: f64 = 60.0;

/// Rank correlation of what units are worth by signatures and footprints, and by pictures.
pub(super) fn worth(
    subject: &Subject,
    conditions: &BenchConditions,
) -> anyhow::Result<Vec<BenchRow>> {
    let DrawDevice::Gpu(gpu) = &conditions.drawing else {
        output::say("worth: levels are drawn by a GPU; give --renderer gpu");
        return Ok(Vec::new());
    };
    let view = EyeView {
        size: SIZE,
        ..Extent::of(subject).view(ACROSS_DEG)
    };
    let mut turns = Turns::default();
    let mut units = 0.0;
    for gaze in GAZES {
        let moment = looking(view, gaze);
        let [signatures, pictures] = worth_both_ways(&subject.file, gpu, &moment)?;
        let both = signatures.iter().zip(&pictures);
        // What neither sees is in any order.
        let seen = both.filter(|(a, b)| **a > 0.0 || **b > 0.0);
        let (signatures, pictures): (Vec<f64>, Vec<f64>) = seen.unzip();
        units = signatures.len() as f64;
        turns.ours.push(rank_correlation(&signatures, &pictures));
    }
    let what = "worth of units by signatures and by pictures, rank correlation, 3 gazes";
    let row = turns.row(&subject.name, what, "");
    Ok(vec![row.asked("ours >= 0.8").with("units", units)])
}

/// Spearman's rank correlation; equal values share the mean of their ranks.
fn rank_correlation(a: &[f64], b: &[f64]) -> f64 {
    let (a, b) = (ranks(a), ranks(b));
    let mean = (a.len() as f64 - 1.0) / 2.0;
    let together = |a: &[f64], b: &[f64]| -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - mean) * (b - mean)).sum()
    };
    together(&a, &b) / (together(&a, &a) * together(&b, &b)).sqrt()
}

fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let mut ranks = vec![0.0; values.len()];
    let mut begin = 0;
    for same in order.chunk_by(|a, b| values[*a] == values[*b]) {
        let rank = begin as f64 + (same.len() as f64 - 1.0) / 2.0;
        same.iter().for_each(|at| ranks[*at] = rank);
        begin += same.len();
    }
    ranks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rank_correlation_is_one_for_one_order_and_minus_one_for_the_other() {
        let a = [3.0, 1.0, 2.0, 10.0];
        assert_eq!(rank_correlation(&a, &[30.0, 10.0, 20.0, 30.5]), 1.0);
        assert_eq!(rank_correlation(&a, &a.map(|value| -value)), -1.0);
        assert!((rank_correlation(&[1.0, 1.0, 2.0], &[1.0, 2.0, 2.0]) - 0.5).abs() < 1e-12);
    }
}
