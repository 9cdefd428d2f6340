//! What does the next coarser level of an equirectangular picture look like?
//!
//! Its sides close to a turn and a pole lies between opposite columns, so that no border repeats.
//! And a texel near a pole is a sliver, many to the width of one in the middle: a row is averaged
//! along itself over as much as its texels are high, or a coarse level would be a star there, sharp
//! around the pole and not towards it.

use crate::parallel::in_parallel;
use crate::prepare::pyramid::halve_all;
use foveal_core::perception::measures::luma_light::LumaLight;
use foveal_core::view::picture::{Colour, Picture};
use std::f64::consts::PI;

/// Luma pixels that a picture is continued by: what a halving reaches, on chroma too, and a
/// multiple of 4, so that chroma of the half stays on its luma.
const MARGIN: u32 = 8;

/// Rows are averaged where the height of a texel is more than this many of its widths.
const LEAST_WIDTHS: f64 = 1.25;

/// The level that is `ratio` times coarser, 2 or 4, of each picture; as [`halve_all`], but closed
/// and averaged towards the poles. The same for any number of threads.
pub(super) fn halve_spheres(
    pictures: &[Picture],
    ratio: u32,
    colour: Colour,
    jobs: usize,
) -> Vec<Picture> {
    let mut coarse = pictures.to_vec();
    for _ in 0..ratio.trailing_zeros() {
        let size = [coarse[0].width, coarse[0].height].map(|side| side.div_ceil(2));
        let continued = in_parallel(jobs, coarse.len(), |k| continued(&coarse[k]));
        let halves = halve_all(&continued, 2, colour, jobs);
        coarse = in_parallel(jobs, halves.len(), |k| {
            halves[k].crop([MARGIN / 2; 2], size)
        });
        average_rows(&mut coarse, colour, jobs);
    }
    coarse
}

/// The picture with what lies beyond its borders.
fn continued(picture: &Picture) -> Picture {
    let planes = [0, 1, 2].map(|p| {
        let [w, h] = picture.plane_size(p).map(i64::from);
        let margin = i64::from(MARGIN) >> u32::from(p > 0);
        let mut plane = Vec::with_capacity(((w + 2 * margin) * (h + 2 * margin)) as usize);
        for y in -margin..h + margin {
            let is_over_pole = !(0..h).contains(&y);
            let folded = if y < 0 { -1 - y } else { 2 * h - 1 - y };
            let y = if is_over_pole { folded } else { y }.clamp(0, h - 1);
            let turned = if is_over_pole { w / 2 } else { 0 };
            let row = &picture.planes[p][(y * w) as usize..][..w as usize];
            let mut from = (turned - margin).rem_euclid(w) as usize;
            let mut left = (w + 2 * margin) as usize;
            while left > 0 {
                let some = &row[from..][..left.min(row.len() - from)];
                plane.extend_from_slice(some);
                (from, left) = (0, left - some.len());
            }
        }
        plane
    });
    Picture {
        width: picture.width + 2 * MARGIN,
        height: picture.height + 2 * MARGIN,
        planes,
    }
}

/// Averages every row along itself over the height of a texel: luma as light.
fn average_rows(pictures: &mut [Picture], colour: Colour, jobs: usize) {
    let table = LumaLight::of(colour);
    let rows_of = |(k, picture): (usize, &Picture)| {
        let rows = (0..3).flat_map(|p| {
            let [w, h] = picture.plane_size(p).map(f64::from);
            let row = move |y: u32| {
                let level = libm::sin((f64::from(y) + 0.5) / h * PI);
                let widths = w / (2.0 * h * level);
                (widths >= LEAST_WIDTHS).then_some((k, p, y as usize, widths))
            };
            (0..h as u32).filter_map(row).collect::<Vec<_>>()
        });
        rows.collect::<Vec<_>>()
    };
    let rows: Vec<_> = pictures.iter().enumerate().flat_map(rows_of).collect();
    let averaged = in_parallel(jobs, rows.len(), |at| {
        let (k, p, y, widths) = rows[at];
        let width = pictures[k].plane_size(p)[0] as usize;
        let row = &pictures[k].planes[p][y * width..][..width];
        match p {
            0 => average(row, widths, |c| table.light(c), |light| table.code(light)),
            _ => average(row, widths, i32::from, |c| c as u8),
        }
    });
    for ((k, p, y, _), row) in rows.into_iter().zip(averaged) {
        pictures[k].planes[p][y * row.len()..][..row.len()].copy_from_slice(&row);
    }
}

