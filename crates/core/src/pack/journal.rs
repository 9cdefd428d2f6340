//! How far is a pack that is not finished, and what was it being made from?
//!
//! A journal lies next to the pack while it grows: who makes it from what, then a step each time
//! that all levels begin a new group. What a step says lies on disk before the step does, so
//! whatever stops the work, all up to the last whole step is good. `docs/formats/pack.md` has the
//! bytes, and every one is under a checksum.

use crate::pack::{PackError, check_crc, u32_at};
use crate::units::counted;
use serde::{Deserialize, Serialize};

/// The first eight bytes of every journal.
pub const JOURNAL_MAGIC: [u8; 8] = *b"FOVEALJ\n";
/// Bytes before the payload of a block: its length and its checksum.
const BLOCK_HEAD: usize = 8;

/// What must be the same for work to go on, and for a pack to be the one that is asked for.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// Program and libraries, with their versions.
    pub program: String,
    /// The input, so that another or a changed one differs.
    pub input: String,
    /// Everything else that decides the bytes of the pack.
    pub settings: String,
}

/// What differs first between two identities.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Difference {
    /// Another program, or one with other libraries.
    Program,
    /// Another input, or it has changed.
    Input,
    /// Other settings.
    Settings,
}

impl Identity {
    /// What differs between this and what is asked for now; `None` when nothing does.
    #[must_use]
    pub fn difference(&self, now: &Self) -> Option<Difference> {
        if self.program != now.program {
            Some(Difference::Program)
        } else if self.input != now.input {
            Some(Difference::Input)
        } else if self.settings != now.settings {
            Some(Difference::Settings)
        } else {
            None
        }
    }
}

/// What content calls a chunk before its units are numbered: ten bytes that mean something to its
/// kind only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChunkName(pub [u8; 10]);

/// A chunk that lies in the pack, right behind the one before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlacedChunk {
    /// Which chunk it is.
    pub name: ChunkName,
    /// Its length in bytes.
    pub bytes: u32,
    /// Its checksum.
    pub crc32c: u32,
}

/// What was added since the step before.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct JournalStep {
    /// Frames that are coded by now.
    pub frames: u32,
    /// Times of the frames that are new, nanoseconds after the first frame.
    pub times: Vec<i64>,
    /// Chunks that are new, in the order of the file.
    pub chunks: Vec<PlacedChunk>,
    /// New rows of side tables, in an order of the writer's.
    pub rows: Vec<Vec<u8>>,
}

/// A journal as far as it is whole.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Journal {
    /// What is being made.
    pub identity: Identity,
    /// Its steps.
    pub steps: Vec<JournalStep>,
    /// Bytes of all that; what follows was torn off in writing.
    pub bytes: u64,
}

impl Journal {
    /// Reads a journal; a torn or damaged step ends it, and all before it count.
    ///
    /// # Errors
    /// It is no journal, or its beginning is damaged.
    pub fn parse(bytes: &[u8]) -> Result<Self, PackError> {
        if bytes.get(..8) != Some(&JOURNAL_MAGIC) {
            let found = bytes[..bytes.len().min(8)].escape_ascii();
            return Err(PackError::new("journal magic", found, "FOVEALJ\\n"));
        }
        let (head, mut rest) = block("journal identity", &bytes[8..])?;
        let mut journal = Self {
            identity: Identity::parse(head)?,
            ..Self::default()
        };
        while let Ok((payload, after)) = block("journal step", rest) {
            match JournalStep::parse(payload) {
                Ok(step) => journal.steps.push(step),
                Err(_) => break,
            }
            rest = after;
        }
        journal.bytes = (bytes.len() - rest.len()) as u64;
        Ok(journal)
    }
}

impl Identity {
    /// The beginning of a journal.
    #[must_use]
    pub fn write(&self) -> Vec<u8> {
        let mut payload = Vec::new();
        for text in [&self.program, &self.input, &self.settings] {
            write_row(&mut payload, text.as_bytes());
        }
        [&JOURNAL_MAGIC[..], &with_head(&payload)].concat()
    }

