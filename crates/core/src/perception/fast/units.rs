//! What do the pixels of a row add to their units?
//!
//! Neighbours mostly share a unit: their values are added up in single precision, run by run, and
//! runs in double precision.

use crate::perception::importance::NO_UNIT;

/// Pixels whose ids are compared, or values added, together.
const LANES: usize = 16;

/// Adds `values[step] * factor` to `sums[step * units + unit]` for a row of pixels.
///
/// # Panics
/// When an id is neither below `units` nor [`NO_UNIT`].
#[inline(always)]
pub(super) fn add_row<'a>(
    values: impl Iterator<Item = &'a [f32]> + Clone,
    factor: &[f32],
    ids: &[u32],
    sums: &mut [f64],
    units: usize,
) {
    let mut start = 0;
    while start < ids.len() {
        let end = run_end(ids, start);
        if ids[start] != NO_UNIT {
            let unit = ids[start] as usize;
            assert!(unit < units, "an id of a unit");
            for (step, row) in values.clone().enumerate() {
                let sum = product_sum(&row[start..end], &factor[start..end]);
                sums[step * units + unit] += f64::from(sum);
            }
        }
        start = end;
    }
}

/// Where the run of equal ids that begins at `start` ends.
#[inline(always)]
fn run_end(ids: &[u32], start: usize) -> usize {
    let (id, rest) = (ids[start], &ids[start..]);
    let (chunks, _) = rest.as_chunks::<LANES>();
    let differs = |chunk: &[u32; LANES]| chunk.iter().fold(0, |any, other| any | (other ^ id)) != 0;
    let whole = chunks.iter().position(differs).unwrap_or(chunks.len()) * LANES;
    let more = rest[whole..].iter().position(|&other| other != id);
    more.map_or(ids.len(), |more| start + whole + more)
}

#[inline(always)]
fn product_sum(values: &[f32], factors: &[f32]) -> f32 {
    let (chunks, rest) = values.as_chunks::<8>();
    let (factor_chunks, factor_rest) = factors.as_chunks::<8>();
    let mut lanes = [0.0; 8];
    for (chunk, factor) in chunks.iter().zip(factor_chunks) {
        lanes = core::array::from_fn(|i| lanes[i] + chunk[i] * factor[i]);
    }
    let four: [f32; 4] = core::array::from_fn(|i| lanes[i] + lanes[i + 4]);
    let products = rest.iter().zip(factor_rest).map(|(a, b)| a * b);
    (four[0] + four[2]) + (four[1] + four[3]) + products.sum::<f32>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_any_length_add_up_pixel_by_pixel() {
        let lengths = [1, 2, 15, 16, 17, 40, 3, 64, 31];
        let ids: Vec<u32> = lengths
            .iter()
            .enumerate()
            .flat_map(|(run, &length)| {
                let id = if run % 4 == 2 {
                    NO_UNIT
                } else {
                    run as u32 % 3
                };
                vec![id; length]
            })
            .collect();
        let values: Vec<f32> = (0..ids.len()).map(|i| (i * i % 29) as f32 - 9.0).collect();
        let factor: Vec<f32> = (0..ids.len()).map(|i| (i % 7) as f32 * 0.5).collect();
        let mut expected = [0.0; 6];
        for ((&id, value), factor) in ids.iter().zip(&values).zip(&factor) {
            if id != NO_UNIT {
                expected[id as usize] += f64::from(value * factor);
                expected[3 + id as usize] -= f64::from(value * factor);
            }
        }
        let negative: Vec<f32> = values.iter().map(|v| -v).collect();
        let rows = [values.as_slice(), negative.as_slice()];
        let mut found = [0.0; 6];
        add_row(rows.into_iter(), &factor, &ids, &mut found, 3);
        // Small multiples of a half: every order of adding is exact.
        assert_eq!(found, expected);
    }
}
