//! How are the points of a LAZ file unpacked, however damaged it is?
//!
//! Chunk by chunk. What the file says of chunks and of the layers in them is compared with its
//! length before `laz` is given a chunk, for that allocates what it is told.

use super::super::error::Fault;
use super::header::{LasHeader, half_at, word_at};
use laz::laszip::ChunkTable;
use laz::{DecompressionSelection, LasZipDecompressor, LazItemType, LazVlr};
use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Who writes the record that tells how points are packed, and its number.
const LASZIP: &[u8] = b"laszip encoded";
const LASZIP_NUMBER: u16 = 22204;
/// Bytes of what that says before its items, and of an item.
const HEAD_BYTES: usize = 34;
const ITEM_BYTES: usize = 6;
/// Where in it the size of chunks stands.
const CHUNK_SIZE_AT: usize = 12;
/// Stands for chunks of several sizes.
const ANY_SIZE: u32 = u32::MAX;
/// Bytes that say where the table of chunks lies.
const POINTER_BYTES: usize = 8;
/// Bytes that a byte unpacks to at most, beside what may always be: more would be the same point,
/// over and over. Scans of a plain by a machine reach hundreds.
const MOST_UNPACKED: u64 = 2048;
const MOST_FREE: u64 = 1 << 25;
/// Bytes that are unpacked at a time.
const PART_BYTES: usize = 1 << 18;
/// Bytes that may be left of a chunk behind its points: what ends a coder.
const MOST_LEFT: u64 = 16;
/// Most points of a chunk.
const MOST_OF_CHUNK: u64 = 1 << 24;

/// How points are packed: all in one, in chunks, or in chunks of layers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Packing {
    One,
    Chunks,
    Layers,
}

/// A stretch of packed points: where it lies, and how many these are.
struct Chunk<'a> {
    at: usize,
    bytes: &'a [u8],
    points: u64,
    /// Whether its end is not known: then it may have fewer points.
    is_open: bool,
}

/// Unpacks all points and hands them on, record by record.
pub(super) fn read(
    bytes: &[u8],
    header: &LasHeader,
    each: &mut dyn FnMut(&[u8]),
) -> Result<(), Fault> {
    let said = header.record(bytes, LASZIP, LASZIP_NUMBER);
    let said = said.ok_or_else(|| {
        Fault::at(
            "header",
            "points are packed, but no record says how LASzip did it",
        )
    })?;
    let (packing, vlr) = packing_of(said, header)?;
    if packing != Packing::One && is_cut(bytes, header) {
        return read_cut(bytes, header, (said, packing, &vlr), each);
    }
    let room = header.points_end.saturating_sub(header.points_at) as u64;
    if header.count > most_points(header) {
        let what = format!(
            "only {room} bytes follow, of which a point takes {}",
            header.record_bytes
        );
        return Err(header.wrong_count(&what));
    }
    let chunks = match packing {
        Packing::One => vec![Chunk {
            at: header.points_at,
            bytes: &bytes[header.points_at..header.points_end.max(header.points_at)],
            points: header.count,
            is_open: false,
        }],
        _ => chunks(bytes, header, &vlr)?,
    };
    let layers = layers_of(&vlr);
    for (number, chunk) in chunks.iter().enumerate() {
        let fault = |what: String| {
            let place = format!("byte {}, chunk {number} of {}", chunk.at, chunks.len());
            Fault::at(place, what)
        };
        if packing == Packing::Layers {
            check_layers(chunk.bytes, header.record_bytes, layers).map_err(fault)?;
            let told = u64::from(word_at(chunk.bytes, header.record_bytes));
            if told != chunk.points {
                return Err(header.wrong_count(&format!("chunk {number} has {told}")));
            }
        }
        let left = unpack(chunk, (said, header.record_bytes), packing, each).map_err(fault)?;
        if left > MOST_LEFT && packing != Packing::Layers {
            let what = format!("{left} bytes of chunk {number} are left behind them");
            return Err(header.wrong_count(&what));
        }
    }
    Ok(())
}

