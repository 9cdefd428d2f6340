//! How alike is the structure of two pictures?
//!
//! Wang, Bovik, Sheikh and Simoncelli 2004, *Image quality assessment: from error visibility to
//! structural similarity*, Eq. 13, with the window of section III.C.

/// Samples on a side of the window.
const WINDOW: usize = 11;
/// Standard deviation of its Gaussian, samples.
const SIGMA: f64 = 1.5;
/// Keep the quotients finite, for a range of 1.
const C1: f64 = 0.01 * 0.01;
const C2: f64 = 0.03 * 0.03;

/// Sum of the similarities of all windows that lie inside, and their number: 0 of a picture
/// smaller than a window.
pub(super) fn ssim(a: &[f64], b: &[f64], [w, h]: [usize; 2]) -> [f64; 2] {
    if w < WINDOW || h < WINDOW {
        return [0.0; 2];
    }
    let weights = window();
    // Means, squares and product, summed along the rows first.
    let mut along = vec![[0.0; 5]; (w - WINDOW + 1) * h];
    for (at, sums) in along.iter_mut().enumerate() {
        let first = at / (w - WINDOW + 1) * w + at % (w - WINDOW + 1);
        for (k, weight) in weights.iter().enumerate() {
            let (x, y) = (a[first + k], b[first + k]);
            for (sum, term) in sums.iter_mut().zip([x, y, x * x, y * y, x * y]) {
                *sum += weight * term;
            }
        }
    }
    let columns = w - WINDOW + 1;
    let mut total = 0.0;
    for at in 0..columns * (h - WINDOW + 1) {
        let mut sums = [0.0; 5];
        for (k, weight) in weights.iter().enumerate() {
            for (sum, term) in sums.iter_mut().zip(along[at + k * columns]) {
                *sum += weight * term;
            }
        }
        total += window_similarity(sums);
    }
    [total, (columns * (h - WINDOW + 1)) as f64]
}

fn window_similarity([a, b, aa, bb, ab]: [f64; 5]) -> f64 {
    let (variances, covariance) = (aa - a * a + bb - b * b, ab - a * b);
    (2.0 * a * b + C1) * (2.0 * covariance + C2) / ((a * a + b * b + C1) * (variances + C2))
}

fn window() -> [f64; WINDOW] {
    let middle = (WINDOW / 2) as f64;
    let raw: [f64; WINDOW] = std::array::from_fn(|k| {
        let apart = (k as f64 - middle) / SIGMA;
        (-apart * apart / 2.0).exp()
    });
    let sum: f64 = raw.iter().sum();
    raw.map(|weight| weight / sum)
}