    fn parse(payload: &[u8]) -> Result<Self, PackError> {
        let mut reader = Reader(payload);
        let mut text = || {
            let row = reader.row()?;
            let text = String::from_utf8(row);
            text.map_err(|e| PackError::new("journal identity", e, "UTF-8"))
        };
        let identity = Self {
            program: text()?,
            input: text()?,
            settings: text()?,
        };
        reader.end()?;
        Ok(identity)
    }
}

impl JournalStep {
    /// The block that is appended to a journal.
    #[must_use]
    pub fn write(&self) -> Vec<u8> {
        let mut payload = Vec::new();
        let number = |payload: &mut Vec<u8>, n: u32| payload.extend_from_slice(&n.to_le_bytes());
        number(&mut payload, self.frames);
        number(&mut payload, self.times.len() as u32);
        for time in &self.times {
            payload.extend_from_slice(&time.to_le_bytes());
        }
        number(&mut payload, self.chunks.len() as u32);
        for chunk in &self.chunks {
            payload.extend_from_slice(&chunk.name.0);
            for n in [chunk.bytes, chunk.crc32c] {
                number(&mut payload, n);
            }
        }
        number(&mut payload, self.rows.len() as u32);
        self.rows
            .iter()
            .for_each(|row| write_row(&mut payload, row));
        with_head(&payload)
    }

    fn parse(payload: &[u8]) -> Result<Self, PackError> {
        let mut reader = Reader(payload);
        let frames = reader.number()?;
        let times = reader.list(|reader| Ok(i64::from_le_bytes(reader.array()?)))?;
        let chunks = reader.list(Reader::chunk)?;
        let rows = reader.list(Reader::row)?;
        reader.end()?;
        Ok(Self {
            frames,
            times,
            chunks,
            rows,
        })
    }
}

fn write_row(payload: &mut Vec<u8>, row: &[u8]) {
    payload.extend_from_slice(&(row.len() as u32).to_le_bytes());
    payload.extend_from_slice(row);
}

fn with_head(payload: &[u8]) -> Vec<u8> {
    let mut block = Vec::with_capacity(BLOCK_HEAD + payload.len());
    block.extend_from_slice(&(payload.len() as u32).to_le_bytes());
    block.extend_from_slice(&crc32c::crc32c(payload).to_le_bytes());
    block.extend_from_slice(payload);
    block
}

/// The payload of the first block, and what follows the block.
fn block<'a>(field: &str, bytes: &'a [u8]) -> Result<(&'a [u8], &'a [u8]), PackError> {
    let short = || {
        PackError::new(
            field,
            format!("{} left", counted(bytes.len(), "byte")),
            "a whole block",
        )
    };
    if bytes.len() < BLOCK_HEAD {
        return Err(short());
    }
    let length = u32_at(bytes, 0) as usize;
    if bytes.len() - BLOCK_HEAD < length {
        return Err(short());
    }
    let (payload, after) = bytes[BLOCK_HEAD..].split_at(length);
    check_crc(field, payload, u32_at(bytes, 4))?;
    Ok((payload, after))
}

