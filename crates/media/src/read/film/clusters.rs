//! Which clusters of a Matroska or WebM file are damaged, by what the file says of itself?
//!
//! FFmpeg passes over what it cannot read between clusters, and believes what is in them. But a
//! cluster holds elements that follow each other without gaps, and most writers begin it with a
//! checksum (RFC 8794, section 11.3.1).

use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use crate::plain_file::open_plain;
use crate::read::film::ends::cut_short::{EBML, SEGMENT};

const CLUSTER: u64 = 0x1F43_B675;
const CHECKSUM: u64 = 0xBF;
/// What else a segment holds (RFC 9559): SeekHead, Info, Tracks, Cues, Attachments, Chapters, Tags,
/// and what any element may hold, a gap and a checksum.
const BESIDE: [u64; 9] = [
    0x114D_9B74,
    0x1549_A966,
    0x1654_AE6B,
    0x1C53_BB6B,
    0x1941_A469,
    0x1043_A770,
    0x1254_C367,
    0xEC,
    CHECKSUM,
];
/// What a cluster holds: Timestamp, SimpleBlock, BlockGroup, Position, PrevSize, SilentTracks,
/// EncryptedBlock, and the same.
const INSIDE: [u64; 9] = [0xE7, 0xA3, 0xA0, 0xA7, 0xAB, 0x5854, 0xAF, 0xEC, CHECKSUM];
/// Bytes of a checksum with its head.
const CHECKSUM_BYTES: u64 = 6;
/// Bytes read at once.
const PIECE: usize = 1 << 18;

/// Clusters of a file, and those of them that are damaged or stand where others were lost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Clusters {
    /// All that were found.
    pub all: u64,
    /// Those that are not as they say that they are, and places between them that belong to none.
    pub damaged: u64,
}

/// The clusters of a file; none where it cannot be read.
pub(crate) fn clusters_of(path: &Path) -> Clusters {
    open_plain(path)
        .map(|(file, _)| clusters(BufReader::with_capacity(PIECE, file)))
        .unwrap_or_default()
}

/// The clusters of a file, of which all is read; none in a file that is no Matroska. An end before
/// the one that it gives is no damage.
#[must_use]
pub fn clusters(file: impl Read + Seek) -> Clusters {
    let mut walk = Walk {
        file,
        at: 0,
        end: 0,
        found: Clusters::default(),
    };
    // What cannot be read any more is reported by the reader of the pictures.
    let _ = walk.file();
    walk.found
}

/// An element's head.
#[derive(Clone, Copy)]
struct Head {
    id: u64,
    /// Where it begins, and its contents.
    at: u64,
    inside: u64,
    /// Where its contents end, where that is known.
    end: Option<u64>,
}

struct Walk<F> {
    file: F,
    /// Where the next byte is read, and where the file ends.
    at: u64,
    end: u64,
    found: Clusters,
}

impl<F: Read + Seek> Walk<F> {
    fn file(&mut self) -> std::io::Result<()> {
        self.end = self.file.seek(SeekFrom::End(0))?;
        self.file.seek(SeekFrom::Start(0))?;
        let header = self.head()?;
        let Some((EBML, Some(end))) = header.map(|it| (it.id, it.end)) else {
            return Ok(());
        };
        self.go(end)?;
        if self.head()?.is_none_or(|it| it.id != SEGMENT) {
            return Ok(());
        }
        while let Some(head) = self.head()? {
            match (head.id, head.end) {
                (CLUSTER, _) => self.cluster(head)?,
                (id, Some(end)) if BESIDE.contains(&id) => self.go(end)?,
                // Another segment behind the first.
                (EBML, Some(end)) => self.go(end)?,
                (SEGMENT, _) => {}
                _ => {
                    self.found.damaged += 1;
                    self.go(head.at + 1)?;
                    self.search()?;
                }
            }
        }
        Ok(())
    }

    fn cluster(&mut self, head: Head) -> std::io::Result<()> {
        self.found.all += 1;
        let is_good = match head.end {
            // The file ends in it.
            Some(end) if end > self.end => return self.go(self.end),
            Some(end) => self.is_sound(head.inside, end)? && self.begins_another(end)?,
            None => self.is_sound_up_to_another()?,
        };
        if is_good {
            return Ok(());
        }
        self.found.damaged += 1;
        if let Some(end) = head.end
            && self.begins_another(end)?
        {
            return Ok(());
        }
        self.go(head.inside)?;
        self.search()
    }

