//! How do numbers of all sizes become few bits, and are read fast?
//!
//! A number is a class, and an offset within its class: its low bits as they are.
//! Classes get codes whose lengths fit how often they occur (Huffman 1952), written before. Numbers
//! that are all the same small one take no bits. A list says how many bytes it has, so that several
//! can be read in turn: where each number begins depends on the one before, and a processor follows
//! more than one such chain at once.

use crate::content::bits::{BitWriter, push_varint, read_varint};
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

/// The class of a number, the bits of its offset within the class, and how many these are.
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

/// Writes these numbers as a list: how many bytes follow, the codes of their classes, the numbers.
pub(super) fn write_list(numbers: &[u64], bytes: &mut Vec<u8>) {
    let mut bits = BitWriter::default();
    write_numbers(numbers, &mut bits);
    write_block(&bits.finish(), bytes);
}

/// Writes how many bytes follow, then these.
pub(super) fn write_block(block: &[u8], bytes: &mut Vec<u8>) {
    push_varint(bytes, block.len() as u32);
    bytes.extend(block);
}

/// Takes the bytes from the front that [`write_block`] wrote.
///
/// # Errors
/// There are fewer.
pub(super) fn take_block<'a>(bytes: &mut &'a [u8]) -> Result<&'a [u8], PackError> {
    let said = read_varint(bytes);
    let block = said.and_then(|(length, rest)| rest.split_at_checked(length as usize));
    let (block, rest) = block.ok_or_else(|| {
        let found = format!("{} bytes left", bytes.len());
        PackError::new("points, list", found, "as many as it says".to_owned())
    })?;
    *bytes = rest;
    Ok(block)
}

fn write_numbers(numbers: &[u64], bits: &mut BitWriter) {
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

/// Bits that a list of these numbers takes, about.
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
fn codes_of(lengths: &[u8]) -> [u32; CLASSES] {
    let mut counts = [0_u32; MOST_CODE as usize + 1];
    for length in lengths {
        counts[usize::from(*length)] += 1;
    }
    let mut next = [0_u32; MOST_CODE as usize + 1];
    for length in 2..next.len() {
        next[length] = (next[length - 1] + counts[length - 1]) << 1;
    }
    let mut codes = [0; CLASSES];
    for (code, length) in codes.iter_mut().zip(lengths).filter(|(_, it)| **it > 0) {
        let next = &mut next[usize::from(*length)];
        *code = next.reverse_bits() >> (u32::BITS - u32::from(*length));
        *next += 1;
    }
    codes
}

/// A list that [`write_list`] wrote, read number by number. After its end come zeros.
pub(super) struct NumberList<'a> {
    bytes: &'a [u8],
    /// How many of its bits were read.
    at: usize,
    /// Bits of the longest code.
    mask: u64,
    /// By the next bits: the [`Entry`] of the class whose code they begin with.
    table: Vec<u64>,
}

impl<'a> NumberList<'a> {
    /// Opens the list that is in front, and takes it away.
    ///
    /// # Errors
    /// It has fewer bytes than it says, or its codes are invalid.
    pub(super) fn take(bytes: &mut &'a [u8]) -> Result<Self, PackError> {
        let mut list = Self {
            bytes: take_block(bytes)?,
            at: 0,
            mask: 0,
            table: Vec::new(),
        };
        list.read_codes()?;
        Ok(list)
    }

    /// Opens so many, which are in front, in their order.
    ///
    /// # Errors
    /// As there.
    pub(super) fn take_three(bytes: &mut &'a [u8]) -> Result<[Self; 3], PackError> {
        Ok([Self::take(bytes)?, Self::take(bytes)?, Self::take(bytes)?])
    }

    fn read_codes(&mut self) -> Result<(), PackError> {
        let [first, count] = [0; 2].map(|_| self.plain(COUNT_BITS) as usize);
        let wrong = |found: String, expected: &str| {
            Err(PackError::new("points, codes", found, expected.to_owned()))
        };
        if first + count > CLASSES || first == CLASSES {
            return wrong(format!("{count} classes from {first}"), "at most 126");
        }
        if count < 2 {
            self.table = vec![Entry::of(first, 0).0];
            return Ok(());
        }
        let mut lengths = [0; CLASSES];
        let lengths = &mut lengths[..count];
        for length in lengths.iter_mut() {
            *length = self.plain(LENGTH_BITS) as u8;
        }
        let room = |length: &u8| match u32::from(*length) {
            0 => 0,
            length if length <= MOST_CODE => 1 << (MOST_CODE - length),
            _ => 2 << MOST_CODE,
        };
        if lengths.iter().map(room).sum::<u32>() != 1 << MOST_CODE {
            return wrong(format!("{lengths:?}"), "whole codes");
        }
        let longest = lengths.iter().copied().max().unwrap_or_default();
        self.mask = (1 << longest) - 1;
        self.table = vec![0; 1 << longest];
        let codes = codes_of(lengths);
        let classes = (first..).zip(lengths.iter()).zip(codes);
        for ((class, length), code) in classes.filter(|((_, length), _)| **length > 0) {
            let entry = Entry::of(class, *length).0;
            let places = self.table[code as usize..].iter_mut();
            places.step_by(1 << length).for_each(|it| *it = entry);
        }
        Ok(())
    }

