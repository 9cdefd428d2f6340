//! Which points do some packed bytes hold, whose number may be unknown?

use super::records::Records;
use laz::{DecompressionSelection, LasZipCompressor, LasZipDecompressor, LazVlr};
use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Bytes that say where the table of chunks lies.
pub(super) const POINTER_BYTES: usize = 8;
/// Where in the record that says how points are packed the size of chunks stands.
const CHUNK_SIZE_AT: usize = 12;
/// Bytes that are unpacked at a time.
const PART_BYTES: usize = 1 << 18;
/// Points of a last chunk beyond those that surely exist, of which some may.
const MOST_BEYOND: u64 = 4096;
/// Most points that are packed again to find out.
const MOST_PACKED: u64 = 1 << 24;
/// Most bytes of them.
const MOST_RAW: u64 = 1 << 28;
/// So much longer or shorter the packed bytes of a few more points may be, by how a coder ends.
const SLACK: usize = 4;

/// How points are packed: all in one, in chunks, or in chunks of layers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Packing {
    One,
    Chunks,
    Layers,
}

/// A stretch of packed points: where it lies, and how many these are.
pub(super) struct Chunk<'a> {
    pub(super) at: usize,
    pub(super) bytes: &'a [u8],
    pub(super) points: u64,
}

impl Chunk<'_> {
    /// Which of so many chunks it is, and where, in words.
    pub(super) fn place(&self, number: usize, of: usize) -> String {
        format!("byte {}, chunk {number} of {of}", self.at)
    }
}

/// What of a point is unpacked.
fn kept() -> DecompressionSelection {
    DecompressionSelection::xy_returns_channel()
        .decompress_z()
        .decompress_intensity()
        .decompress_classification()
        .decompress_rgb()
}

/// Unpacks at most so many points from the start of bytes that may end early, until so many bytes
/// are read. Returns how many there are, how many bytes they took, and why no more came.
pub(super) fn unpack_until_end(
    bytes: &[u8],
    said: &[u8],
    (most, until): (u64, u64),
    records: &mut Records,
) -> (u64, usize, Option<String>) {
    let mut points = 0;
    let mut unpacked = || -> Result<usize, String> {
        let vlr = LazVlr::from_buffer(said).map_err(|error| error.to_string())?;
        let mut record = vec![0; vlr.items_size() as usize];
        let mut unpacking = LasZipDecompressor::selective(Cursor::new(bytes), vlr, kept())
            .map_err(|error| error.to_string())?;
        while points < most && unpacking.get().position() <= until {
            let one = unpacking.decompress_one(&mut record);
            one.map_err(|error| format!("they end after {points} points: {error}"))?;
            records.add(&record);
            points += 1;
        }
        Ok(unpacking.into_inner().position() as usize)
    };
    let unwound = |_| Err("it is damaged".to_owned());
    let taken = catch_unwind(AssertUnwindSafe(&mut unpacked)).unwrap_or_else(unwound);
    match taken {
        Ok(taken) => (points, taken, None),
        Err(why) => (points, 0, Some(why)),
    }
}

/// Unpacks the records of a chunk, some at a time, and returns how many bytes of it are left.
pub(super) fn unpack(
    chunk: &Chunk<'_>,
    (said, record_bytes): (&[u8], usize),
    packing: Packing,
    each: &mut dyn FnMut(&[u8]),
) -> Result<u64, String> {
    // As a file of one chunk: a pointer to its table, the chunk, and a table of none.
    let mut file = Vec::with_capacity(chunk.bytes.len() + 2 * POINTER_BYTES);
    if packing != Packing::One {
        file.extend(((POINTER_BYTES + chunk.bytes.len()) as u64).to_le_bytes());
    }
    file.extend(chunk.bytes);
    let end = file.len() as u64;
    file.extend([0; POINTER_BYTES]);
    let mut said = said.to_vec();
    let size = (chunk.points as u32).to_le_bytes();
    said[CHUNK_SIZE_AT..CHUNK_SIZE_AT + 4].copy_from_slice(&size);
    let vlr = LazVlr::from_buffer(said).map_err(|error| error.to_string())?;
    let unpacked = || {
        let mut unpacking = LasZipDecompressor::selective(Cursor::new(file), vlr, kept())
            .map_err(|error| error.to_string())?;
        let at_once = (PART_BYTES / record_bytes).max(1) as u64;
        let mut records = vec![0; at_once.min(chunk.points) as usize * record_bytes];
        let mut left = chunk.points;
        while left > 0 {
            let part = &mut records[..at_once.min(left) as usize * record_bytes];
            unpacking
                .decompress_many(part)
                .map_err(|error| format!("its {} points end too early: {error}", chunk.points))?;
            part.chunks_exact(record_bytes).for_each(&mut *each);
            left -= at_once.min(left);
        }
        Ok(end.saturating_sub(unpacking.into_inner().position()))
    };
    // It takes for granted that what a coder gives is in range, and unwinds where it is not; what
    // came before is dropped with the file.
    let unwound = |_| Err("it is damaged".to_owned());
    catch_unwind(AssertUnwindSafe(unpacked)).unwrap_or_else(unwound)
}

