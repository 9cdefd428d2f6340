//! Which sound belongs to the pictures, and where does each of its packets lie?
//!
//! One track of Opus packets of equal length, in step with the pictures: sample 0 is heard when the
//! first frame is shown (docs/formats/pack.md, side table `sound`).

use crate::pack::PackError;
use crate::units::counted;
use core::ops::Range;

/// Name of the side table.
pub const SOUND: &str = "sound";
/// Samples a second of every track.
pub const SOUND_RATE: u32 = 48_000;
/// Bytes before the lengths of the packets.
const HEAD: usize = 24;
/// Samples that an Opus packet of one frame can have at 48 kHz.
const PACKET_SAMPLES: [u32; 6] = [120, 240, 480, 960, 1920, 2880];
/// Most packets: a week of the shortest.
const MOST_PACKETS: u32 = 1 << 28;

/// A coded track.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SoundTable {
    /// 1 or 2.
    pub channels: u8,
    /// Samples that decoding yields before sample 0.
    pub pre_skip: u16,
    /// Samples that a packet decodes to.
    pub packet_samples: u32,
    /// Samples of the track, from sample 0.
    pub samples: u64,
    /// Where each packet ends in `bytes`.
    ends: Vec<usize>,
    bytes: Vec<u8>,
}

impl SoundTable {
    /// A track without packets, to be filled by [`Self::push`].
    #[must_use]
    pub fn new(channels: u8, pre_skip: u16, packet_samples: u32) -> Self {
        Self {
            channels,
            pre_skip,
            packet_samples,
            samples: 0,
            ends: Vec::new(),
            bytes: Vec::new(),
        }
    }

    /// Appends a packet.
    ///
    /// # Panics
    /// A packet of no byte or of more than 65,535: no encoder makes one.
    pub fn push(&mut self, packet: &[u8]) {
        let fits = !packet.is_empty() && packet.len() <= usize::from(u16::MAX);
        assert!(fits, "a sound packet of {} bytes", packet.len());
        self.bytes.extend_from_slice(packet);
        self.ends.push(self.bytes.len());
    }

    /// Number of packets.
    #[must_use]
    pub fn packets(&self) -> usize {
        self.ends.len()
    }

    /// The bytes of a packet; `None` beyond the last.
    #[must_use]
    pub fn packet(&self, number: usize) -> Option<&[u8]> {
        let end = *self.ends.get(number)?;
        let begin = number.checked_sub(1).map_or(0, |before| self.ends[before]);
        Some(&self.bytes[begin..end])
    }

    /// The samples of the track that a packet decodes to; negative ones come before sample 0.
    #[must_use]
    pub fn samples_of(&self, number: usize) -> Range<i64> {
        let begin = number as i64 * i64::from(self.packet_samples) - i64::from(self.pre_skip);
        begin..begin + i64::from(self.packet_samples)
    }

    /// The bytes of the side table, version 1.
    #[must_use]
    pub fn write(&self) -> Vec<u8> {
        let mut out = Vec::with_capacity(HEAD + 2 * self.ends.len() + self.bytes.len());
        out.extend(SOUND_RATE.to_le_bytes());
        out.extend([self.channels, 0]);
        out.extend(self.pre_skip.to_le_bytes());
        out.extend(self.packet_samples.to_le_bytes());
        out.extend((self.ends.len() as u32).to_le_bytes());
        out.extend(self.samples.to_le_bytes());
        let mut begin = 0;
        for end in &self.ends {
            out.extend(((end - begin) as u16).to_le_bytes());
            begin = *end;
        }
        out.extend(&self.bytes);
        out
    }

