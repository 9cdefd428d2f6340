//! How does one picture become a long moving clip, cheaply?
//!
//! A camera turns evenly: every frame is the same picture a little further on, by a part of a
//! pixel, so that coding it needs interpolation. It is seen through a window that moves over a
//! wider picture.

use crate::parallel::in_parallel;
use foveal_core::view::picture::{Picture, plane_size};

/// Luma pixels that the camera moves on in a frame.
pub(super) const STEP: f64 = 2.5;
/// Parts of a sample that shifts are rounded to.
const PARTS: u32 = 16;
/// Rows in one part of the work.
const ROWS: usize = 64;

/// One picture, seen by a camera that turns.
pub struct Pan {
    picture: Picture,
    width: u32,
}

impl Pan {
    /// Luma pixels by which a flat picture must be wider than the clip for this many frames; even.
    #[must_use]
    pub fn margin(frames: u32) -> u32 {
        ((f64::from(frames) * STEP) as u32 + 2).next_multiple_of(2)
    }

    /// A clip of `width` pixels that moves to the right over a wider picture.
    ///
    /// # Panics
    /// When the picture is not wider, or a width is odd.
    #[must_use]
    pub fn over(picture: Picture, width: u32) -> Self {
        assert!(
            width < picture.width && width.is_multiple_of(2) && picture.width.is_multiple_of(2),
            "a window of {width} cannot move over {}",
            picture.width
        );
        Self { picture, width }
    }

    /// Frame `number`; by all cores. A flat clip moves for as long as there is picture to its right
    /// and then goes on at its left border.
    #[must_use]
    pub fn frame(&self, number: u32) -> Picture {
        let height = self.picture.height;
        Picture {
            width: self.width,
            height,
            planes: [0, 1, 2].map(|p| {
                let sampling = if p == 0 { 1.0 } else { 2.0 };
                let shift = (f64::from(number) * STEP / sampling * f64::from(PARTS)) as u64;
                self.plane(p, shift)
            }),
        }
    }

    /// Plane `p`, moved by `shift` parts of a sample.
    fn plane(&self, p: usize, shift: u64) -> Vec<u8> {
        let [from_width, rows] = self.picture.plane_size(p).map(|side| side as usize);
        let width = plane_size(self.width, self.picture.height, p)[0] as usize;
        let first = (shift / u64::from(PARTS)) as usize % from_width;
        let part = (shift % u64::from(PARTS)) as u32;
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let bands = in_parallel(cores, rows.div_ceil(ROWS), |band| {
            let mut out = Vec::with_capacity(ROWS * width);
            for row in band * ROWS..((band + 1) * ROWS).min(rows) {
                let line = &self.picture.planes[p][row * from_width..][..from_width];
                // The line, begun at the shift and closed round.
                let mut turned = Vec::with_capacity(width + 1);
                let ahead = (width + 1).min(from_width - first);
                turned.extend_from_slice(&line[first..first + ahead]);
                turned.extend_from_slice(&line[..width + 1 - ahead]);
                out.extend(
                    turned
                        .windows(2)
                        .map(|pair| between(pair[0], pair[1], part)),
                );
            }
            out
        });
        bands.concat()
    }
}

/// Between two samples, `part` of [`PARTS`] of the second.
fn between(a: u8, b: u8, part: u32) -> u8 {
    ((u32::from(a) * (PARTS - part) + u32::from(b) * part + PARTS / 2) / PARTS) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture whose luma is its column.
    fn ramp(width: u32) -> Picture {
        let mut picture = Picture::filled(width, 4, [0, 128, 128]);
        let columns = (0..width).map(|x| x as u8);
        picture.planes[0] = columns.cycle().take(4 * width as usize).collect();
        picture
    }

    #[test]
    fn every_frame_is_the_picture_a_little_further_on() {
        let pan = Pan::over(ramp(64), 32);
        for number in 0..8 {
            let frame = pan.frame(number);
            assert!(frame.is_consistent());
            let expected = (2.5 * f64::from(number)).round() as u8;
            assert!(frame.planes[0][0].abs_diff(expected) <= 1, "{number}");
            assert_eq!(frame.planes[0][31] - frame.planes[0][0], 31);
        }
    }

    #[test]
    fn a_flat_clip_of_the_promised_length_never_comes_round() {
        let pan = Pan::over(ramp(32 + Pan::margin(9)), 32);
        let last = pan.frame(8);
        assert!(last.planes[0].chunks(32).all(|line| line.is_sorted()));
    }
}