/// The records of a chunk of which so many surely exist: as many as, packed again, give the same
/// bytes. `None` where no number of them does, or several do.
pub(super) fn number_of_last(
    chunk: &Chunk<'_>,
    said: &[u8],
    record_bytes: usize,
    sure: u64,
) -> Option<Vec<u8>> {
    if (sure + MOST_BEYOND).saturating_mul(record_bytes as u64) > MOST_RAW {
        return None;
    }
    let mut raw = unpack_raw(chunk.bytes, said, sure + MOST_BEYOND)?;
    let (mut low, mut high) = (sure as usize, raw.len() / record_bytes);
    let mut spent = 0;
    let mut packed = |points: usize| {
        spent += points as u64;
        (spent <= MOST_PACKED).then(|| pack(&raw[..points * record_bytes], said))?
    };
    let wanted = chunk.bytes.len();
    while low < high {
        let middle = low.midpoint(high);
        match packed(middle)?.len() + SLACK < wanted {
            true => low = middle + 1,
            false => high = middle,
        }
    }
    let mut found = None;
    for points in low..=raw.len() / record_bytes {
        let bytes = packed(points)?;
        if bytes == chunk.bytes && found.replace(points).is_some() {
            return None;
        }
        if bytes.len() > wanted + SLACK {
            break;
        }
    }
    raw.truncate(found? * record_bytes);
    Some(raw)
}

/// At most so many whole records from the start of a chunk.
fn unpack_raw(bytes: &[u8], said: &[u8], most: u64) -> Option<Vec<u8>> {
    let mut said = said.to_vec();
    // One chunk to the end.
    said[..2].copy_from_slice(&1_u16.to_le_bytes());
    let mut all = Vec::new();
    let unpacked = || {
        let vlr = LazVlr::from_buffer(&*said).ok()?;
        let mut record = vec![0; vlr.items_size() as usize];
        let mut unpacking = LasZipDecompressor::new(Cursor::new(bytes), vlr).ok()?;
        for _ in 0..most {
            if unpacking.decompress_one(&mut record).is_err() {
                break;
            }
            all.extend_from_slice(&record);
        }
        Some(())
    };
    catch_unwind(AssertUnwindSafe(unpacked)).ok()??;
    Some(all)
}

/// The bytes of a chunk of these records.
fn pack(raw: &[u8], said: &[u8]) -> Option<Vec<u8>> {
    let mut file = Cursor::new(Vec::new());
    let mut said = said.to_vec();
    // One chunk, however many there are.
    said[CHUNK_SIZE_AT..CHUNK_SIZE_AT + 4].copy_from_slice(&(u32::MAX - 1).to_le_bytes());
    let vlr = LazVlr::from_buffer(&*said).ok()?;
    let mut packing = LasZipCompressor::new(&mut file, vlr).ok()?;
    packing.compress_many(raw).ok()?;
    packing.done().ok()?;
    drop(packing);
    let file = file.into_inner();
    let table = file.get(..POINTER_BYTES)?.try_into().ok()?;
    let table = usize::try_from(i64::from_le_bytes(table)).ok()?;
    file.get(POINTER_BYTES..table).map(<[u8]>::to_vec)
}
