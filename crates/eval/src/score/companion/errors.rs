//! How far apart are the samples of two pictures?

use crate::score::picture::{Samples, ScorePicture};

impl ScorePicture {
    /// How many pixels it has.
    pub(super) fn samples_of_one(&self) -> usize {
        self.size()[0] as usize * self.size()[1] as usize
    }
}

/// Sum of squares over all samples of a range of 1, and their number.
pub(super) fn squared_errors(reference: &ScorePicture, test: &ScorePicture) -> [f64; 2] {
    if let (Samples::Bits8(a), Samples::Bits8(b)) = (reference.samples(), test.samples()) {
        let squares = a
            .iter()
            .zip(b)
            .map(|(a, b)| u64::from(a.abs_diff(*b)).pow(2));
        return [
            squares.sum::<u64>() as f64 / (255.0 * 255.0),
            a.len() as f64,
        ];
    }
    let pixels = reference.samples_of_one();
    let sum = (0..pixels).map(|at| pixel_error(reference, test, at)).sum();
    [sum, pixels as f64 * 3.0]
}

/// Sum of squares over the three samples of a pixel.
pub(super) fn pixel_error(reference: &ScorePicture, test: &ScorePicture, at: usize) -> f64 {
    let pairs = reference.rgb(at).into_iter().zip(test.rgb(at));
    pairs.map(|(a, b)| (a - b) * (a - b)).sum()
}

/// Weighed sum of squares of luma, and the sum of weights.
pub(super) fn luma_errors(
    reference: &ScorePicture,
    test: &ScorePicture,
    weight: impl Fn(usize) -> f64,
) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for at in 0..reference.samples_of_one() {
        let (apart, weight) = (reference.luma(at) - test.luma(at), weight(at));
        sums[0] += weight * apart * apart;
        sums[1] += weight;
    }
    sums
}
