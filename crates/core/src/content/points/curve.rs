//! Which number has a place on a curve through all places (Morton 1966)?

/// Bits of a coordinate that a curve through space goes by.
pub(super) const BITS_OF_THREE: u32 = 21;

/// Moves bit `n` of the low 21 to bit `3 n`.
fn spread_by_three(it: u32) -> u64 {
    let it = u64::from(it) & 0x1f_ffff;
    let it = (it | it << 32) & 0x001f_0000_0000_ffff;
    let it = (it | it << 16) & 0x001f_0000_ff00_00ff;
    let it = (it | it << 8) & 0x100f_00f0_0f00_f00f;
    let it = (it | it << 4) & 0x10c3_0c30_c30c_30c3;
    (it | it << 2) & 0x1249_2492_4924_9249
}

/// The inverse of [`spread_by_three`].
fn gathered_by_three(it: u64) -> u32 {
    let it = it & 0x1249_2492_4924_9249;
    let it = (it | it >> 2) & 0x10c3_0c30_c30c_30c3;
    let it = (it | it >> 4) & 0x100f_00f0_0f00_f00f;
    let it = (it | it >> 8) & 0x001f_0000_ff00_00ff;
    let it = (it | it >> 16) & 0x001f_0000_0000_ffff;
    ((it | it >> 32) & 0x1f_ffff) as u32
}

/// Moves bit `n` to bit `2 n`.
fn spread_by_two(it: u32) -> u64 {
    let it = u64::from(it);
    let it = (it | it << 16) & 0x0000_ffff_0000_ffff;
    let it = (it | it << 8) & 0x00ff_00ff_00ff_00ff;
    let it = (it | it << 4) & 0x0f0f_0f0f_0f0f_0f0f;
    let it = (it | it << 2) & 0x3333_3333_3333_3333;
    (it | it << 1) & 0x5555_5555_5555_5555
}

/// The inverse of [`spread_by_two`].
fn gathered_by_two(it: u64) -> u32 {
    let it = it & 0x5555_5555_5555_5555;
    let it = (it | it >> 1) & 0x3333_3333_3333_3333;
    let it = (it | it >> 2) & 0x0f0f_0f0f_0f0f_0f0f;
    let it = (it | it >> 4) & 0x00ff_00ff_00ff_00ff;
    let it = (it | it >> 8) & 0x0000_ffff_0000_ffff;
    (it | it >> 16) as u32
}

/// The number of a place whose coordinates have 21 bits.
pub(super) fn number_of_three([x, y, z]: [u32; 3]) -> u64 {
    spread_by_three(x) | spread_by_three(y) << 1 | spread_by_three(z) << 2
}

/// The place of such a number.
pub(super) fn three_of_number(number: u64) -> [u32; 3] {
    [number, number >> 1, number >> 2].map(gathered_by_three)
}

/// The number of a place in a plane.
pub(super) fn number_of_two([u, v]: [u32; 2]) -> u64 {
    spread_by_two(u) | spread_by_two(v) << 1
}

/// The place of such a number.
pub(super) fn two_of_number(number: u64) -> [u32; 2] {
    [number, number >> 1].map(gathered_by_two)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_come_back_and_neighbours_of_one_cell_follow_each_other() {
        for place in [[0, 1, 2], [0x1f_ffff, 0, 0x12345], [77, 0x1f_fffe, 1]] {
            assert_eq!(three_of_number(number_of_three(place)), place);
        }
        for place in [[0, 1], [u32::MAX, 3], [0x8000_0001, 0xdead_beef]] {
            assert_eq!(two_of_number(number_of_two(place)), place);
        }
        assert_eq!(number_of_three([1, 1, 1]), 7);
        assert_eq!(number_of_two([3, 3]), 15);
    }
}
