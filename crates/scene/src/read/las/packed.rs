//! How are the points of a LAZ file unpacked, however damaged it is?
//!
//! Chunk by chunk. What the file says of chunks and of the layers in them is compared with its
//! length before `laz` is given a chunk, which allocates what it is asked to.

use super::super::error::Fault;
use super::header::{LasHeader, bounds_of, half_at, word_at};
use super::mends::LasMends;
use super::records::Records;
use super::unpacking::{Chunk, POINTER_BYTES, Packing, number_of_last, unpack, unpack_until_end};
use foveal_core::units::counted;
use laz::laszip::ChunkTable;
use laz::{LazItemType, LazVlr};
use std::cmp::Ordering;
use std::io::Cursor;

/// Who writes the record that says how points are packed, and its number.
const LASZIP: &[u8] = b"laszip encoded";
const LASZIP_NUMBER: u16 = 22204;
/// Bytes of what that says before its items, and of an item.
const HEAD_BYTES: usize = 34;
const ITEM_BYTES: usize = 6;
/// Stands for chunks of several sizes.
const ANY_SIZE: u32 = u32::MAX;
/// Bytes that a byte unpacks to at most, besides what may always be: more would be the same point,
/// over and over. Scans of a plain by a machine reach hundreds.
const MOST_UNPACKED: u64 = 2048;
const MOST_FREE: u64 = 1 << 25;
/// Bytes that may be left of a chunk behind its points: what ends a coder.
const MOST_LEFT: u64 = 16;
/// Most points of a chunk.
const MOST_OF_CHUNK: u64 = 1 << 24;

/// How the points of a file are packed.
struct Packed<'a> {
    packing: Packing,
    vlr: LazVlr,
    /// What the file says of it.
    said: &'a [u8],
    record_bytes: usize,
    /// Where the header says that points lie, grown by its own size; `None` where it says nothing.
    bounds: Option<[[f64; 2]; 3]>,
}

/// Whether a record says how the points are packed.
pub(super) fn is_explained(bytes: &[u8], header: &LasHeader) -> bool {
    header.record(bytes, LASZIP, LASZIP_NUMBER).is_some()
}

/// Unpacks all points, record by record; a chunk that is damaged, or that is not there, costs its
/// points.
pub(super) fn read(
    bytes: &[u8],
    header: &LasHeader,
    records: &mut Records,
    mends: &mut LasMends,
) -> Result<(), Fault> {
    let said = header.record(bytes, LASZIP, LASZIP_NUMBER);
    let said = said.ok_or_else(|| {
        Fault::at(
            "header",
            "points are packed, but no record says how LASzip did it",
        )
    })?;
    let (packing, vlr) = packing_of(said, header)?;
    let packed = Packed {
        packing,
        vlr,
        said,
        record_bytes: header.record_bytes,
        bounds: grown_bounds(bytes),
    };
    let end = header.points_end.max(header.points_at).min(bytes.len());
    let (bytes_of_points, in_one) = (&bytes[..end], packing == Packing::One);
    if in_one && !header.is_counted {
        let found = "the header counts no points, and how many are packed is unknown".to_owned();
        return Err(Fault::Empty { found });
    }
    if !in_one {
        let table = table_of_chunks(bytes, header);
        let chunks = table.and_then(|table| packed.chunks(bytes, header, table));
        let fault = match chunks {
            Ok(chunks) => return packed.all_of(&chunks, header, records, mends),
            Err(fault) => fault,
        };
        if packing == Packing::Chunks && packed.vlr.chunk_size() == ANY_SIZE {
            return Err(fault);
        }
        mends.stale_count("the table of chunks is missing, or damaged".to_owned());
        if packing == Packing::Layers {
            let chunks = packed.layered_chunks(bytes_of_points, header);
            let found = packed.all_of(&chunks, header, records, mends);
            return found.map_err(|_| fault);
        }
    }
    let found = packed.in_turn(bytes_of_points, header, records)?;
    let why = "the file ends early, or is damaged";
    if header.is_counted {
        mends.miss(header.count - found, header.count, why);
    }
    Ok(())
}