/// The mean over `width` samples round every sample of a closed row.
fn average(
    row: &[u8],
    width: f64,
    value_of: impl Fn(u8) -> i32,
    code_of: impl Fn(i32) -> u8,
) -> Vec<u8> {
    let count = row.len();
    let half = width.min(count as f64) / 2.0;
    let reach = half as usize + 1;
    // The row from `reach` samples before its begin on, and what lies before each.
    let begin = count - reach % count;
    let around = row.iter().cycle().skip(begin).take(count + 2 * reach + 1);
    let values: Vec<f64> = around.map(|code| f64::from(value_of(*code))).collect();
    let mut sums = Vec::with_capacity(values.len());
    let mut sum = 0.0;
    for value in &values {
        sums.push(sum);
        sum += value;
    }
    let ends = [-half, half].map(|end| reach as f64 + 0.5 + end);
    let [(low, low_part), (high, high_part)] = ends.map(|end| (end as usize, end.fract()));
    let until = |at: usize, part: f64| sums[at] + part * values[at];
    let mean = |x: usize| {
        let sum = until(x + high, high_part) - until(x + low, low_part);
        code_of((sum / (2.0 * half)).round() as i32)
    };
    (0..count).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prepare::pyramid::halve;
    use foveal_core::view::picture::Matrix;

    const FULL: Colour = Colour {
        matrix: Matrix::Bt709,
        full_range: true,
        chroma_left: false,
    };

    /// A picture of the sphere whose luma is a smooth function of the direction, turned by `turn`.
    fn sphere([w, h]: [u32; 2], turn: f64) -> Picture {
        let mut picture = Picture::filled(w, h, [0, 120, 140]);
        for (at, code) in (0..).zip(&mut picture.planes[0]) {
            let yaw = (f64::from(at % w) + 0.5) / f64::from(w) * 2.0 * PI + turn;
            let down = (f64::from(at / w) + 0.5) / f64::from(h) * PI;
            let [x, y, z] = [down.sin() * yaw.sin(), down.cos(), down.sin() * yaw.cos()];
            *code = (128.0 + 50.0 * (3.0 * x).sin() * (2.0 * z + y).cos() + 40.0 * y) as u8;
        }
        picture
    }

    #[test]
    fn a_turned_sphere_has_the_turned_level_so_that_the_seam_is_nowhere() {
        let turned_by = 64;
        let [plain, turned] = [0.0, 2.0 * PI * f64::from(turned_by) / 256.0]
            .map(|turn| halve_spheres(&[sphere([256, 128], turn)], 4, FULL, 2));
        let [plain, turned] = [&plain[0], &turned[0]];
        assert_eq!([plain.width, plain.height], [64, 32]);
        let step = turned_by as usize / 4;
        for (a, b) in plain.planes[0].chunks(64).zip(turned.planes[0].chunks(64)) {
            for x in 0..64 {
                assert!(b[x].abs_diff(a[(x + step) % 64]) <= 1, "{x}");
            }
        }
    }

    #[test]
    fn a_level_lies_where_its_picture_does_and_one_colour_stays() {
        let picture = sphere([256, 128], 0.3);
        let coarse = halve_spheres(std::slice::from_ref(&picture), 2, FULL, 1);
        let plain = halve(&picture, 2, FULL);
        for y in 24..40 {
            for x in 4..124 {
                let at = y * 128 + x;
                assert!(coarse[0].planes[0][at].abs_diff(plain.planes[0][at]) <= 1);
            }
        }
        for size in [[64, 32], [33, 17], [2, 2], [5, 1]] {
            let grey = Picture::filled(size[0], size[1], [80, 90, 100]);
            let coarse = halve_spheres(&[grey], 4, FULL, 1);
            let half = size.map(|side| side.div_ceil(2).div_ceil(2));
            assert_eq!(coarse[0], Picture::filled(half[0], half[1], [80, 90, 100]));
        }
    }

    #[test]
    fn what_is_sharper_round_a_pole_than_towards_it_is_averaged() {
        // Eight dark and eight bright sectors that meet at the poles.
        let mut picture = Picture::filled(256, 128, [0, 128, 128]);
        for (at, code) in picture.planes[0].iter_mut().enumerate() {
            *code = if at % 32 < 16 { 60 } else { 180 };
        }
        let coarse = &halve_spheres(&[picture], 2, FULL, 1)[0].planes[0];
        let span = |y: usize| {
            let row = &coarse[y * 128..][..128];
            row.iter().max().unwrap() - row.iter().min().unwrap()
        };
        assert!(span(0) < 24, "{}", span(0));
        assert!(
            span(1) < span(8) && span(32) > 110,
            "{} {}",
            span(1),
            span(32)
        );
    }
}