/// Most points that the bytes there are may unpack to.
fn most_points(header: &LasHeader) -> u64 {
    let room = header.points_end.saturating_sub(header.points_at) as u64;
    MOST_FREE.saturating_add(room.saturating_mul(MOST_UNPACKED)) / header.record_bytes as u64
}

/// Whether a file ends before its table of chunks, or was never finished so that none is told of.
fn is_cut(bytes: &[u8], header: &LasHeader) -> bool {
    let Some(told) = bytes.get(header.points_at..header.points_at + POINTER_BYTES) else {
        return true;
    };
    let table = told.try_into().map_or(0, i64::from_le_bytes);
    let is_there = |at: i64| {
        let at = usize::try_from(at).ok();
        at.is_some_and(|at| at >= header.points_at && at.saturating_add(8) <= bytes.len())
    };
    let at_end = bytes.last_chunk().map_or(0, |it| i64::from_le_bytes(*it));
    !is_there(table) && (table > 0 || !is_there(at_end))
}

/// Unpacks what is there of a file that was cut off before its table of chunks: chunk after chunk,
/// until one fails.
fn read_cut(
    bytes: &[u8],
    header: &LasHeader,
    (said, packing, vlr): (&[u8], Packing, &LazVlr),
    each: &mut dyn FnMut(&[u8]),
) -> Result<(), Fault> {
    if packing == Packing::Chunks && vlr.chunk_size() == ANY_SIZE {
        return table_of_chunks(bytes, header).map(drop);
    }
    let layers = layers_of(vlr);
    let mut left = header.count.min(most_points(header));
    let mut rest = bytes.get(header.points_at + POINTER_BYTES..);
    while let Some(there) = rest.filter(|it| left > 0 && it.len() > header.record_bytes) {
        let (length, points) = if packing == Packing::Layers {
            let Some(found) = layered_chunk(there, header.record_bytes, layers) else {
                break;
            };
            found
        } else {
            let points = u64::from(vlr.chunk_size()).min(left);
            // Packed, points take no more than twice as much.
            let most = 2 * points.saturating_mul(header.record_bytes as u64) + 1024;
            let most = usize::try_from(most).unwrap_or(usize::MAX);
            (there.len().min(most), points)
        };
        if points == 0 || points > left || points > MOST_OF_CHUNK {
            break;
        }
        let chunk = Chunk {
            at: 0,
            bytes: &there[..length],
            points,
            is_open: packing != Packing::Layers,
        };
        let mut unpacked = 0;
        let mut count = |record: &[u8]| {
            unpacked += 1;
            each(record);
        };
        let behind = unpack(&chunk, (said, header.record_bytes), packing, &mut count);
        let (Ok(behind), true) = (behind, unpacked == points) else {
            break;
        };
        left -= points;
        let begin = length - usize::try_from(behind).unwrap_or(0).min(length);
        let begin = if chunk.is_open { begin } else { length };
        // The first point of a chunk is not packed.
        if begin < header.record_bytes {
            break;
        }
        rest = there.get(begin..);
    }
    Ok(())
}

/// How long the chunk of layers is that begins here, and how many points it has; `None` if it does
/// not end here.
fn layered_chunk(there: &[u8], record_bytes: usize, layers: usize) -> Option<(usize, u64)> {
    check_layers(there, record_bytes, layers).ok()?;
    let sizes_at = record_bytes + 4;
    let sizes = (0..layers).map(|layer| word_at(there, sizes_at + 4 * layer) as usize);
    let length = sizes_at + 4 * layers + sizes.sum::<usize>();
    let points = u64::from(word_at(there, record_bytes));
    there.get(..length).map(|chunk| (chunk.len(), points))
}

