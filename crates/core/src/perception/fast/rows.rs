//! How is one row of a pyramid halved, doubled, compared and added up?
//!
//! Plain loops over slices of equal length, which compilers turn into vector code. A padded row has
//! [`PAD`] samples before its first and after its last, which repeat the border.

use core::ops::Range;

/// Samples that a padded row has more on each side.
pub(super) const PAD: usize = 2;

/// Repeats the border of a padded row of `width` samples.
#[inline(always)]
pub(super) fn repeat_border(row: &mut [f32], width: usize) {
    let (first, last) = (row[PAD], row[PAD + width - 1]);
    row[..PAD].fill(first);
    row[PAD + width..].fill(last);
}

/// Decodes 8-bit luma into a padded row.
// Table look-ups gain nothing from wider instructions, and registers of their own.
#[inline(never)]
pub(super) fn decode(luma: &[u8], table: &[f32; 256], row: &mut [f32]) {
    for (value, &code) in row[PAD..].iter_mut().zip(luma) {
        *value = table[usize::from(code)];
    }
    repeat_border(row, luma.len());
}

/// Mixes four rows by (1, 3, 3, 1) / 8.
#[inline(always)]
pub(super) fn halve_rows(rows: [&[f32]; 4], mixed: &mut [f32]) {
    let count = mixed.len();
    let [a, b, c, d] = rows.map(|row| &row[..count]);
    for i in 0..count {
        mixed[i] = (a[i] + d[i] + 3.0 * (b[i] + c[i])) * 0.125;
    }
}

/// Halves a padded row by (1, 3, 3, 1) / 8.
#[inline(always)]
pub(super) fn halve(row: &[f32], half: &mut [f32]) {
    let (pairs, _) = row[PAD - 1..].as_chunks::<2>();
    let count = half.len();
    let (pairs, next) = (&pairs[..count], &pairs[1..=count]);
    for i in 0..count {
        half[i] = (pairs[i][0] + next[i][1] + 3.0 * (pairs[i][1] + next[i][0])) * 0.125;
    }
}

/// Mixes a row with a quarter of its neighbour into a padded row, the samples of `span` alone.
#[inline(always)]
pub(super) fn double_rows(near: &[f32], far: &[f32], span: Range<usize>, padded: &mut [f32]) {
    let mixed = &mut padded[PAD..][span.clone()];
    let (near_part, far_part) = (&near[span.clone()], &far[span]);
    for i in 0..mixed.len() {
        mixed[i] = 0.75 * near_part[i] + 0.25 * far_part[i];
    }
    repeat_border(padded, near.len());
}

/// Doubles a padded row; `out` may be one sample short of twice its width.
#[inline(always)]
pub(super) fn double(padded: &[f32], out: &mut [f32]) {
    let (twos, rest) = out.as_chunks_mut::<2>();
    let count = twos.len();
    let before = &padded[PAD - 1..][..count];
    let here = &padded[PAD..][..count];
    let after = &padded[PAD + 1..][..count];
    for i in 0..count {
        let most = 0.75 * here[i];
        twos[i] = [most + 0.25 * before[i], most + 0.25 * after[i]];
    }
    for value in rest {
        *value = 0.75 * padded[PAD + count] + 0.25 * padded[PAD + count - 1];
    }
}

/// Contrast of a row over its local mean, in place of the mean.
#[inline(always)]
pub(super) fn contrast(fine: &[f32], mean: &mut [f32]) {
    for (mean, fine) in mean.iter_mut().zip(fine) {
        *mean = fine / *mean - 1.0;
    }
}

/// Adds a row to another.
#[inline(always)]
pub(super) fn add(terms: &[f32], sum: &mut [f32]) {
    for (sum, term) in sum.iter_mut().zip(terms) {
        *sum += term;
    }
}

/// Adds the products of two rows to a third.
#[inline(always)]
pub(super) fn add_products(a: &[f32], b: &[f32], sum: &mut [f32]) {
    for (sum, (a, b)) in sum.iter_mut().zip(a.iter().zip(b)) {
        *sum += a * b;
    }
}

/// What a row of a step is seen with: weighed sensitivity to what stays and sensitivity to change.
#[derive(Clone, Copy)]
pub(super) struct SeenRow<'a> {
    /// Sustained sensitivity, times the weight of visible error.
    pub(super) error: &'a [f32],
    /// Transient sensitivity.
    pub(super) transient: &'a [f32],
    /// Weight of popping.
    pub(super) popping: f32,
    /// Where Weber's law begins.
    pub(super) omega: f32,
}

/// Adds what one band of a step is worth: `gain::band_gain` with its terms gathered.
#[inline(always)]
pub(super) fn add_gain(seen: SeenRow<'_>, before: &[f32], after: &[f32], sum: &mut [f32]) {
    let count = sum.len();
    let (error, transient) = (&seen.error[..count], &seen.transient[..count]);
    let (before, after) = (&before[..count], &after[..count]);
    for i in 0..count {
        let difference = (before[i] - after[i]).abs();
        let ground = transient[i] * before[i].abs() + seen.omega;
        sum[i] += difference * (error[i] + seen.popping * transient[i] / ground);
    }
}

/// Spreads one value a node over `per_node` samples each, linearly, samples in the middle of their
/// cells.
#[inline(always)]
pub(super) fn spread_nodes(nodes: &[f32], per_node: usize, out: &mut [f32]) {
    match per_node {
        8 => spread_cells::<8>(nodes, out),
        4 => spread_cells::<4>(nodes, out),
        2 => spread_cells::<2>(nodes, out),
        _ => spread_cells::<1>(nodes, out),
    }
}

#[inline(always)]
fn spread_cells<const N: usize>(nodes: &[f32], out: &mut [f32]) {
    let shares: [f32; N] = core::array::from_fn(|i| (i as f32 + 0.5) / N as f32);
    let (cells, rest) = out.as_chunks_mut::<N>();
    for (cell, ends) in cells.iter_mut().zip(nodes.windows(2)) {
        *cell = shares.map(|share| ends[0] + (ends[1] - ends[0]) * share);
    }
    let last = &nodes[cells.len()..];
    for (value, share) in rest.iter_mut().zip(shares) {
        *value = last[0] + (last[1] - last[0]) * share;
    }
}

/// Mixes two rows of nodes.
#[inline(always)]
pub(super) fn mix(a: &[f32], b: &[f32], share: f32, out: &mut [f32]) {
    for (value, (a, b)) in out.iter_mut().zip(a.iter().zip(b)) {
        *value = a + (b - a) * share;
    }
}
