//! How do numbers of all sizes become few bits, and are read fast?
//!
//! A number is a class, and what tells it from others of its class: its low bits as they are.
//! Classes get codes whose lengths fit how often they occur (Huffman 1952), written before. Numbers
//! that are all the same small one take no bits.

use crate::content::bits::{BitReader, BitWriter};
use crate::pack::PackError;

/// Longest code of a class, in bits.
const MOST_CODE: u32 = 11;
/// Bits that a length of a code is written with.
const LENGTH_BITS: u32 = 4;
/// Bits of the first class and of the number of classes.
const COUNT_BITS: u32 = 7;
/// Classes below this are numbers themselves.
const ALONE: u32 = 4;
/// Number of classes: two for each count of bits up to 64.
const CLASSES: usize = 126;

/// The class of a number, the bits that tell it from others of its class, and how many these are.
fn classed(number: u64) -> (u8, u64, u32) {
    if number < u64::from(ALONE) {
        return (number as u8, 0, 0);
    }
    let bits = u64::BITS - number.leading_zeros();
    let second = number >> (bits - 2) & 1;
    let class = ALONE + 2 * (bits - 3) + second as u32;
    (class as u8, number & ((1 << (bits - 2)) - 1), bits - 2)
}

/// A signed number as one without a sign, small ones first: 0, -1, 1, -2 and so on.
pub(super) fn unsigned_from_signed(it: i64) -> u64 {
    (it << 1 ^ it >> 63) as u64
}

/// The inverse of [`unsigned_from_signed`].
pub(super) fn signed_from_unsigned(it: u64) -> i64 {
    (it >> 1) as i64 ^ -((it & 1) as i64)
}

/// Writes these numbers and the codes of their classes before them.
pub(super) fn write_numbers(numbers: &[u64], bits: &mut BitWriter) {
    let lengths = code_lengths(numbers);
    let first = numbers.first().map(|it| classed(*it).0);
    write_lengths(&lengths, first, bits);
    let codes = codes_of(&lengths);
    for number in numbers {
        let (class, low, count) = classed(*number);
        let class = usize::from(class);
        bits.plain(codes[class], u32::from(lengths[class]));
        bits.plain(low as u32, count.min(32));
        bits.plain((low >> 32) as u32, count.saturating_sub(32));
    }
}

/// Bits that [`write_numbers`] takes.
pub(super) fn bits_of_numbers(numbers: &[u64]) -> u64 {
    let lengths = code_lengths(numbers);
    let used = lengths.iter().filter(|it| **it > 0).count() as u64;
    let bits = |number: &u64| {
        let (class, _, count) = classed(*number);
        u64::from(lengths[usize::from(class)]) + u64::from(count)
    };
    numbers.iter().map(bits).sum::<u64>() + used * u64::from(LENGTH_BITS)
}

/// The lengths of the codes of all classes; 0 of those that do not occur, and of one that is alone.
fn code_lengths(numbers: &[u64]) -> [u8; CLASSES] {
    let mut counts = [0_u32; CLASSES];
    for number in numbers {
        counts[usize::from(classed(*number).0)] += 1;
    }
    loop {
        let lengths = huffman(&counts);
        if lengths.iter().all(|it| u32::from(*it) <= MOST_CODE) {
            return lengths;
        }
        // Rare classes become less rare, until no code is too long.
        counts.iter_mut().for_each(|it| *it = it.div_ceil(2));
    }
}

/// The lengths of Huffman's codes.
fn huffman(counts: &[u32; CLASSES]) -> [u8; CLASSES] {
    let mut lengths = [0; CLASSES];
    // Trees with what they weigh; of equal ones the one that was made first is the lighter.
    let used = (0..CLASSES).filter(|class| counts[*class] > 0);
    let mut trees: Vec<(u32, Vec<usize>)> = used.map(|it| (counts[it], vec![it])).collect();
    while trees.len() > 1 {
        trees.sort_by_key(|tree| core::cmp::Reverse(tree.0));
        let (Some(a), Some(b)) = (trees.pop(), trees.pop()) else {
            break;
        };
        let classes = [a.1, b.1].concat();
        for class in &classes {
            lengths[*class] += 1;
        }
        trees.push((a.0 + b.0, classes));
    }
    if let [(_, only)] = &trees[..]
        && let [only] = only[..]
    {
        lengths[only] = 0;
    }
    lengths
}

/// Writes the first class that occurs, how many there are up to the last, and the lengths of their
/// codes where there are several.
fn write_lengths(lengths: &[u8; CLASSES], first_of_all: Option<u8>, bits: &mut BitWriter) {
    let used = |class: &usize| lengths[*class] > 0;
    let (first, last) = match ((0..CLASSES).find(used), (0..CLASSES).rfind(used)) {
        (Some(first), Some(last)) => (first, last),
        _ => {
            // One class, or none, where there is no number.
            let class = first_of_all.unwrap_or(0);
            bits.plain(u32::from(class), COUNT_BITS);
            return bits.plain(u32::from(first_of_all.is_some()), COUNT_BITS);
        }
    };
    bits.plain(first as u32, COUNT_BITS);
    bits.plain((last - first + 1) as u32, COUNT_BITS);
    for length in &lengths[first..=last] {
        bits.plain(u32::from(*length), LENGTH_BITS);
    }
}