    /// Whether at `end`, to which it goes, the file ends or an element begins that follows
    /// clusters.
    fn begins_another(&mut self, end: u64) -> std::io::Result<bool> {
        self.go(end)?;
        let next = self.head()?;
        self.go(end)?;
        Ok(next.is_none_or(|it| is_beside(it.id)))
    }

    /// Whether the contents of a cluster match its checksum, or are elements without gaps.
    fn is_sound(&mut self, inside: u64, end: u64) -> std::io::Result<bool> {
        self.go(inside)?;
        let mut is_first = true;
        while self.at < end {
            let Some(head) = self.head()? else {
                return Ok(false);
            };
            let (true, Some(next)) = (INSIDE.contains(&head.id), head.end) else {
                return Ok(false);
            };
            if is_first && head.id == CHECKSUM && next == inside + CHECKSUM_BYTES {
                let mut told = [0; 4];
                self.file.read_exact(&mut told)?;
                self.at = next;
                return Ok(self.checksum(end)? == u32::from_le_bytes(told));
            }
            is_first = false;
            if next > end {
                return Ok(false);
            }
            self.go(next)?;
        }
        Ok(self.at == end)
    }

    /// The same of a cluster that does not say where it ends, of which only the structure shows it.
    fn is_sound_up_to_another(&mut self) -> std::io::Result<bool> {
        while let Some(head) = self.head()? {
            if is_beside(head.id) && !INSIDE.contains(&head.id) {
                self.go(head.at)?;
                return Ok(true);
            }
            match head.end {
                Some(end) if INSIDE.contains(&head.id) => self.go(end.min(self.end))?,
                _ => return Ok(false),
            }
        }
        Ok(true)
    }

    /// CRC-32 (IEEE) of what lies before `end`.
    fn checksum(&mut self, end: u64) -> std::io::Result<u32> {
        let mut sum = crc32fast::Hasher::new();
        let mut piece = vec![0; PIECE];
        while self.at < end {
            let length = piece.len().min((end - self.at) as usize);
            self.file.read_exact(&mut piece[..length])?;
            sum.update(&piece[..length]);
            self.at += length as u64;
        }
        Ok(sum.finalize())
    }

    /// Goes to the next cluster, or the end.
    fn search(&mut self) -> std::io::Result<()> {
        let mut last = 0_u32;
        let mut piece = vec![0; PIECE];
        loop {
            let length = self.file.read(&mut piece)?;
            if length == 0 {
                return self.go(self.end);
            }
            for (at, byte) in piece[..length].iter().enumerate() {
                last = last << 8 | u32::from(*byte);
                if u64::from(last) == CLUSTER {
                    return self.go(self.at + at as u64 - 3);
                }
            }
            self.at += length as u64;
        }
    }

    /// The head of the next element, whose contents follow; none at the end, or where there is no
    /// room for one. What is no head has the number 0.
    fn head(&mut self) -> std::io::Result<Option<Head>> {
        let at = self.at;
        if at >= self.end {
            return Ok(None);
        }
        let Some((id, _)) = self.number()? else {
            return Ok((self.at < self.end).then(|| self.none(at)));
        };
        let Some((marked, length)) = self.number()? else {
            return Ok((self.at < self.end).then(|| self.none(at)));
        };
        let size = marked & !(1 << (7 * length));
        let is_unknown = size == (1 << (7 * length)) - 1;
        let end = self.at.checked_add(size).filter(|_| !is_unknown);
        Ok(Some(Head {
            id,
            at,
            inside: self.at,
            end,
        }))
    }

    fn none(&self, at: u64) -> Head {
        Head {
            id: 0,
            at,
            inside: self.at,
            end: None,
        }
    }

    /// A number with its length marker, and its length in bytes; none where there is none.
    fn number(&mut self) -> std::io::Result<Option<(u64, u32)>> {
        let mut first = [0];
        if self.file.read(&mut first)? == 0 {
            return Ok(None);
        }
        self.at += 1;
        let length = first[0].leading_zeros() + 1;
        if length > 8 {
            return Ok(None);
        }
        let mut value = u64::from(first[0]);
        for _ in 1..length {
            if self.file.read(&mut first)? == 0 {
                return Ok(None);
            }
            self.at += 1;
            value = value << 8 | u64::from(first[0]);
        }
        Ok(Some((value, length)))
    }

