//! Which stretch of a curve through space lies in one cell?

use foveal_core::content::points::payload::CloudPoint;
use std::cmp::Ordering;

/// Along a curve through space (Morton 1966); equal places in the order of what else points have.
pub(super) fn along_curve(a: &CloudPoint, b: &CloudPoint) -> Ordering {
    let differ = [0, 1, 2].map(|k| a.place[k] ^ b.place[k]);
    // Of equal heights z counts before y, and y before x.
    let higher = |k: usize, than: usize| match differ[than].leading_zeros() {
        zeros if differ[k].leading_zeros() < zeros => k,
        _ => than,
    };
    let axis = higher(0, higher(1, 2));
    a.place[axis].cmp(&b.place[axis]).then_with(|| a.cmp(b))
}

/// Down to which depth two points lie in the same cell.
pub(super) fn common_depth(a: &CloudPoint, b: &CloudPoint, bits: u32) -> u32 {
    let differ = [0, 1, 2].map(|k| a.place[k] ^ b.place[k]);
    let all = differ[0] | differ[1] | differ[2];
    bits - (u32::BITS - all.leading_zeros())
}

/// The stretches of a part that lie in one cell of a depth each, as ends.
pub(super) fn cell_ends(
    points: &[CloudPoint],
    depth: u32,
    bits: u32,
) -> impl Iterator<Item = usize> + '_ {
    let ends = (1..points.len())
        .filter(move |at| common_depth(&points[at - 1], &points[*at], bits) < depth);
    ends.chain([points.len()])
}