/// Takes a payload apart from its front.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn take(&mut self, count: usize) -> Result<&[u8], PackError> {
        if count > self.0.len() {
            let found = format!("{} left", counted(self.0.len(), "byte"));
            return Err(PackError::new("journal block", found, count));
        }
        let (taken, rest) = self.0.split_at(count);
        self.0 = rest;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], PackError> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N)?);
        Ok(array)
    }

    fn number(&mut self) -> Result<u32, PackError> {
        Ok(u32::from_le_bytes(self.array()?))
    }

    fn row(&mut self) -> Result<Vec<u8>, PackError> {
        let length = self.number()? as usize;
        Ok(self.take(length)?.to_vec())
    }

    fn chunk(&mut self) -> Result<PlacedChunk, PackError> {
        Ok(PlacedChunk {
            name: ChunkName(self.array()?),
            bytes: self.number()?,
            crc32c: self.number()?,
        })
    }

    /// A counted list; grows as it is read, so that no count is believed.
    fn list<T>(
        &mut self,
        mut item: impl FnMut(&mut Self) -> Result<T, PackError>,
    ) -> Result<Vec<T>, PackError> {
        let count = self.number()?;
        (0..count).map(|_| item(self)).collect()
    }

    fn end(&self) -> Result<(), PackError> {
        match self.0.len() {
            0 => Ok(()),
            left => Err(PackError::new(
                "journal block",
                counted(left, "further byte"),
                "none",
            )),
        }
    }
}

/// Takes any bytes for a journal: the body of the fuzz target.
pub fn read_any_journal(data: &[u8]) {
    let Ok(journal) = Journal::parse(data) else {
        return;
    };
    let mut again = journal.identity.write();
    journal
        .steps
        .iter()
        .for_each(|step| again.extend(step.write()));
    assert_eq!(
        again,
        data[..journal.bytes as usize],
        "what was read writes back otherwise"
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn identity() -> Identity {
        Identity {
            program: "foveal 1".into(),
            input: "a.mkv, 12 bytes".into(),
            settings: "vp9".into(),
        }
    }

    fn step(frames: u32) -> JournalStep {
        let chunk = PlacedChunk {
            name: ChunkName([1, 5, 44, 1, 2, 0, frames as u8, 0, 0, 0]),
            bytes: 77,
            crc32c: 0x0102_0304,
        };
        JournalStep {
            frames,
            times: vec![0, -3, 1 << 40],
            chunks: vec![chunk; 3],
            rows: vec![vec![1, 2], Vec::new()],
        }
    }

    fn written() -> Vec<u8> {
        [identity().write(), step(8).write(), step(16).write()].concat()
    }

    #[test]
    fn a_journal_reads_back_as_it_was_written() {
        let bytes = written();
        let journal = Journal::parse(&bytes).unwrap();
        assert_eq!(journal.identity, identity());
        assert_eq!(journal.steps, [step(8), step(16)]);
        assert_eq!(journal.bytes, bytes.len() as u64);
    }

    #[test]
    fn what_was_torn_off_takes_nothing_before_it_along() {
        let bytes = written();
        let [head, one] = [identity().write().len(), step(8).write().len()];
        for cut in 0..bytes.len() {
            match Journal::parse(&bytes[..cut]) {
                Err(_) => assert!(cut < head, "{cut}"),
                Ok(journal) => {
                    let whole = (cut - head) / one;
                    assert_eq!(journal.steps.len(), whole);
                    assert_eq!(journal.bytes as usize, head + whole * one);
                }
            }
        }
    }

    #[test]
    fn any_changed_byte_is_found() {
        let bytes = written();
        for at in 0..bytes.len() {
            let mut bad = bytes.clone();
            bad[at] ^= 1;
            let Ok(journal) = Journal::parse(&bad) else {
                continue;
            };
            assert!(journal.steps.len() < 2, "byte {at}");
            assert_eq!(journal.identity, identity(), "byte {at}");
        }
    }

    #[test]
    fn a_difference_is_named() {
        let was = identity();
        assert_eq!(was.difference(&identity()), None);
        let changed = Identity {
            input: "b.mkv".into(),
            ..identity()
        };
        assert_eq!(was.difference(&changed), Some(Difference::Input));
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic(tail in prop::collection::vec(any::<u8>(), 0..80)) {
            read_any_journal(&tail);
            read_any_journal(&[&JOURNAL_MAGIC[..], &tail].concat());
            read_any_journal(&[written(), with_head(&tail)].concat());
        }
    }
}
