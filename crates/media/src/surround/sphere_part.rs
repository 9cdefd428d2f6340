//! Where on a whole sphere does a picture of a part of it lie?

use foveal_core::view::picture::{Picture, plane_size};

/// Most pixels of a whole sphere, and of a side: what stills may have.
pub(super) const MOST_PIXELS: u64 = 1 << 30;
pub(super) const MOST_SIDE: f64 = (1 << 17) as f64;

/// A picture's place on the equirectangular picture of the whole sphere that it was cut from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SpherePart {
    /// Pixels of the whole.
    pub whole: [u32; 2],
    /// The column and the row of the whole that the picture begins at, both even, so that chroma
    /// stays on its luma. What would lie beyond the right border goes on at the left one.
    pub at: [u32; 2],
}

impl SpherePart {
    /// The place of a picture of `size` on a whole of which `cut` is missing at the left, top,
    /// right and bottom, as parts of the whole, 0 to 1. The error says what cannot be.
    pub(crate) fn within(size: [u32; 2], cut: [f64; 4]) -> Result<Self, String> {
        let [left, top, right, bottom] = cut;
        let missing = [left + right, top + bottom];
        if cut.iter().any(|side| !(0.0..1.0).contains(side)) || missing.iter().any(|it| *it >= 1.0)
        {
            return Err(format!("they cut off {cut:?}"));
        }
        let whole = [0, 1].map(|k| (f64::from(size[k]) / (1.0 - missing[k])).round());
        if whole.iter().any(|side| *side > MOST_SIDE) || whole[0] * whole[1] > MOST_PIXELS as f64 {
            return Err(format!(
                "the whole sphere would have {} x {} pixels, more than {MOST_PIXELS}",
                whole[0], whole[1]
            ));
        }
        // Even, so that chroma stays on its luma, and so that the picture does not reach below.
        let even = |place: f64| 2.0 * (place / 2.0).round();
        let lowest = 2.0 * ((whole[1] - f64::from(size[1])) / 2.0).floor();
        let at = [
            even(left * whole[0]).rem_euclid(whole[0]),
            even(top * whole[1]).min(lowest),
        ];
        Ok(Self {
            whole: whole.map(|side| side as u32),
            at: at.map(|place| place as u32 & !1),
        })
    }

    /// Whether a picture of this size is the whole as it stands.
    #[must_use]
    pub fn is_whole(&self, size: [u32; 2]) -> bool {
        self.whole == size && self.at == [0, 0]
    }

    /// How far the middle of a picture of this width lies to the right of the middle of the whole,
    /// in degrees, -180 to 180.
    #[must_use]
    pub fn middle_deg(&self, width: u32) -> f64 {
        let middle = f64::from(self.at[0]) + f64::from(width) / 2.0;
        (middle / f64::from(self.whole[0]) * 360.0).rem_euclid(360.0) - 180.0
    }

    /// The whole with the picture on it, and code value `black` where there is none.
    ///
    /// # Panics
    /// The picture is wider than the whole, or reaches below it.
    #[must_use]
    pub fn whole_of(&self, picture: &Picture, black: u8) -> Picture {
        let [width, height] = self.whole;
        let fits = picture.width <= width && picture.height + self.at[1] <= height;
        assert!(fits, "a part lies within its whole");
        let planes = [0, 1, 2].map(|p| {
            let [w, h] = plane_size(width, height, p).map(|side| side as usize);
            let [from_w, from_h] = picture.plane_size(p).map(|side| side as usize);
            let halved = if p == 0 { 1 } else { 2 };
            let [x, y] = self.at.map(|at| at as usize / halved);
            let mut plane = vec![if p == 0 { black } else { 128 }; w * h];
            let to = plane.chunks_exact_mut(w).skip(y);
            let from = picture.planes[p].chunks_exact(from_w).take(from_h);
            for (to, from) in to.zip(from) {
                let (right, left) = from.split_at(from_w.min(w - x));
                to[x..x + right.len()].copy_from_slice(right);
                to[..left.len()].copy_from_slice(left);
            }
            plane
        });
        Picture {
            width,
            height,
            planes,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::scenes::scene;

    #[test]
    fn every_pixel_of_a_part_lies_at_its_place_also_beyond_the_border_and_the_rest_is_black() {
        let picture = scene([34, 11], 0, 1);
        for (whole, at) in [
            ([64, 32], [2, 4]),
            ([64, 32], [50, 20]),
            ([34, 11], [20, 0]),
        ] {
            let part = SpherePart { whole, at };
            let lies = part.whole_of(&picture, 16);
            assert!(lies.is_consistent());
            for p in 0..3 {
                let [w, h] = lies.plane_size(p);
                let [from_w, from_h] = picture.plane_size(p);
                let [x, y] = at.map(|at| if p == 0 { at } else { at / 2 });
                for (column, row) in (0..w * h).map(|place| (place % w, place / w)) {
                    let [u, v] = [(column + w - x) % w, row.wrapping_sub(y)];
                    let expected = match u < from_w && v < from_h {
                        true => picture.planes[p][(v * from_w + u) as usize],
                        false => [16, 128, 128][p],
                    };
                    let found = lies.planes[p][(row * w + column) as usize];
                    assert_eq!(found, expected, "{whole:?} {at:?} {p} {column} {row}");
                }
            }
        }
    }
}
