//! Which sample of a mask is nearest to a pixel, and which samples touch it?
//!
//! The interpolation mask of Kastner 2016, section 4.1.1, exactly: by the distance transform of
//! Felzenszwalb and Huttenlocher 2012, *Distance transforms of sampled functions*, section 2, in
//! time proportional to the pixels.

/// Neighbours of a sample that are noted.
pub const NEIGHBOURS: usize = 8;
/// No sample in this column.
const NONE: u32 = u32::MAX;

/// For every pixel of a square the number of the nearest of `places` (at least one), row by row.
#[must_use]
pub(super) fn nearest_samples(side: u32, places: &[[u16; 2]]) -> Vec<u32> {
    let columns = nearest_in_columns(side as usize, places);
    let mut nearest = vec![0; columns.len()];
    let mut hull = Hull::default();
    for (y, row) in nearest.chunks_mut(side as usize).enumerate() {
        let column = &columns[y * side as usize..][..side as usize];
        hull.clear();
        for (x, number) in column.iter().enumerate() {
            if *number != NONE {
                let down = f64::from(places[*number as usize][1]) - y as f64;
                hull.add(x as f64, down * down, *number);
            }
        }
        hull.write(row);
    }
    nearest
}

/// The nearest sample of every pixel among those of its own column.
fn nearest_in_columns(side: usize, places: &[[u16; 2]]) -> Vec<u32> {
    let mut found = vec![NONE; side * side];
    for (number, [x, y]) in (0..).zip(places) {
        found[usize::from(*y) * side + usize::from(*x)] = number;
    }
    let row_of = |number: u32| usize::from(places[number as usize][1]);
    for y in 1..side {
        for at in y * side..(y + 1) * side {
            if found[at] == NONE {
                found[at] = found[at - side];
            }
        }
    }
    // From below upwards; on the way down every pixel below a sample got the one above it.
    for y in (0..side - 1).rev() {
        for at in y * side..(y + 1) * side {
            let (here, below) = (found[at], found[at + side]);
            let is_nearer = below != NONE
                && (here == NONE || row_of(below).abs_diff(y) < row_of(here).abs_diff(y));
            if is_nearer {
                found[at] = below;
            }
        }
    }
    found
}

/// The lowest of parabolas x² + height, each where it is lowest.
#[derive(Default)]
struct Hull {
    /// Where each begins to be the lowest, its column and height, and its sample.
    parts: Vec<(f64, f64, f64, u32)>,
}

impl Hull {
    fn clear(&mut self) {
        self.parts.clear();
    }

    fn add(&mut self, column: f64, height: f64, number: u32) {
        let mut from = f64::MIN;
        while let Some((begin, other, other_height, _)) = self.parts.last() {
            let rise = (height + column * column) - (other_height + other * other);
            from = rise / (2.0 * (column - other));
            if from > *begin {
                break;
            }
            self.parts.pop();
            from = f64::MIN;
        }
        self.parts.push((from, column, height, number));
    }

    fn write(&self, row: &mut [u32]) {
        let mut part = 0;
        for (x, nearest) in row.iter_mut().enumerate() {
            while self
                .parts
                .get(part + 1)
                .is_some_and(|next| next.0 <= x as f64)
            {
                part += 1;
            }
            *nearest = self.parts[part].3;
        }
    }
}

/// The samples whose pixels touch those of each sample, the nearest [`NEIGHBOURS`] of them first.
#[must_use]
pub(super) fn neighbours_of(
    side: u32,
    places: &[[u16; 2]],
    nearest: &[u32],
) -> Vec<[u32; NEIGHBOURS]> {
    let side = side as usize;
    let mut found: Vec<[u32; NEIGHBOURS]> = (0..places.len() as u32)
        .map(|number| [number; NEIGHBOURS])
        .collect();
    let distance = |a: u32, b: u32| {
        let [a, b] = [a, b].map(|number| places[number as usize].map(i64::from));
        (a[0] - b[0]).pow(2) + (a[1] - b[1]).pow(2)
    };
    let mut touch = |own: u32, other: u32| {
        let mut moved = other;
        for slot in &mut found[own as usize] {
            if *slot == moved {
                return;
            }
            let is_free = *slot == own;
            if is_free || distance(own, moved) < distance(own, *slot) {
                core::mem::swap(slot, &mut moved);
                if is_free {
                    return;
                }
            }
        }
    };
    for at in 0..nearest.len() {
        let right = at % side + 1 < side;
        let below = at + side < nearest.len();
        let others = [
            (right, at + 1),
            (below, at + side),
            (right && below, at + side + 1),
            (at % side > 0 && below, (at + side).wrapping_sub(1)),
        ];
        for (_, other) in others.into_iter().filter(|(inside, _)| *inside) {
            let (a, b) = (nearest[at], nearest[other]);
            if a != b {
                touch(a, b);
                touch(b, a);
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::random::Random;

    fn some_places(side: u32, count: usize, seed: u64) -> Vec<[u16; 2]> {
        let mut random = Random::new(seed);
        let place = |random: &mut Random| [0, 1].map(|_| (random.unit() * f64::from(side)) as u16);
        let mut places: Vec<[u16; 2]> = (0..count).map(|_| place(&mut random)).collect();
        places.sort_unstable_by_key(|[x, y]| [*y, *x]);
        places.dedup();
        places
    }

    #[test]
    fn the_nearest_sample_is_nearest() {
        for (side, count) in [(1, 1), (40, 1), (40, 3), (53, 60), (31, 400)] {
            let places = some_places(side, count, u64::from(side));
            let nearest = nearest_samples(side, &places);
            for (at, number) in (0..).zip(&nearest) {
                let away = |place: &[u16; 2]| {
                    let [x, y] = place.map(i64::from);
                    (x - at % i64::from(side)).pow(2) + (y - at / i64::from(side)).pow(2)
                };
                let least = places.iter().map(away).min().unwrap();
                assert_eq!(away(&places[*number as usize]), least, "{side} {at}");
            }
        }
    }

    #[test]
    fn neighbours_touch_and_the_nearest_come_first() {
        let places = some_places(64, 90, 7);
        let nearest = nearest_samples(64, &places);
        let neighbours = neighbours_of(64, &places, &nearest);
        let away = |a: u32, b: u32| {
            let [a, b] = [a, b].map(|n| places[n as usize].map(i64::from));
            (a[0] - b[0]).pow(2) + (a[1] - b[1]).pow(2)
        };
        for (own, found) in (0..).zip(&neighbours) {
            let found: Vec<u32> = found.iter().copied().filter(|n| *n != own).collect();
            assert!(found.len() >= 2, "{own}: {found:?}");
            assert!(found.windows(2).all(|p| away(own, p[0]) <= away(own, p[1])));
            let mut unique = found.clone();
            unique.sort_unstable();
            unique.dedup();
            assert_eq!(unique.len(), found.len());
            for other in found {
                let touches = (0..64 * 64).any(|at| {
                    let beside = [at + 1, at + 63, at + 64, at + 65].into_iter();
                    let mut pairs = beside
                        .filter(|b| *b < 64 * 64)
                        .map(|b| [nearest[at], nearest[b]]);
                    pairs.any(|pair| pair == [own, other] || pair == [other, own])
                });
                assert!(touches, "{own} {other}");
            }
        }
    }
}