    /// Reads a side table; allocates no more than twice what the bytes hold. Refuses what is
    /// outside the ranges of docs/formats/pack.md.
    pub fn parse(version: u32, bytes: &[u8]) -> Result<Self, PackError> {
        let wrong = |field: &str, found: String, expected: &str| {
            PackError::new(&format!("side table {SOUND}: {field}"), found, expected)
        };
        if version != 1 {
            return Err(wrong("version", version.to_string(), "1"));
        }
        if bytes.len() < HEAD {
            return Err(wrong("length", counted(bytes.len(), "byte"), "at least 24"));
        }
        let word = |at: usize| {
            u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
        };
        let (rate, channels, packet_samples, packets) = (word(0), bytes[4], word(8), word(12));
        if rate != SOUND_RATE {
            return Err(wrong("sample rate", rate.to_string(), "48000"));
        }
        if !(1..=2).contains(&channels) || bytes[5] != 0 {
            let found = format!("{channels}, then {}", bytes[5]);
            return Err(wrong("channels", found, "1 or 2, then 0"));
        }
        if !PACKET_SAMPLES.contains(&packet_samples) {
            return Err(wrong(
                "packet samples",
                packet_samples.to_string(),
                "one Opus frame",
            ));
        }
        let lengths = packets as usize * 2;
        if packets > MOST_PACKETS || bytes.len() - HEAD < lengths {
            return Err(wrong(
                "packets",
                packets.to_string(),
                "as many as there are lengths",
            ));
        }
        let pre_skip = u16::from_le_bytes([bytes[6], bytes[7]]);
        let mut table = Self {
            samples: u64::from(word(16)) | u64::from(word(20)) << 32,
            ..Self::new(channels, pre_skip, packet_samples)
        };
        table.read_packets(&bytes[HEAD..HEAD + lengths], &bytes[HEAD + lengths..])?;
        Ok(table)
    }

    fn read_packets(&mut self, lengths: &[u8], bytes: &[u8]) -> Result<(), PackError> {
        let field = format!("side table {SOUND}: packets");
        let mut end = 0;
        for length in lengths.chunks_exact(2) {
            let length = usize::from(length[0]) | usize::from(length[1]) << 8;
            if length == 0 {
                return Err(PackError::new(
                    &field,
                    "one of no bytes",
                    "at least 1 byte each",
                ));
            }
            end += length;
            self.ends.push(end);
        }
        if end != bytes.len() {
            let expected = counted(bytes.len(), "byte");
            return Err(PackError::new(&field, counted(end, "byte"), expected));
        }
        self.bytes = bytes.to_vec();
        let decoded = self.ends.len() as u64 * u64::from(self.packet_samples);
        if self.samples > decoded.saturating_sub(u64::from(self.pre_skip)) {
            let field = format!("side table {SOUND}: samples");
            let expected = format!("what {} can hold", counted(self.ends.len(), "packet"));
            return Err(PackError::new(&field, self.samples, expected));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn table() -> SoundTable {
        let mut table = SoundTable::new(2, 312, 960);
        for number in 0..5u8 {
            table.push(&vec![number; 3 + usize::from(number)]);
        }
        table.samples = 4000;
        table
    }

    #[test]
    fn a_track_reads_back_as_it_was_written() {
        let (table, bytes) = (table(), table().write());
        assert_eq!(SoundTable::parse(1, &bytes), Ok(table.clone()));
        assert_eq!(table.packet(4), Some(&[4; 7][..]));
        assert_eq!((table.packet(5), table.packets()), (None, 5));
        assert_eq!(table.samples_of(1), 648..1608);
        let empty = SoundTable::new(1, 0, 120);
        assert_eq!(SoundTable::parse(1, &empty.write()), Ok(empty));
    }

    #[test]
    fn a_head_out_of_range_and_a_cut_track_are_refused() {
        let good = table().write();
        assert!(SoundTable::parse(2, &good).is_err());
        for cut in 0..good.len() {
            assert!(SoundTable::parse(1, &good[..cut]).is_err(), "{cut}");
        }
        // The rate, channels, the zero, the packet's samples, the packets, the samples, a length.
        for (at, value) in [
            (0, 1),
            (4, 0),
            (4, 3),
            (5, 1),
            (8, 7),
            (12, 9),
            (15, 255),
            (18, 9),
        ] {
            let mut bad = good.clone();
            bad[at] = value;
            assert!(SoundTable::parse(1, &bad).is_err(), "{at}");
        }
        let mut bad = good;
        (bad[24], bad[26]) = (0, bad[26] + 3);
        assert!(SoundTable::parse(1, &bad).is_err());
    }

    proptest! {
        #[test]
        fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..80)) {
            let _ = SoundTable::parse(1, &bytes);
            let mut near = table().write();
            for (at, byte) in bytes.iter().enumerate().take(near.len()).step_by(7) {
                near[at] = *byte;
            }
            if let Ok(table) = SoundTable::parse(1, &near) {
                assert_eq!(table.write(), near);
            }
        }
    }
}