    fn go(&mut self, to: u64) -> std::io::Result<()> {
        let to = to.min(self.end);
        let by = i64::try_from(to).unwrap_or(i64::MAX) - i64::try_from(self.at).unwrap_or(0);
        self.file.seek_relative(by)?;
        self.at = to;
        Ok(())
    }
}

fn is_beside(id: u64) -> bool {
    [CLUSTER, EBML, SEGMENT].contains(&id) || BESIDE.contains(&id)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::io::Cursor;

    fn element(id: u64, inside: &[u8]) -> Vec<u8> {
        let id = id.to_be_bytes();
        let from = id.iter().position(|byte| *byte != 0).unwrap();
        let size = 0x10_00_00_00_u32 | inside.len() as u32;
        [&id[from..], &size.to_be_bytes(), inside].concat()
    }

    fn cluster(number: u8, has_sum: bool) -> Vec<u8> {
        let inside = [element(0xE7, &[number]), element(0xA3, &[number; 40])].concat();
        let sum = crc32fast::hash(&inside).to_le_bytes();
        let sum = [&[0xBF, 0x84][..], &sum].concat();
        match has_sum {
            true => element(CLUSTER, &[sum, inside].concat()),
            false => element(CLUSTER, &inside),
        }
    }

    fn film(has_sums: bool) -> Vec<u8> {
        let parts: Vec<u8> = (1..=4)
            .flat_map(|number| cluster(number, has_sums))
            .collect();
        let parts = [
            element(0x1549_A966, &[1, 2, 3]),
            parts,
            element(0xEC, &[0; 9]),
        ]
        .concat();
        [element(EBML, &[1, 2]), element(SEGMENT, &parts)].concat()
    }

    fn found(bytes: &[u8]) -> [u64; 2] {
        let found = clusters(Cursor::new(bytes));
        [found.all, found.damaged]
    }

    #[test]
    fn what_is_changed_cut_out_or_zeroed_is_found() {
        for has_sums in [true, false] {
            let whole = film(has_sums);
            assert_eq!(found(&whole), [4, 0]);
            // A file that is cut is no damaged one.
            for cut in 1..60 {
                assert_eq!(found(&whole[..whole.len() - cut])[1], 0, "{cut}");
            }
            let third = whole.windows(4).enumerate();
            let third = third.filter(|(_, it)| **it == CLUSTER.to_be_bytes()[4..]);
            let third = third.map(|(at, _)| at).nth(2).unwrap();
            let mut hole = whole.clone();
            hole[third - 3..third + 12].fill(0);
            let [all, damaged] = found(&hole);
            // What is torn may take its neighbour along.
            assert!((2..=3).contains(&all) && damaged > 0, "{all} {damaged}");
            let gone = [&whole[..third + 20], &whole[third + 23..]].concat();
            assert!((1..=2).contains(&found(&gone)[1]), "{has_sums}");
            let mut changed = whole;
            changed[third + 30] ^= 1;
            assert_eq!(found(&changed), [4, u64::from(has_sums)]);
        }
        assert_eq!(found(b"RIFF"), [0, 0]);
    }

    #[test]
    fn a_stream_without_lengths_is_walked_by_its_elements() {
        let mut whole = [element(EBML, &[1]), vec![0x18, 0x53, 0x80, 0x67, 0xFF]].concat();
        for number in 1..4 {
            whole.extend([0x1F, 0x43, 0xB6, 0x75, 0xFF]);
            whole.extend(element(0xE7, &[number]));
            whole.extend(element(0xA3, &[number; 30]));
        }
        assert_eq!(found(&whole), [3, 0]);
        let at = whole.len() - 60;
        let gone = [&whole[..at], &whole[at + 3..]].concat();
        assert!((1..=2).contains(&found(&gone)[1]));
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic_or_stay(
            changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
            cut in any::<prop::sample::Index>(),
        ) {
            let mut bytes = film(true);
            for (at, byte) in changes {
                let at = at.index(bytes.len());
                bytes[at] = byte;
            }
            bytes.truncate(cut.index(bytes.len() + 1));
            let found = clusters(Cursor::new(&bytes));
            prop_assert!(found.all <= bytes.len() as u64);
        }
    }
}