/// How a record says that points are packed.
fn packing_of(said: &[u8], header: &LasHeader) -> Result<(Packing, LazVlr), Fault> {
    let fault = |what: String| Fault::at("record `laszip encoded`", what);
    if said.len() < HEAD_BYTES {
        return Err(fault(format!(
            "it has {} bytes, of {HEAD_BYTES}",
            said.len()
        )));
    }
    let items = usize::from(half_at(said, HEAD_BYTES - 2));
    if items == 0 || said.len() < HEAD_BYTES + items * ITEM_BYTES {
        return Err(fault(format!(
            "{items} items do not fit into its {} bytes",
            said.len()
        )));
    }
    let packing = match half_at(said, 0) {
        1 => Packing::One,
        2 => Packing::Chunks,
        3 => Packing::Layers,
        other => return Err(fault(format!("packing {other} is none"))),
    };
    let vlr = LazVlr::from_buffer(said).map_err(|error| fault(error.to_string()))?;
    // What an item says of its own size counts where its length is open.
    let is_honest = |item: &laz::LazItem| match item.item_type() {
        LazItemType::Byte(size) | LazItemType::Byte14(size) => item.size() == size,
        LazItemType::Point10 => item.size() == 20,
        LazItemType::GpsTime => item.size() == 8,
        LazItemType::RGB12 | LazItemType::RGB14 => item.size() == 6,
        LazItemType::RGBNIR14 => item.size() == 8,
        LazItemType::WavePacket13 | LazItemType::WavePacket14 => item.size() == 29,
        LazItemType::Point14 => item.size() == 30,
    };
    let first = vlr.items().first().map(laz::LazItem::item_type);
    let begins = match packing {
        Packing::Layers => first == Some(LazItemType::Point14),
        _ => first == Some(LazItemType::Point10),
    };
    let is_whole = vlr.items_size() == header.record_bytes as u64;
    if !(begins && is_whole && vlr.items().iter().all(is_honest)) {
        let what = format!("its items are no point of {} bytes", header.record_bytes);
        return Err(fault(what));
    }
    let versions = vlr.items().iter().map(laz::LazItem::version);
    let is_layered = packing == Packing::Layers;
    if versions.into_iter().any(|it| (it > 2) != is_layered) {
        return Err(fault(
            "the versions of its items do not fit to its packing".to_owned(),
        ));
    }
    Ok((packing, vlr))
}

/// Number of layers in each chunk.
fn layers_of(vlr: &LazVlr) -> usize {
    let layers = vlr.items().iter().map(|item| match item.item_type() {
        LazItemType::Point14 => 9,
        LazItemType::RGBNIR14 => 2,
        LazItemType::Byte14(size) => usize::from(size),
        _ => 1,
    });
    layers.sum()
}

/// Refuses a chunk whose layers do not fit into it.
fn check_layers(chunk: &[u8], record_bytes: usize, layers: usize) -> Result<(), String> {
    let sizes_at = record_bytes + 4;
    let data_at = sizes_at + 4 * layers;
    if chunk.len() < data_at {
        return Err(format!(
            "it has {} bytes, of at least {data_at}",
            chunk.len()
        ));
    }
    let sizes = (0..layers).map(|layer| u64::from(word_at(chunk, sizes_at + 4 * layer)));
    let (all, room) = (sizes.sum::<u64>(), chunk.len() - data_at);
    match all <= room as u64 {
        true => Ok(()),
        false => Err(format!("its layers have {all} bytes, but {room} are left")),
    }
}