    /// The bits from here on, at least 57 of them.
    #[inline]
    fn bits(&self) -> u64 {
        let byte = self.at >> 3;
        let next = self.bytes.get(byte..).and_then(<[u8]>::first_chunk);
        let held = match next {
            Some(next) => u64::from_le_bytes(*next),
            None => self.last_bits(byte),
        };
        held >> (self.at & 7)
    }

    /// The same where fewer than eight bytes are left.
    #[cold]
    fn last_bits(&self, byte: usize) -> u64 {
        let rest = self.bytes.get(byte..).unwrap_or_default();
        let mut last = [0; 8];
        last[..rest.len()].copy_from_slice(rest);
        u64::from_le_bytes(last)
    }

    /// Reads a plain number of at most 32 bits.
    fn plain(&mut self, bits: u32) -> u64 {
        let number = self.bits() & ((1 << bits) - 1);
        self.at += bits as usize;
        number
    }

    /// Reads the next number.
    #[inline]
    pub(super) fn next(&mut self) -> u64 {
        let bits = self.bits();
        let entry = Entry(self.table[(bits & self.mask) as usize]);
        if entry.bits() == Entry::LONG {
            return self.next_long(entry);
        }
        self.at += entry.bits() as usize;
        entry.high() | (bits & LOW_BITS[entry.bits() as usize]) >> entry.length()
    }

    /// The same, of a class with more than 32 low bits.
    #[cold]
    fn next_long(&mut self, entry: Entry) -> u64 {
        self.at += entry.length() as usize;
        let class = entry.high();
        let (count, high) = parts_of(class as usize);
        let low = self.plain(32) | self.plain(count - 32) << 32;
        high << count | low
    }

    /// The number that all of a list are which takes no bits.
    pub(super) fn only(&self) -> Option<u64> {
        let entry = Entry(self.table[0]);
        (self.mask == 0 && entry.bits() == 0).then(|| entry.high())
    }

    /// Ends to read it.
    ///
    /// # Errors
    /// It has more or fewer bytes than were read.
    pub(super) fn end(self) -> Result<(), PackError> {
        match self.at.div_ceil(8) == self.bytes.len() {
            true => Ok(()),
            false => Err(PackError::new(
                "points, list",
                format!("{} bytes", self.bytes.len()),
                format!("{} bits", self.at),
            )),
        }
    }
}

/// How many low bits numbers of a class have, and the two bits above these.
fn parts_of(class: usize) -> (u32, u64) {
    match class as u32 {
        // Its own two bits.
        class @ 0..ALONE => (0, class.into()),
        class => ((class - ALONE) / 2 + 1, u64::from(2 + (class & 1))),
    }
}

/// A class as a table has it: in the low six bits how many its code and the low bits of a number
/// take, or [`Self::LONG`]; in the next four the length of its code; above, its numbers without
/// their low bits, or, where these are long, its own number.
#[derive(Clone, Copy)]
struct Entry(u64);

impl Entry {
    /// Stands for more than 32 low bits, which are not read at once.
    const LONG: u32 = 63;

    fn of(class: usize, length: u8) -> Self {
        let (count, high) = parts_of(class);
        let (bits, high) = match count {
            ..=32 => (u32::from(length) + count, high << count),
            _ => (Self::LONG, class as u64),
        };
        Self(u64::from(bits) | u64::from(length) << 6 | high << 10)
    }

    #[inline]
    fn bits(self) -> u32 {
        self.0 as u32 & 63
    }

    #[inline]
    fn length(self) -> u32 {
        self.0 as u32 >> 6 & 15
    }

    #[inline]
    fn high(self) -> u64 {
        self.0 >> 10
    }
}

/// So many low bits.
const LOW_BITS: [u64; 64] = {
    let mut all = [0; 64];
    let mut bits = 0;
    while bits < 64 {
        all[bits] = (1 << bits) - 1;
        bits += 1;
    }
    all
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::random::Random;

    fn written(numbers: &[u64]) -> Vec<u8> {
        let mut bytes = Vec::new();
        write_list(numbers, &mut bytes);
        bytes
    }

    fn read(mut bytes: &[u8], count: usize) -> Result<Vec<u64>, PackError> {
        let mut list = NumberList::take(&mut bytes)?;
        assert!(bytes.is_empty());
        let numbers = (0..count).map(|_| list.next()).collect();
        list.end()?;
        Ok(numbers)
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
    fn a_list_of_another_length_than_its_numbers_is_refused() {
        let bytes = written(&[5, 900, 3, 70_000]);
        assert!(read(&bytes, 4).is_ok());
        assert!(read(&bytes, 2).is_err(), "bytes are left over");
        assert!(read(&bytes, 40).is_err(), "there are no more numbers");
        for end in 0..bytes.len() {
            assert!(NumberList::take(&mut &bytes[..end]).is_err(), "{end}");
        }
        assert!(take_block(&mut &[0xff; 9][..]).is_err());
    }

    #[test]
    fn equal_small_numbers_take_no_bits() {
        for number in 0..4 {
            assert_eq!(written(&[number; 1000]).len(), 3);
            assert_eq!(read(&written(&[number; 1000]), 9).unwrap(), [number; 9]);
        }
        assert_eq!(written(&[]).len(), 3);
    }

    #[test]
    fn codes_that_are_none_are_refused() {
        for codes in [[0xff; 8], [0x80, 0x81, 0, 0, 0, 0, 0, 0]] {
            let mut bytes = Vec::new();
            write_block(&codes, &mut bytes);
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
