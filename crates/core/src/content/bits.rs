//! How do small numbers become few bits?
//!
//! As Rice codes (Rice and Plaunt 1971, "Adaptive variable-length coding for efficient compression
//! of spacecraft television data"): a number's high bits as so many ones and a zero, then its low
//! bits as they are. The first bit is the lowest of the first byte.

/// So many ones stand for a number written out.
const ESCAPE: u32 = 18;
/// Bits of a number that is written out.
const PLAIN_BITS: u32 = 16;

/// A signed number, small ones first: 0, -1, 1, -2 and so on.
pub(in crate::content) fn unsigned_from_signed(it: i16) -> u16 {
    (it << 1 ^ it >> 15) as u16
}

/// The inverse of [`unsigned_from_signed`].
pub(in crate::content) fn signed_from_unsigned(it: u16) -> i16 {
    (it >> 1) as i16 ^ -((it & 1) as i16)
}

/// The number of low bits, up to 15, with which these numbers take the fewest.
pub(in crate::content) fn best_low_bits(numbers: impl Iterator<Item = u16> + Clone) -> u32 {
    let cost = |low: &u32| {
        let bits = |it: u16| match u32::from(it) >> low {
            high if high < ESCAPE => high + 1 + low,
            _ => ESCAPE + PLAIN_BITS,
        };
        numbers.clone().map(|it| u64::from(bits(it))).sum::<u64>()
    };
    (0..16).min_by_key(cost).unwrap_or(0)
}

/// Writes a number seven bits in a byte, low ones first; the highest bit says that more follow.
pub(in crate::content) fn push_varint(bytes: &mut Vec<u8>, mut value: u32) {
    while value > 127 {
        bytes.push(value as u8 | 128);
        value >>= 7;
    }
    bytes.push(value as u8);
}

/// Reads what [`push_varint`] wrote, and what is behind it.
pub(in crate::content) fn read_varint(bytes: &[u8]) -> Option<(u32, &[u8])> {
    let mut value = 0u64;
    for (place, byte) in bytes.iter().take(5).enumerate() {
        value |= u64::from(byte & 127) << (7 * place);
        if byte & 128 == 0 {
            let value = u32::try_from(value).ok()?;
            return Some((value, &bytes[place + 1..]));
        }
    }
    None
}

/// Bits that are written one after another.
#[derive(Default)]
pub(in crate::content) struct BitWriter {
    bytes: Vec<u8>,
    held: u64,
    count: u32,
}

impl BitWriter {
    /// Writes a number of at most 32 bits.
    pub(in crate::content) fn plain(&mut self, number: u32, bits: u32) {
        self.held |= u64::from(number) << self.count;
        self.count += bits;
        while self.count >= 8 {
            self.bytes.push(self.held as u8);
            self.held >>= 8;
            self.count -= 8;
        }
    }

    /// Writes a number as a Rice code.
    pub(in crate::content) fn rice(&mut self, number: u16, low_bits: u32) {
        let number = u32::from(number);
        let high = number >> low_bits;
        if high >= ESCAPE {
            self.plain((1 << ESCAPE) - 1, ESCAPE);
            return self.plain(number, PLAIN_BITS);
        }
        self.plain((1 << high) - 1, high + 1);
        self.plain(number & ((1 << low_bits) - 1), low_bits);
    }

    /// The bytes; zeros fill the last.
    pub(in crate::content) fn finish(mut self) -> Vec<u8> {
        if self.count > 0 {
            self.bytes.push(self.held as u8);
        }
        self.bytes
    }
}

/// Bits that are read one after another; after the end come zeros.
pub(in crate::content) struct BitReader<'a> {
    bytes: &'a [u8],
    /// Bytes that are in `held`, or were.
    taken: usize,
    held: u64,
    count: u32,
}

impl<'a> BitReader<'a> {
    pub(in crate::content) fn new(bytes: &'a [u8]) -> Self {
        Self {
            bytes,
            taken: 0,
            held: 0,
            count: 0,
        }
    }

    /// At least 56 bits are held then.
    #[inline]
    fn fill(&mut self) {
        if let Some(next) = self.bytes.get(self.taken..).and_then(<[u8]>::first_chunk) {
            self.held |= u64::from_le_bytes(*next) << self.count;
            let more = (63 - self.count) / 8;
            self.taken += more as usize;
            self.count += 8 * more;
            return;
        }
        while self.count < 56 {
            let next = self.bytes.get(self.taken).copied().unwrap_or(0);
            self.held |= u64::from(next) << self.count;
            self.taken += 1;
            self.count += 8;
        }
    }

    #[inline]
    fn drop_bits(&mut self, bits: u32) {
        self.held >>= bits;
        self.count -= bits;
    }

    /// Reads a number of at most 32 bits.
    pub(in crate::content) fn plain(&mut self, bits: u32) -> u32 {
        self.fill();
        let number = self.held & ((1 << bits) - 1);
        self.drop_bits(bits);
        number as u32
    }

    /// The next two bits.
    pub(in crate::content) fn next_two(&mut self) -> u64 {
        self.fill();
        self.held & 3
    }

    /// Drops bits that were looked at.
    pub(in crate::content) fn pass(&mut self, bits: u32) {
        self.drop_bits(bits);
    }

    /// Reads a Rice code.
    pub(in crate::content) fn rice(&mut self, low_bits: u32) -> u16 {
        self.fill();
        self.rice_held(low_bits)
    }

    /// Reads a Rice code right after [`Self::next_two`]: at most 36 bits, which are held.
    pub(in crate::content) fn rice_held(&mut self, low_bits: u32) -> u16 {
        let high = self.held.trailing_ones();
        if high >= ESCAPE {
            let number = self.held >> ESCAPE;
            self.drop_bits(ESCAPE + PLAIN_BITS);
            return number as u16;
        }
        let low = self.held >> (high + 1) & ((1 << low_bits) - 1);
        self.drop_bits(high + 1 + low_bits);
        (high << low_bits | low as u32) as u16
    }

    /// Number of bits that are left; none where it was read beyond the end.
    pub(in crate::content) fn left(&self) -> Option<usize> {
        (8 * self.bytes.len() + self.count as usize).checked_sub(8 * self.taken)
    }

    /// The whole bytes that are left.
    pub(in crate::content) fn rest(&self) -> Option<&'a [u8]> {
        let whole = self.left()? / 8;
        self.bytes.get(self.bytes.len() - whole..)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_back() {
        let numbers = (0..u16::MAX).step_by(251).chain(0..40);
        for low in 0..16 {
            let mut writer = BitWriter::default();
            for number in numbers.clone() {
                writer.rice(number, low);
                writer.plain(u32::from(number & 7), 3);
            }
            let bytes = writer.finish();
            let mut reader = BitReader::new(&bytes);
            for number in numbers.clone() {
                assert_eq!(reader.rice(low), number);
                assert_eq!(reader.plain(3), u32::from(number & 7));
            }
            assert!(reader.left().unwrap() < 8);
            assert!(reader.rest().unwrap().is_empty());
        }
    }

    #[test]
    fn after_the_end_come_zeros() {
        let mut reader = BitReader::new(&[0xff]);
        assert_eq!(reader.plain(8), 0xff);
        assert_eq!(reader.left(), Some(0));
        assert_eq!(reader.rice(3), 0);
        assert_eq!((reader.left(), reader.rest()), (None, None));
    }

    #[test]
    fn signs_come_back() {
        for it in [0, -1, 1, i16::MIN, i16::MAX] {
            assert_eq!(signed_from_unsigned(unsigned_from_signed(it)), it);
        }
    }
}
