//! How does a picture fall into levels, each half the one before, and grow back?
//!
//! Burt and Adelson 1983, *The Laplacian pyramid as a compact image code*, with a = 0.4.

use super::rules::Border;

/// The kernel, along one axis.
pub const KERNEL: [f64; 5] = [0.05, 0.25, 0.4, 0.25, 0.05];

/// A picture of one number a pixel, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Plane {
    /// Columns and rows, at least one each.
    pub size: [usize; 2],
    /// Row by row.
    pub values: Vec<f64>,
}

/// Columns and rows of the next coarser level.
#[must_use]
pub fn half_size(size: [usize; 2]) -> [usize; 2] {
    size.map(|side| side.div_ceil(2))
}

/// The index from which a side of `length` samples is read at `index`, half-sample symmetric:
/// .. 1 0 | 0 1 .. n-1 | n-1 n-2 ..
#[must_use]
pub fn mirrored(index: isize, length: usize) -> usize {
    let last = length as isize - 1;
    let inside = if index < 0 { -1 - index } else { index };
    let inside = if inside > last {
        2 * last + 1 - inside
    } else {
        inside
    };
    inside.clamp(0, last) as usize
}

/// How many samples beyond the right border the last column's sum takes in: 2 where the number that
/// decides is odd, else 1.
#[must_use]
pub fn samples_beyond(size: [usize; 2], border: Border) -> usize {
    let decides = match border {
        Border::ByRows => size[1],
        Border::ByColumns => size[0],
    };
    1 + decides % 2
}

/// The next coarser level: rows first, then columns.
#[must_use]
pub fn reduced(fine: &Plane, border: Border) -> Plane {
    let ([w, h], size) = (fine.size, half_size(fine.size));
    let upright: Vec<f64> = (0..size[1] * w)
        .map(|at| {
            let (x, y) = (at % w, at / w);
            weighed(|tap| fine.values[mirrored(2 * y as isize + tap, h) * w + x])
        })
        .collect();
    let beyond = samples_beyond(fine.size, border);
    let values = (0..size[1] * size[0])
        .map(|at| {
            let (x, y) = (at % size[0], at / size[0]);
            let row = &upright[y * w..][..w];
            if x + 1 == size[0] {
                return last_column(row, beyond);
            }
            weighed(|tap| row[mirrored(2 * x as isize + tap, w)])
        })
        .collect();
    Plane { size, values }
}

fn weighed(sample: impl Fn(isize) -> f64) -> f64 {
    let taps = KERNEL.iter().zip(-2..);
    taps.map(|(weight, tap)| weight * sample(tap)).sum()
}

/// The sum at the last column of a halved row: what lies inside, and what `beyond` samples outside
/// repeat of the border.
fn last_column(row: &[f64], beyond: usize) -> f64 {
    let w = row.len();
    let middle = (2 * (w.div_ceil(2) - 1)) as isize;
    let inside: f64 = KERNEL
        .iter()
        .zip(-2..)
        .filter(|(_, tap)| middle + tap < w as isize)
        .map(|(weight, tap)| weight * row[mirrored(middle + tap, w)])
        .sum();
    let last = row[w - 1];
    inside
        + if beyond == 2 {
            KERNEL[3] * last + KERNEL[4] * row[w.saturating_sub(2)]
        } else {
            KERNEL[4] * last
        }
}

/// The next finer level of `size`: samples of `coarse` with zeros between, convolved with twice the
/// kernel on each axis, the border repeated.
#[must_use]
pub fn expanded(coarse: &Plane, size: [usize; 2]) -> Plane {
    assert_eq!(half_size(size), coarse.size, "a level and its half");
    let [w, h] = coarse.size;
    let near = |index: isize, length: usize| index.clamp(0, length as isize - 1) as usize;
    let upright: Vec<f64> = (0..size[1] * w)
        .map(|at| {
            let (x, y) = (at % w, (at / w) as isize);
            between(y, |index| coarse.values[near(index, h) * w + x])
        })
        .collect();
    let values = (0..size[1] * size[0])
        .map(|at| {
            let (x, y) = ((at % size[0]) as isize, at / size[0]);
            between(x, |index| upright[y * w + near(index, w)])
        })
        .collect();
    Plane { size, values }
}

fn between(fine: isize, sample: impl Fn(isize) -> f64) -> f64 {
    let at = fine / 2;
    if fine % 2 == 0 {
        2.0 * (KERNEL[0] * sample(at - 1) + KERNEL[2] * sample(at) + KERNEL[4] * sample(at + 1))
    } else {
        2.0 * (KERNEL[1] * sample(at) + KERNEL[3] * sample(at + 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane(size: [usize; 2], value: impl Fn(usize, usize) -> f64) -> Plane {
        let values = (0..size[0] * size[1])
            .map(|at| value(at % size[0], at / size[0]))
            .collect();
        Plane { size, values }
    }

    #[test]
    fn what_is_even_stays_even() {
        for size in [[16, 16], [17, 15], [1, 1], [2, 3]] {
            let coarse = reduced(&plane(size, |_, _| 7.0), Border::ByColumns);
            let fine = expanded(&coarse, size);
            for value in coarse.values.iter().chain(&fine.values) {
                assert!((value - 7.0).abs() < 1e-12, "{size:?}: {value}");
            }
        }
    }

    #[test]
    fn the_borders_differ_where_rows_and_columns_differ_in_parity_alone() {
        for (size, differ) in [
            ([16, 16], false),
            ([15, 17], false),
            ([16, 15], true),
            ([15, 16], true),
        ] {
            let fine = plane(size, |x, y| (x * 3 + y) as f64);
            let [rows, columns] = [Border::ByRows, Border::ByColumns].map(|b| reduced(&fine, b));
            assert_eq!(rows != columns, differ, "{size:?}");
            let w = rows.size[0];
            let inside = |plane: &Plane| -> Vec<f64> {
                let all = plane.values.iter().enumerate();
                all.filter(|(at, _)| at % w + 1 < w)
                    .map(|(_, v)| *v)
                    .collect()
            };
            assert_eq!(inside(&rows), inside(&columns));
        }
    }

    #[test]
    fn the_last_column_has_the_sum_that_its_border_asks_for() {
        // Columns 0 to 3 in 15 equal rows: by columns one sample is repeated, by rows two.
        let fine = plane([4, 15], |x, _| [2.0, 3.0, 5.0, 11.0][x]);
        let inside = 0.05 * 2.0 + 0.25 * 3.0 + 0.4 * 5.0 + 0.25 * 11.0;
        let right = inside + 0.05 * 11.0;
        let published = inside + 0.25 * 11.0 + 0.05 * 5.0;
        assert!((reduced(&fine, Border::ByColumns).values[1] - right).abs() < 1e-12);
        assert!((reduced(&fine, Border::ByRows).values[1] - published).abs() < 1e-12);
    }
}