impl Packed<'_> {
    /// Most points that so many bytes can be.
    fn most_points(&self, bytes: usize) -> u64 {
        let most = MOST_FREE.saturating_add((bytes as u64).saturating_mul(MOST_UNPACKED));
        most / self.record_bytes as u64
    }

    /// Unpacks chunks that a table lists.
    fn all_of(
        &self,
        chunks: &[Chunk<'_>],
        header: &LasHeader,
        records: &mut Records,
        mends: &mut LasMends,
    ) -> Result<(), Fault> {
        let mut all: u64 = chunks.iter().map(|chunk| chunk.points).sum();
        let bytes: usize = chunks.iter().map(|chunk| chunk.bytes.len()).sum();
        if all > self.most_points(bytes) {
            let what = format!("its chunks {all}, which cannot be in {bytes} bytes");
            return Err(header.wrong_count(&what));
        }
        let is_equal = self.packing == Packing::Chunks && self.vlr.chunk_size() != ANY_SIZE;
        let mut first_fault = None;
        let (mut lost, mut broken, mut is_known) = (0, 0, false);
        for (number, chunk) in chunks.iter().enumerate() {
            let before = records.len();
            let is_last = is_equal && number + 1 == chunks.len();
            // How many the last chunk has is not known where the header counts too many.
            let is_endless = is_last && all < header.count;
            let read = match is_endless {
                true => Err("the header counts more points than chunks can hold".to_owned()),
                false => self.one(chunk, records),
            };
            match read {
                Ok(left) => self.tell_left(left, header, mends),
                Err(_) if is_endless && self.is_whole(chunk, header, records) => {
                    all = all - chunk.points + (records.len() - before) as u64;
                    is_known = true;
                }
                Err(what) if is_last => {
                    records.truncate(before);
                    let found = self.surely(chunk, records);
                    match self.first_stray(before, header, records) {
                        // A coder that has lost its way goes on with points anywhere.
                        Some(stray) => {
                            records.truncate(stray);
                            let kept = (stray - before) as u64;
                            (lost, broken) = (lost + chunk.points - kept, broken + 1);
                            let place = chunk.place(number, chunks.len());
                            first_fault.get_or_insert((place, what));
                        }
                        None => all = all - chunk.points + found,
                    }
                }
                Err(what) => {
                    records.truncate(before);
                    (lost, broken) = (lost + chunk.points, broken + 1);
                    first_fault.get_or_insert((chunk.place(number, chunks.len()), what));
                }
            }
        }
        match first_fault {
            Some((place, what)) if records.len() == 0 => return Err(Fault::at(place, what)),
            Some((place, what)) => {
                let damaged = counted(broken, "chunk");
                let why = format!("{damaged} damaged, first {place}: {what}");
                mends.miss(lost, header.count, &why);
            }
            None if records.len() == 0 => {
                return Err(header.wrong_count("there is no whole chunk of them"));
            }
            None => {}
        }
        if header.is_counted || !is_known {
            tell_count(all, header, mends);
        }
        Ok(())
    }

    /// Reports bytes of a chunk that are left behind its points.
    fn tell_left(&self, left: u64, header: &LasHeader, mends: &mut LasMends) {
        if left > MOST_LEFT && self.packing != Packing::Layers {
            mends.leave_behind(left as usize, header.count);
        }
    }

    /// Unpacks the points of a chunk of unknown number, if packing them again shows how many there
    /// are and none lies far outside; else leaves the records as they are.
    fn is_whole(&self, chunk: &Chunk<'_>, header: &LasHeader, records: &mut Records) -> bool {
        let before = records.len();
        let sure = self.surely(chunk, records);
        records.truncate(before);
        let Some(all) = number_of_last(chunk, self.said, self.record_bytes, sure) else {
            return false;
        };
        all.chunks_exact(self.record_bytes)
            .for_each(|record| records.add(record));
        let is_near = self.first_stray(before, header, records).is_none();
        if !is_near {
            records.truncate(before);
        }
        is_near
    }

    /// Unpacks the points of a chunk of unknown number that surely are there: those that come
    /// before its last few bytes, since a coder goes on with any. Returns how many these are.
    fn surely(&self, chunk: &Chunk<'_>, records: &mut Records) -> u64 {
        let mut said = self.said.to_vec();
        // One chunk to the end.
        said[..2].copy_from_slice(&1_u16.to_le_bytes());
        let most = self.most_points(chunk.bytes.len()).min(MOST_OF_CHUNK);
        let most = most.min(u64::from(self.vlr.chunk_size()));
        let end = chunk.bytes.len() as u64;
        unpack_until_end(
            chunk.bytes,
            &said,
            (most, end.saturating_sub(MOST_LEFT)),
            records,
        )
        .0
    }

    /// The first point from `begin` on that lies far outside the header's bounds.
    fn first_stray(&self, begin: usize, header: &LasHeader, records: &Records) -> Option<usize> {
        let bounds = self.bounds?;
        let is_stray = |place: &[i32; 3]| {
            (0..3).any(|k| {
                let at = f64::from(place[k]) * header.scale[k] + header.offset[k];
                !(bounds[k][0]..=bounds[k][1]).contains(&at)
            })
        };
        let stray = records.places()[begin..].iter().position(is_stray);
        stray.map(|at| begin + at)
    }

    /// Unpacks a chunk, and returns how many bytes of it are left.
    fn one(&self, chunk: &Chunk<'_>, records: &mut Records) -> Result<u64, String> {
        if self.packing == Packing::Layers {
            check_layers(chunk.bytes, self.record_bytes, layers_of(&self.vlr))?;
        }
        if chunk.points > self.most_points(chunk.bytes.len()) {
            let [points, bytes] = [chunk.points, chunk.bytes.len() as u64];
            return Err(format!("{points} points cannot be in {bytes} bytes"));
        }
        let said = (self.said, self.record_bytes);
        unpack(chunk, said, self.packing, &mut |record| records.add(record))
    }

    /// The chunks of layers that follow each other, which no table lists: each says itself how
    /// long it is.
    fn layered_chunks<'b>(&self, bytes: &'b [u8], header: &LasHeader) -> Vec<Chunk<'b>> {
        let sizes_at = self.record_bytes + 4;
        let layers = layers_of(&self.vlr);
        let (mut chunks, mut at) = (Vec::new(), header.points_at + POINTER_BYTES);
        let mut left = header.count;
        while left > 0 {
            let Some(head) = bytes.get(at..at + sizes_at + 4 * layers) else {
                break;
            };
            let sizes = (0..layers).map(|layer| word_at(head, sizes_at + 4 * layer) as usize);
            let Some(chunk) = bytes.get(at..at + head.len() + sizes.sum::<usize>()) else {
                break;
            };
            let points = u64::from(word_at(head, self.record_bytes));
            if points == 0 || points > left.min(MOST_OF_CHUNK) {
                break;
            }
            chunks.push(Chunk {
                at,
                bytes: chunk,
                points,
            });
            (left, at) = (left - points, at + chunk.len());
        }
        chunks
    }

    /// Unpacks points one after the other until there are no more bytes, where no table lists
    /// chunks. Returns how many these are; none is an error.
    fn in_turn(
        &self,
        bytes: &[u8],
        header: &LasHeader,
        records: &mut Records,
    ) -> Result<u64, Fault> {
        let of_chunk = match self.packing {
            Packing::One => u64::MAX,
            _ => u64::from(self.vlr.chunk_size()).clamp(1, MOST_OF_CHUNK),
        };
        let mut said = self.said.to_vec();
        // One chunk to the end.
        said[..2].copy_from_slice(&1_u16.to_le_bytes());
        let mut at = header.points_at
            + match self.packing {
                Packing::One => 0,
                _ => POINTER_BYTES,
            };
        let most = self.most_points(bytes.len().saturating_sub(at));
        let mut left = header.count.min(most);
        let mut what = "there are no bytes of them".to_owned();
        while let Some(rest) = bytes.get(at..).filter(|rest| left > 0 && !rest.is_empty()) {
            let (points, taken, ended) =
                unpack_until_end(rest, &said, (left.min(of_chunk), u64::MAX), records);
            (left, at) = (left - points, at + taken);
            if let Some(why) = ended {
                what = why;
                break;
            }
        }
        let found = header.count.min(most) - left;
        match found {
            0 => Err(header.wrong_count(&what)),
            _ => Ok(found),
        }
    }
}

