//! Which quantiser brings a group to the bytes that it may take?
//!
//! Encoders steer their quantiser from frame to frame towards a bit rate. In a group of eight
//! frames that a fresh encoder codes, they have nothing to go by: up to 2.4 times the bytes asked
//! for were measured. So the group is coded at several fixed quantisers, and the finest that
//! fits is
//! taken: all frames of a group are of one quality, and the bytes are never more than asked for
//! unless the coarsest quantiser takes them.

/// Quantiser steps in which bytes halve, about, in all codecs: the first guess only.
const STEPS_A_HALVING: f64 = 7.0;

/// What `code` gives for the finest quantiser of 0 to `coarsest` that takes at most `budget` bytes,
/// or for the coarsest.
///
/// Assumes that bytes fall as quantisers rise; where they do not, still one that fits.
pub(crate) fn finest_that_fits<E>(
    coarsest: u8,
    budget: usize,
    mut code: impl FnMut(u8) -> Result<Vec<Vec<u8>>, E>,
) -> Result<Vec<Vec<u8>>, E> {
    // All below `low` take too much; `best` is of `high` where it fits.
    let (mut low, mut high) = (0, coarsest);
    let mut best = None;
    let mut guess = coarsest / 2;
    let mut turn = 0;
    while low < high {
        let units = code(guess)?;
        let bytes: usize = units.iter().map(Vec::len).sum();
        if bytes <= budget {
            high = guess;
            best = Some(units);
        } else {
            low = guess + 1;
        }
        let step = (bytes as f64 / budget.max(1) as f64).log2() * STEPS_A_HALVING;
        let aimed = f64::from(guess) + step.clamp(-64.0, 64.0);
        // Half way at least every second time, or an unusual curve is walked along step by step.
        turn += 1;
        guess = match low.checked_add(high).map(|sum| sum / 2) {
            Some(middle) if turn % 2 == 0 => middle,
            _ => (aimed as u8).clamp(low, high.saturating_sub(1).max(low)),
        };
    }
    match best {
        Some(units) => Ok(units),
        None => code(coarsest),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::convert::Infallible;

    proptest! {
        #[test]
        fn the_finest_that_fits_is_found(
            sizes in prop::collection::vec(1usize..100_000, 64),
            budget in 1usize..100_000,
        ) {
            let mut sizes = sizes;
            sizes.sort_unstable_by(|a, b| b.cmp(a));
            let mut runs = 0;
            let code = |q: u8| {
                runs += 1;
                Ok::<_, Infallible>(vec![vec![0; sizes[usize::from(q)]]])
            };
            let units = finest_that_fits(63, budget, code).unwrap();
            let wanted = sizes.iter().find(|size| **size <= budget).unwrap_or(&sizes[63]);
            prop_assert_eq!(units[0].len(), *wanted);
            prop_assert!(runs <= 14);
        }
    }

    #[test]
    fn a_curve_like_an_encoders_takes_a_handful_of_runs() {
        for halving in [5.0, 7.0, 10.0] {
            for budget in [500, 5_000, 50_000, 500_000] {
                let mut runs = 0;
                let code = |q: u8| {
                    runs += 1;
                    let bytes = 1e6 * (-f64::from(q) / halving).exp2();
                    Ok::<_, Infallible>(vec![vec![0; bytes as usize]])
                };
                finest_that_fits(63, budget, code).unwrap();
                assert!(runs <= 9, "{runs} runs, {halving}, {budget}");
            }
        }
    }
}
