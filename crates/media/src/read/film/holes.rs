//! Is a part of a coded picture gone, with zeros in its place?
//!
//! Copies that break off and blocks of a disk that cannot be read leave zeros. Decoders of entropy
//! codes take them for pictures. In units of H.264 and HEVC three in a row are forbidden; other
//! encoders write some dozens where nothing moves, and never a block of a disk.

use av::codec::Id;
use ffmpeg_next as av;

/// So many zeros in a row are a hole in a unit of H.264 or HEVC, and in other packets.
const IN_UNIT: usize = 32;
const IN_PACKET: usize = 512;
/// A run that long holds a whole block of this length.
const BLOCK: usize = 16;

/// How the pictures of a stream lie in its packets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pieces {
    /// Units of H.264 and HEVC, behind lengths of so many bytes.
    Lengths(usize),
    /// The same between start codes, which zeros may precede.
    StartCodes,
    /// One picture, which zeros may follow.
    Padded,
    /// One picture.
    Whole,
    /// A JPEG.
    Jpeg,
    /// For other codecs zeros show nothing.
    Unknown,
}

impl Pieces {
    /// By the codec and what the container says of it.
    pub(crate) fn of(id: Id, extra: &[u8]) -> Self {
        let length = |at: usize| match extra.first() {
            Some(1) => extra.get(at).map(|byte| usize::from(byte & 3) + 1),
            _ => None,
        };
        match id {
            Id::H264 => length(4).map_or(Self::StartCodes, Self::Lengths),
            Id::HEVC => length(21).map_or(Self::StartCodes, Self::Lengths),
            Id::AV1 => Self::Padded,
            Id::VP8 | Id::VP9 => Self::Whole,
            Id::MJPEG => Self::Jpeg,
            _ => Self::Unknown,
        }
    }

    /// Whether a packet has a hole.
    pub(crate) fn has_hole(self, packet: &[u8]) -> bool {
        let ends = |run: &[u8], rest: &[u8]| rest.len() > run.len();
        match self {
            Self::Unknown => false,
            Self::Whole => hole(packet, IN_PACKET).is_some(),
            Self::Padded => hole(packet, IN_PACKET).is_some_and(|[_, end]| end < packet.len()),
            Self::StartCodes => {
                let mut rest = packet;
                while let Some([_, end]) = hole(rest, IN_UNIT) {
                    rest = &rest[end..];
                    if !matches!(rest.first(), None | Some(1)) {
                        return true;
                    }
                }
                false
            }
            Self::Lengths(bytes) => {
                let mut rest = packet;
                while rest.len() > bytes {
                    let (length, after) = rest.split_at(bytes);
                    let length = length
                        .iter()
                        .fold(0, |sum, byte| sum << 8 | usize::from(*byte));
                    let (unit, next) = after.split_at(length.min(after.len()));
                    // What fills a unit up is at its end.
                    if hole(unit, IN_UNIT).is_some_and(|[_, end]| ends(&unit[..end], unit)) {
                        return true;
                    }
                    rest = next;
                }
                false
            }
            Self::Jpeg => {
                let is_scan = |two: &[u8]| *two == [0xff, 0xda];
                let Some(at) = packet.windows(2).position(is_scan) else {
                    return false;
                };
                let scan = &packet[at..];
                hole(scan, IN_PACKET)
                    .is_some_and(|[_, end]| scan[end..].windows(2).any(|two| *two == [0xff, 0xd9]))
            }
        }
    }
}

impl Pieces {
    /// Whether the first picture of a packet of H.264 may lean on others, so that a stream that
    /// begins with it begins in the middle.
    pub(crate) fn leans_on_others(self, packet: &[u8]) -> bool {
        const SLICES: std::ops::RangeInclusive<u8> = 1..=5;
        const WHOLE: u8 = 5;
        let kind = |byte: &u8| Some(byte & 31).filter(|kind| SLICES.contains(kind));
        let first = match self {
            Self::Lengths(bytes) => {
                let mut rest = packet;
                std::iter::from_fn(|| {
                    let (length, after) = rest.split_at_checked(bytes)?;
                    let length = length
                        .iter()
                        .fold(0, |sum, byte| sum << 8 | usize::from(*byte));
                    rest = after.get(length..).unwrap_or_default();
                    after.first()
                })
                .find_map(kind)
            }
            Self::StartCodes => packet
                .windows(4)
                .filter(|four| four.starts_with(&[0, 0, 1]))
                .find_map(|four| kind(&four[3])),
            _ => None,
        };
        first.is_some_and(|kind| kind != WHOLE)
    }
}

/// Where the first run of at least so many zeros begins and ends.
fn hole(bytes: &[u8], least: usize) -> Option<[usize; 2]> {
    let mut from = 0;
    loop {
        let block = bytes[from..]
            .chunks_exact(BLOCK)
            .position(|block| block == [0; BLOCK])?;
        let at = from + block * BLOCK;
        let before = bytes[from..at].iter().rev().take_while(|byte| **byte == 0);
        let begin = at - before.count();
        let zeros = bytes[begin..].iter().take_while(|byte| **byte == 0);
        let end = begin + zeros.count();
        if end - begin >= least {
            return Some([begin, end]);
        }
        from = end;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn with_zeros(at: usize, length: usize) -> Vec<u8> {
        let mut bytes = vec![7; 1000];
        bytes[at..at + length].fill(0);
        bytes
    }

    #[test]
    fn a_run_of_zeros_is_a_hole_but_for_what_fills_up() {
        for at in 0..40 {
            assert!(Pieces::Whole.has_hole(&with_zeros(at, 530)), "{at}");
            assert!(!Pieces::Whole.has_hole(&with_zeros(at, 500)), "{at}");
        }
        assert!(!Pieces::Padded.has_hole(&with_zeros(400, 600)));
        assert!(Pieces::Padded.has_hole(&with_zeros(400, 560)));
        let unit = |at, length| [&1000_u32.to_be_bytes()[..], &with_zeros(at, length)].concat();
        let two = [unit(950, 50), unit(3, 4)].concat();
        assert!(!Pieces::Lengths(4).has_hole(&two));
        assert!(Pieces::Lengths(4).has_hole(&[two, unit(20, 48)].concat()));
        let mut codes = with_zeros(20, 60);
        codes[80] = 1;
        assert!(!Pieces::StartCodes.has_hole(&codes));
        assert!(Pieces::StartCodes.has_hole(&[codes, with_zeros(9, 48)].concat()));
        assert!(!Pieces::Unknown.has_hole(&[0; 999]));
        let scan = [
            &[0; 600][..],
            &[0xff, 0xda],
            &with_zeros(30, 600),
            &[0xff, 0xd9],
        ]
        .concat();
        assert!(Pieces::Jpeg.has_hole(&scan) && !Pieces::Jpeg.has_hole(&[0; 999]));
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic(
            bytes in prop::collection::vec(prop::sample::select(&b"\0\0\x01\xff\xda"[..]), 0..900),
        ) {
            for pieces in [
                Pieces::Lengths(4), Pieces::Lengths(1), Pieces::StartCodes, Pieces::Padded,
                Pieces::Whole, Pieces::Jpeg,
            ] {
                pieces.has_hole(&bytes);
            }
        }
    }
}