/// Reports where chunks hold another number of points than the header counts.
fn tell_count(all: u64, header: &LasHeader, mends: &mut LasMends) {
    match all.cmp(&header.count) {
        Ordering::Less if !header.is_counted => mends.remark(
            "how many points the last chunk has is unknown: a few at its end may be missing"
                .to_owned(),
        ),
        Ordering::Less => {
            let why = "the file ends early, or its chunks hold fewer";
            mends.miss(header.count - all, header.count, why);
        }
        Ordering::Greater => mends.stale_count(format!(
            "the header counts {} points, and its chunks {all}, which are shown",
            header.count
        )),
        Ordering::Equal => {}
    }
}

/// The bounds in the header, most before least, grown by their size and a metre; `None` where they
/// are not numbers or all alike.
fn grown_bounds(bytes: &[u8]) -> Option<[[f64; 2]; 3]> {
    let side = |k: usize| {
        let [least, most] = bounds_of(bytes, k);
        let room = most - least + 1.0;
        (room >= 1.0).then_some([least - room, most + room])
    };
    let all = [side(0)?, side(1)?, side(2)?];
    let is_said = all.iter().flatten().all(|it| it.is_finite());
    let is_empty = all.iter().all(|[least, most]| most - least <= 2.0);
    (is_said && !is_empty).then_some(all)
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
        other => return Err(fault(format!("packing {other} does not exist"))),
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

impl Packed<'_> {
    /// Where chunks lie, of which there is a table.
    fn chunks<'b>(
        &self,
        bytes: &'b [u8],
        header: &LasHeader,
        (table_at, table): (usize, &[u8]),
    ) -> Result<Vec<Chunk<'b>>, Fault> {
        let first = header.points_at + POINTER_BYTES;
        let count = u64::from(word_at(table, 4));
        let fault = |what: String| Fault::at(format!("byte {table_at}, table of chunks"), what);
        if count == 0 || count > (table_at - first) as u64 {
            let what = format!("{count} chunks of {} bytes cannot be", table_at - first);
            return Err(fault(what));
        }
        let is_open = self.vlr.chunk_size() == ANY_SIZE;
        let entries = ChunkTable::read(&mut Cursor::new(table), is_open);
        let entries = entries.map_err(|error| fault(error.to_string()))?;
        let mut left = header.count;
        let mut at = first;
        let mut chunks = Vec::new();
        for entry in &entries {
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
            // Chunks of layers, and such of several sizes, say themselves how many points these
            // are; of others all but the last are of one size.
            let told = chunk.get(self.record_bytes..self.record_bytes + 4);
            let points = match (self.packing, told) {
                (Packing::Layers, Some(told)) => u64::from(word_at(told, 0)),
                _ if is_open => entry.point_count,
                _ => u64::from(self.vlr.chunk_size()).min(left),
            };
            if points > MOST_OF_CHUNK {
                let what = format!("a chunk of {} bytes has {points} points", chunk.len());
                return Err(fault(what));
            }
            if points > 0 {
                chunks.push(Chunk {
                    at,
                    bytes: chunk,
                    points,
                });
            }
            (left, at) = (left.saturating_sub(points), at + chunk.len());
        }
        Ok(chunks)
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