/// Where chunks lie, of which there is a table.
fn chunks<'a>(bytes: &'a [u8], header: &LasHeader, vlr: &LazVlr) -> Result<Vec<Chunk<'a>>, Fault> {
    let (table_at, table) = table_of_chunks(bytes, header)?;
    let first = header.points_at + POINTER_BYTES;
    let count = u64::from(word_at(table, 4));
    let fault = |what: String| Fault::at(format!("byte {table_at}, table of chunks"), what);
    if count == 0 || count > header.count || count > (table_at - first) as u64 {
        let what = format!("{count} chunks of {} bytes cannot be", table_at - first);
        return Err(fault(what));
    }
    let is_open = vlr.chunk_size() == ANY_SIZE;
    let entries = ChunkTable::read(&mut Cursor::new(table), is_open);
    let entries = entries.map_err(|error| fault(error.to_string()))?;
    let mut left = header.count;
    let mut at = first;
    let mut chunks = Vec::with_capacity(count as usize);
    for entry in &entries {
        let size = if is_open {
            entry.point_count
        } else {
            u64::from(vlr.chunk_size())
        };
        let points = size.min(left);
        let end = at.checked_add(usize::try_from(entry.byte_count).unwrap_or(usize::MAX));
        let chunk = end
            .filter(|end| *end <= table_at)
            .and_then(|end| bytes.get(at..end));
        let Some(chunk) = chunk else {
            return Err(fault(format!(
                "a chunk of {} bytes does not fit",
                entry.byte_count
            )));
        };
        if size > left && is_open || points == 0 {
            return Err(header.wrong_count("the table of chunks counts others"));
        }
        if points > MOST_OF_CHUNK {
            let what = format!("a chunk of {} bytes has {points} points", chunk.len());
            return Err(fault(what));
        }
        chunks.push(Chunk {
            at,
            bytes: chunk,
            points,
            is_open: false,
        });
        (left, at) = (left - points, at + chunk.len());
    }
    match left {
        0 => Ok(chunks),
        _ => Err(header.wrong_count("the table of chunks counts fewer")),
    }
}

/// Where the table of chunks lies, and what is there.
fn table_of_chunks<'a>(bytes: &'a [u8], header: &LasHeader) -> Result<(usize, &'a [u8]), Fault> {
    let first = header.points_at + POINTER_BYTES;
    let pointer = |at: usize| {
        let told = bytes.get(at..at + POINTER_BYTES)?.try_into().ok()?;
        let table = usize::try_from(i64::from_le_bytes(told)).ok()?;
        (table >= first).then_some(table)
    };
    // Who wrote without going back left the pointer at the end.
    let at_end = || pointer(bytes.len().checked_sub(POINTER_BYTES)?);
    let at = pointer(header.points_at).or_else(at_end);
    let table = at.and_then(|at| Some((at, bytes.get(at..)?)));
    let whole = table.filter(|(_, table)| table.len() >= POINTER_BYTES);
    whole.ok_or_else(|| {
        let what = "the table of chunks is missing: the file was cut short, or never finished";
        Fault::at(format!("byte {}", header.points_at), what)
    })
}

/// Unpacks the records of a chunk, some at a time, and returns how many bytes of it are left.
fn unpack(
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
    let kept = DecompressionSelection::xy_returns_channel()
        .decompress_z()
        .decompress_intensity()
        .decompress_classification()
        .decompress_rgb();
    let unpacked = || {
        let mut unpacking = LasZipDecompressor::selective(Cursor::new(file), vlr, kept)
            .map_err(|error| error.to_string())?;
        let at_once = match chunk.is_open {
            true => 1,
            false => (PART_BYTES / record_bytes).max(1) as u64,
        };
        let mut records = vec![0; at_once.min(chunk.points) as usize * record_bytes];
        let mut left = chunk.points;
        while left > 0 {
            let part = &mut records[..at_once.min(left) as usize * record_bytes];
            let unpacked = unpacking.decompress_many(part);
            // What reads beyond the end is made up.
            let is_there = unpacked.is_ok() && unpacking.get_mut().position() <= end;
            if chunk.is_open && !is_there {
                break;
            }
            unpacked
                .map_err(|error| format!("its {} points end too early: {error}", chunk.points))?;
            part.chunks_exact(record_bytes).for_each(&mut *each);
            left -= at_once.min(left);
        }
        Ok(end.saturating_sub(unpacking.into_inner().position()))
    };
    // It takes for granted that what a coder tells is in range, and unwinds where it is not; what
    // came before is dropped with the file.
    let unwound = |_| Err("it is damaged".to_owned());
    catch_unwind(AssertUnwindSafe(unpacked)).unwrap_or_else(unwound)
}
