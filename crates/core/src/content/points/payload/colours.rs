//! How are colours written?
//!
//! Each code is written as its difference from the point before, from 0: a list of all greens,
//! then one of all reds and one of all blues, each less what is added to green. Corrections are
//! written as they are, in the same three lists.

use crate::content::points::cloud_point::{CloudPoint, Correction, wrong};
use crate::content::points::lengths::{
    NumberList, signed_from_unsigned, unsigned_from_signed, write_list,
};
use crate::pack::PackError;

const RED: usize = 0;
const GREEN: usize = 1;
const BLUE: usize = 2;

/// Writes colours.
pub(super) fn write(colours: impl Iterator<Item = [u16; 3]>, bytes: &mut Vec<u8>) {
    let mut before = [0; 3];
    let steps = colours.map(|it| {
        let it = it.map(i32::from);
        let before = core::mem::replace(&mut before, it);
        [0, 1, 2].map(|k| it[k] - before[k])
    });
    write_corrections(&steps.collect::<Vec<_>>(), bytes);
}

/// Writes differences of colours.
pub(super) fn write_corrections(all: &[Correction], bytes: &mut Vec<u8>) {
    for channel in [GREEN, RED, BLUE] {
        let told = all.iter().map(|it| {
            let green = if channel == GREEN { 0 } else { it[GREEN] };
            unsigned_from_signed(i64::from(it[channel]) - i64::from(green))
        });
        write_list(&told.collect::<Vec<_>>(), bytes);
    }
}

/// Differences of colours, read one by one.
struct Differences<'a> {
    green: NumberList<'a>,
    red: NumberList<'a>,
    blue: NumberList<'a>,
}

impl<'a> Differences<'a> {
    fn take(bytes: &mut &'a [u8]) -> Result<Self, PackError> {
        let [green, red, blue] = NumberList::take_three(bytes)?;
        Ok(Self { green, red, blue })
    }

    /// Of red, green and blue.
    #[inline]
    fn next(&mut self) -> [i64; 3] {
        let [green, red, blue] = [&mut self.green, &mut self.red, &mut self.blue]
            .map(|list| signed_from_unsigned(list.next()));
        [red.wrapping_add(green), green, blue.wrapping_add(green)]
    }

    fn end(self) -> Result<(), PackError> {
        self.green.end()?;
        self.red.end()?;
        self.blue.end()
    }
}

/// Reads the colours of points.
pub(super) fn read(points: &mut [CloudPoint], bytes: &mut &[u8]) -> Result<(), PackError> {
    let mut differences = Differences::take(bytes)?;
    let (mut codes, mut beyond) = ([0_i64; 3], 0);
    for point in points {
        for ((code, step), told) in codes
            .iter_mut()
            .zip(differences.next())
            .zip(&mut point.colour)
        {
            *code = code.wrapping_add(step);
            beyond |= *code;
            *told = *code as u16;
        }
    }
    differences.end()?;
    match beyond & !i64::from(u16::MAX) {
        0 => Ok(()),
        _ => Err(wrong("colour", "a code beyond 65535", "0 to 65535")),
    }
}

/// Reads so many differences of colours.
pub(super) fn read_corrections(
    count: usize,
    bytes: &mut &[u8],
) -> Result<Vec<Correction>, PackError> {
    let mut differences = Differences::take(bytes)?;
    let each = (0..count).map(|_| differences.next().map(|it| it as i32));
    let all = each.collect();
    differences.end()?;
    Ok(all)
}
