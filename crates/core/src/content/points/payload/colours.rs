//! How are colours written?
//!
//! Each code is told as what is added to that of the point before, from 0: a list of all greens,
//! then one of all reds and one of all blues, each less what is added to green. Corrections are
//! told as they are, in the same three lists.

use crate::content::bits::{BitReader, BitWriter};
use crate::content::points::cloud_point::{CloudPoint, Correction, wrong};
use crate::content::points::lengths::{
    NumberReader, signed_from_unsigned, unsigned_from_signed, write_numbers,
};
use crate::pack::PackError;

const RED: usize = 0;
const GREEN: usize = 1;
const BLUE: usize = 2;

/// Writes colours.
pub(super) fn write(colours: impl Iterator<Item = [u16; 3]>, bits: &mut BitWriter) {
    let mut before = [0; 3];
    let steps = colours.map(|it| {
        let it = it.map(i32::from);
        let before = core::mem::replace(&mut before, it);
        [0, 1, 2].map(|k| it[k] - before[k])
    });
    write_corrections(&steps.collect::<Vec<_>>(), bits);
}

/// Writes differences of colours.
pub(super) fn write_corrections(all: &[Correction], bits: &mut BitWriter) {
    for channel in [GREEN, RED, BLUE] {
        let told = all.iter().map(|it| {
            let green = if channel == GREEN { 0 } else { it[GREEN] };
            unsigned_from_signed(i64::from(it[channel]) - i64::from(green))
        });
        write_numbers(&told.collect::<Vec<_>>(), bits);
    }
}

/// Reads the colours of points.
pub(super) fn read(
    points: &mut [CloudPoint],
    (numbers, bits): (&mut NumberReader, &mut BitReader<'_>),
) -> Result<(), PackError> {
    let mut beyond = 0;
    let mut greens = vec![0_i64; points.len()];
    for channel in [GREEN, RED, BLUE] {
        numbers.begin(bits)?;
        let mut code = 0_i64;
        for (point, green) in points.iter_mut().zip(&mut greens) {
            let told = signed_from_unsigned(numbers.next(bits));
            let step = match channel {
                GREEN => {
                    *green = told;
                    told
                }
                _ => told.wrapping_add(*green),
            };
            code = code.wrapping_add(step);
            beyond |= code;
            point.colour[channel] = code as u16;
        }
    }
    match beyond & !i64::from(u16::MAX) {
        0 => Ok(()),
        _ => Err(wrong("colour", "a code beyond 65535", "0 to 65535")),
    }
}

/// Reads so many differences of colours.
pub(super) fn read_corrections(
    count: usize,
    (numbers, bits): (&mut NumberReader, &mut BitReader<'_>),
) -> Result<Vec<Correction>, PackError> {
    let mut all = vec![[0; 3]; count];
    for channel in [GREEN, RED, BLUE] {
        numbers.begin(bits)?;
        for it in &mut all {
            let told = signed_from_unsigned(numbers.next(bits)) as i32;
            let green = if channel == GREEN { 0 } else { it[GREEN] };
            it[channel] = told.wrapping_add(green);
        }
    }
    Ok(all)
}