/// The codes of these lengths, lowest bit first: in the order of their lengths, then of classes.
fn codes_of(lengths: &[u8; CLASSES]) -> [u32; CLASSES] {
    let mut codes = [0; CLASSES];
    let mut next = 0_u32;
    for length in 1..=MOST_CODE {
        for class in (0..CLASSES).filter(|it| u32::from(lengths[*it]) == length) {
            codes[class] = next.reverse_bits() >> (u32::BITS - length);
            next += 1;
        }
        next <<= 1;
    }
    codes
}

/// Reads numbers that [`write_numbers`] wrote.
pub(super) struct NumberReader {
    /// By the next bits: what [`entry_of`] makes of the class whose code they begin with.
    table: Box<[u16; 1 << MOST_CODE]>,
}

impl NumberReader {
    pub(super) fn new() -> Self {
        Self {
            table: Box::new([0; 1 << MOST_CODE]),
        }
    }

    /// Reads the codes of classes.
    ///
    /// # Errors
    /// They are none.
    pub(super) fn begin(&mut self, bits: &mut BitReader<'_>) -> Result<(), PackError> {
        let [first, count] = [0; 2].map(|_| bits.plain(COUNT_BITS) as usize);
        let wrong = |found: String, expected: &str| {
            Err(PackError::new("points, codes", found, expected.to_owned()))
        };
        if first + count > CLASSES || first == CLASSES {
            return wrong(format!("{count} classes from {first}"), "at most 126");
        }
        if count < 2 {
            self.table.fill(entry_of(first, 0));
            return Ok(());
        }
        let mut lengths = [0; CLASSES];
        for length in &mut lengths[first..first + count] {
            *length = bits.plain(LENGTH_BITS) as u8;
        }
        let room = |length: &u8| match u32::from(*length) {
            0 => 0,
            length if length <= MOST_CODE => 1 << (MOST_CODE - length),
            _ => 2 << MOST_CODE,
        };
        if lengths.iter().map(room).sum::<u32>() != 1 << MOST_CODE {
            return wrong(
                format!("{:?}", &lengths[first..first + count]),
                "whole codes",
            );
        }
        let codes = codes_of(&lengths);
        for class in (0..CLASSES).filter(|it| lengths[*it] > 0) {
            let entry = entry_of(class, lengths[class]);
            let places = self.table[codes[class] as usize..].iter_mut();
            places
                .step_by(1 << lengths[class])
                .for_each(|it| *it = entry);
        }
        Ok(())
    }

    /// Reads the next number.
    #[inline]
    pub(super) fn next(&self, bits: &mut BitReader<'_>) -> u64 {
        let entry = u32::from(self.table[bits.next_bits(MOST_CODE) as usize]);
        let (length, count) = (entry & 15, entry >> 4 & 63);
        let high = u64::from(entry >> 10);
        let low = match count {
            ..=32 => bits.code_and_rest(length, count),
            _ => {
                bits.code_and_rest(length, 0);
                let low = u64::from(bits.plain(32));
                low | u64::from(bits.plain(count - 32)) << 32
            }
        };
        high << count | low
    }
}

/// A class as a table has it: the length of its code, the number of its low bits, the two bits
/// above these.
fn entry_of(class: usize, length: u8) -> u16 {
    let class = class as u16;
    let (count, high) = match class {
        // Its own two bits.
        0..4 => (0, class),
        _ => ((class - 4) / 2 + 1, 2 + (class & 1)),
    };
    u16::from(length) | count << 4 | high << 10
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::random::Random;

    fn written(numbers: &[u64]) -> Vec<u8> {
        let mut bits = BitWriter::default();
        write_numbers(numbers, &mut bits);
        bits.finish()
    }

    fn read(bytes: &[u8], count: usize) -> Result<Vec<u64>, PackError> {
        let mut bits = BitReader::new(bytes);
        let mut reader = NumberReader::new();
        reader.begin(&mut bits)?;
        Ok((0..count).map(|_| reader.next(&mut bits)).collect())
    }

    #[test]
    fn numbers_of_all_sizes_come_back() {
        let mut random = Random::new(3);
        let mut any = || {
            let bits = (random.unit() * 64.0) as u32;
            ((random.unit() * 2_f64.powi(63)) as u64) >> bits
        };
        let numbers: Vec<u64> = (0..5000).map(|_| any()).collect();
        assert_eq!(read(&written(&numbers), 5000).unwrap(), numbers);
        let small: Vec<u64> = (0..2000).map(|it| it * it % 97).collect();
        assert_eq!(read(&written(&small), 2000).unwrap(), small);
        // Skewed beyond the longest code.
        let skewed: Vec<u64> = (0..30).flat_map(|it| vec![it; 1 << (it / 2)]).collect();
        assert_eq!(read(&written(&skewed), skewed.len()).unwrap(), skewed);
    }

    #[test]
    fn equal_small_numbers_take_no_bits() {
        for number in 0..4 {
            assert_eq!(written(&[number; 1000]).len(), 2);
            assert_eq!(read(&written(&[number; 1000]), 9).unwrap(), [number; 9]);
        }
        assert_eq!(written(&[]).len(), 2);
    }

    #[test]
    fn codes_that_are_none_are_refused() {
        for bytes in [[0xff; 9], [0x80, 0x81, 0, 0, 0, 0, 0, 0, 0]] {
            assert!(read(&bytes, 1).is_err());
        }
    }

    #[test]
    fn signs_come_back() {
        for it in [0, -1, 1, i64::MIN, i64::MAX] {
            assert_eq!(signed_from_unsigned(unsigned_from_signed(it)), it);
        }
    }
}
