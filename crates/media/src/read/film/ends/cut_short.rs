//! Does a file end before it says that it does?
//!
//! FFmpeg reads some files to where they break off and reports a normal end. Other containers
//! report the cut by themselves.

use std::fs::File;
use std::io::{BufReader, Cursor, Read, Seek, SeekFrom};
use std::path::Path;

use av::format::context::Input;
use av::{Packet, ffi};
use ffmpeg_next as av;

use crate::plain_file::{first_bytes, last_bytes, open_plain};
use crate::read::film::ends::animation_end::cut_animation;

/// Identifiers of the two elements that every Matroska file begins with (RFC 8794, RFC 9559).
pub(crate) const EBML: u64 = 0x1A45_DFA3;
pub(crate) const SEGMENT: u64 = 0x1853_8067;
/// Bytes of a packet of a transport stream, and from one to the next: with a time before each, and
/// with a checksum behind each, too. The first of them is always the same.
const PACKET: usize = 188;
const PACKET_STEPS: [usize; 3] = [188, 192, 204];
const SYNC: u8 = 0x47;
/// Bytes that are looked at for packets at the end, and packets that must be there.
const LAST_BYTES: u64 = 4096;
const LEAST_PACKETS: usize = 8;
/// Bytes at the end in which the last page of an Ogg begins.
const LAST_PAGES: u64 = 1 << 17;
/// The flag of an Ogg's last page.
const OGG_LAST: u8 = 4;
/// Most parts before the pictures of an AVI or ASF that are read.
const MOST_PARTS: u32 = 64;
/// Identifiers of an ASF's header and of its data, and the bytes of the data before the first
/// packet.
const ASF_HEADER: [u8; 16] = *b"\x30\x26\xb2\x75\x8e\x66\xcf\x11\xa6\xd9\0\xaa\0\x62\xce\x6c";
const ASF_DATA: [u8; 16] = *b"\x36\x26\xb2\x75\x8e\x66\xcf\x11\xa6\xd9\0\xaa\0\x62\xce\x6c";
const ASF_DATA_HEAD: u64 = 50;
/// A film that lacks this share of the length in its header, and this many seconds, is cut short.
const MOST_MISSING: f64 = 0.05;
const LEAST_MISSING_S: f64 = 0.2;
/// The file's first element is shorter than this, bytes.
const MOST_HEADER_BYTES: u64 = 4096;

/// Why the file of a format, by FFmpeg's name of it, is not whole; none where nothing says so.
pub(crate) fn why_cut(path: &Path, bytes: u64, format: &str) -> Option<String> {
    let too_early = |is_cut: bool| is_cut.then(|| "it ends too early".to_owned());
    match format {
        "apng" | "gif" => cut_animation(path),
        "mpegts" => ends_within_packet(&last_bytes(path, LAST_BYTES).unwrap_or_default())
            .then(|| "it ends within a packet".to_owned()),
        "ogg" => why_cut_ogg(&last_bytes(path, LAST_PAGES).unwrap_or_default()).map(str::to_owned),
        "avi" => too_early(end_of(path, end_of_avi).is_some_and(|end| end > bytes)),
        "asf" => too_early(end_of(path, end_of_asf).is_some_and(|end| end > bytes)),
        _ => too_early(is_cut_matroska(path, bytes)),
    }
}

/// Looks up where any bytes say that their pictures end: for fuzzing and tests.
pub fn read_any_end(bytes: &[u8]) {
    let _ = end_of_avi(&mut Cursor::new(bytes));
    let _ = end_of_asf(&mut Cursor::new(bytes));
    let _ = why_cut_ogg(bytes);
    let _ = ends_within_packet(bytes);
    let _ = declared_matroska_bytes(bytes);
}

/// The length that a header gives for all streams together, and how far the streams reach.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ToldEnd {
    /// Seconds.
    told: Option<f64>,
    begin: Option<f64>,
    end: f64,
}

impl ToldEnd {
    /// Of an open file.
    pub(crate) fn of(input: &Input) -> Self {
        let seconds = input.duration() as f64 / f64::from(ffi::AV_TIME_BASE);
        let is_told = input.format().name() == "flv" && seconds > 0.0 && seconds.is_finite();
        Self {
            told: is_told.then_some(seconds),
            ..Self::default()
        }
    }

    /// Takes note of a packet of any stream.
    pub(crate) fn note(&mut self, input: &Input, packet: &Packet) {
        let stamp = packet
            .pts()
            .or(packet.dts())
            .filter(|_| self.told.is_some());
        let Some((stamp, stream)) = stamp.zip(input.stream(packet.stream())) else {
            return;
        };
        let tick = f64::from(stream.time_base());
        let begin = stamp as f64 * tick;
        self.begin = Some(self.begin.map_or(begin, |first| first.min(begin)));
        self.end = self.end.max(begin + packet.duration() as f64 * tick);
    }

    /// Why the packets up to the end of the file are fewer than announced; none where they are not.
    pub(crate) fn why_short(&self) -> Option<String> {
        let (told, begin) = self.told.zip(self.begin)?;
        let came = self.end - begin;
        let most = (told * (1.0 - MOST_MISSING)).min(told - LEAST_MISSING_S);
        (came < most).then(|| format!("it announces {told:.2} s"))
    }
}

/// Where the pictures of a file end, according to its beginning.
fn end_of(path: &Path, find: fn(&mut BufReader<File>) -> Option<u64>) -> Option<u64> {
    let (file, _) = open_plain(path).ok()?;
    find(&mut BufReader::new(file))
}

/// Where the list of pictures of an AVI ends. Only the heads of lists are read. None for other
/// files, and where the length is not given.
fn end_of_avi(file: &mut (impl Read + Seek)) -> Option<u64> {
    let mut head = [0; 12];
    file.read_exact(&mut head).ok()?;
    if !head.starts_with(b"RIFF") || &head[8..] != b"AVI " {
        return None;
    }
    let mut at = 12;
    for _ in 0..MOST_PARTS {
        file.seek(SeekFrom::Start(at)).ok()?;
        file.read_exact(&mut head).ok()?;
        let length = u64::from(u32::from_le_bytes(*head[4..].first_chunk()?));
        if head.starts_with(b"LIST") && &head[8..] == b"movi" {
            return (length > 4 && length < u64::from(u32::MAX)).then_some(at + 8 + length);
        }
        at += 8 + length + length % 2;
    }
    None
}

/// Where the data of an ASF file (WMV) end.
fn end_of_asf(file: &mut (impl Read + Seek)) -> Option<u64> {
    let mut at = 0;
    for _ in 0..MOST_PARTS {
        let mut head = [0; 24];
        file.seek(SeekFrom::Start(at)).ok()?;
        file.read_exact(&mut head).ok()?;
        if at == 0 && head[..16] != ASF_HEADER {
            return None;
        }
        let length = u64::from_le_bytes(*head[16..].first_chunk()?);
        let end = at.checked_add(length).filter(|_| length > 24)?;
        if head[..16] == ASF_DATA {
            // Live streams do not know their length.
            return (length > ASF_DATA_HEAD).then_some(end);
        }
        at = end;
    }
    None
}

/// What is missing from an Ogg that ends with these bytes (RFC 3533); none where they have no page.
fn why_cut_ogg(last: &[u8]) -> Option<&'static str> {
    let pages = last.windows(6).enumerate();
    let mut pages = pages.filter(|(_, it)| it.starts_with(b"OggS") && it[4] == 0);
    let (at, page) = pages.next_back()?;
    let is_last = page[5] & OGG_LAST != 0;
    let pieces = last
        .get(at + 26)
        .map(|count| at + 27..at + 27 + usize::from(*count));
    let pieces = pieces.and_then(|there| last.get(there));
    let whole =
        pieces.map(|it| 27 + it.len() + it.iter().map(|it| usize::from(*it)).sum::<usize>());
    match whole {
        Some(length) if at + length <= last.len() => {
            (!is_last).then_some("it ends without its end mark")
        }
        _ => Some("it ends within a page"),
    }
}

/// Whether bytes at the end of a transport stream end within a packet; false where no packets are
/// seen in them.
fn ends_within_packet(last: &[u8]) -> bool {
    let begins = |at: usize| last.get(at) == Some(&SYNC);
    // Of packets that begin a step apart up to the end, the last.
    let last_of = |step: usize| {
        let first = (0..step).find(|at| (*at..last.len()).step_by(step).all(begins));
        first.map(|at| at + (last.len() - 1 - at) / step * step)
    };
    let steps = PACKET_STEPS
        .iter()
        .filter(|step| last.len() > **step * LEAST_PACKETS);
    let found = steps.filter_map(|step| last_of(*step)).next();
    found.is_some_and(|at| last.len() - at < PACKET)
}

/// Whether the file is Matroska and shorter than its header says; false where it cannot be read.
fn is_cut_matroska(path: &Path, bytes: u64) -> bool {
    let head = first_bytes(path, MOST_HEADER_BYTES).unwrap_or_default();
    declared_matroska_bytes(&head).is_some_and(|declared| declared > bytes)
}

/// Length of the Matroska file that begins with `head`; None for other files and unknown lengths.
fn declared_matroska_bytes(head: &[u8]) -> Option<u64> {
    let (id, size, after) = element(head, 0)?;
    if id != EBML {
        return None;
    }
    let (id, size, start) = element(head, after.checked_add(size?)?)?;
    if id != SEGMENT {
        return None;
    }
    start.checked_add(size?)
}

/// Identifier, size and start of the contents of the element at `at`; no size where it is unknown.
fn element(head: &[u8], at: u64) -> Option<(u64, Option<u64>, u64)> {
    let rest = head.get(usize::try_from(at).ok()?..)?;
    let (id, id_length) = number(rest)?;
    let (marked, length) = number(&rest[id_length..])?;
    let value = marked & !(1 << (7 * length));
    let is_unknown = value == (1 << (7 * length)) - 1;
    Some((
        id,
        (!is_unknown).then_some(value),
        at + (id_length + length) as u64,
    ))
}

/// An EBML number with its length marker, and its length in bytes.
fn number(bytes: &[u8]) -> Option<(u64, usize)> {
    let length = bytes.first()?.leading_zeros() as usize + 1;
    let digits = bytes.get(..length).filter(|_| length <= 8)?;
    Some((
        digits
            .iter()
            .fold(0, |sum, &byte| (sum << 8) | u64::from(byte)),
        length,
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_declared_length_is_the_segment_and_all_before_it() {
        let head = [
            0x1A, 0x45, 0xDF, 0xA3, 0x82, 7, 7, 0x18, 0x53, 0x80, 0x67, 0x40, 200, 1,
        ];
        assert_eq!(declared_matroska_bytes(&head), Some(13 + 200));
        let mut streamed = head;
        streamed[11..13].copy_from_slice(&[0x7F, 0xFF]);
        assert_eq!(declared_matroska_bytes(&streamed), None);
        assert_eq!(declared_matroska_bytes(b"RIFF"), None);
    }

    #[test]
    fn a_stream_ends_within_a_packet_or_between_two() {
        for (step, before) in [(188, 0), (192, 4), (204, 0)] {
            let packet = |number: u8| {
                let mut bytes = vec![number; step];
                bytes[before] = SYNC;
                bytes
            };
            let whole: Vec<u8> = (0..20).flat_map(packet).collect();
            assert!(!ends_within_packet(&whole), "{step}");
            for cut in [20, 60, 150, 187] {
                assert!(
                    ends_within_packet(&whole[..whole.len() - cut]),
                    "{step} {cut}"
                );
            }
        }
        assert!(!ends_within_packet(&[9; 4000]) && !ends_within_packet(&[SYNC; 3]));
    }

    #[test]
    fn an_avi_and_an_asf_end_where_their_pictures_do() {
        let list = |name: &[u8; 4], length: u32, inside: &[u8]| {
            [&b"LIST"[..], &length.to_le_bytes(), name, inside].concat()
        };
        let avi = |movi: u32| {
            let lists = [list(b"hdrl", 9, &[7; 6]), list(b"movi", movi, &[1; 8])];
            [&b"RIFF\0\0\0\0AVI "[..], &lists.concat()].concat()
        };
        let end = |bytes: Vec<u8>| end_of_avi(&mut Cursor::new(bytes));
        assert_eq!(end(avi(500)), Some(12 + 18 + 8 + 500));
        assert_eq!(
            [end(avi(0)), end(avi(u32::MAX)), end(vec![0; 99])],
            [None; 3]
        );
        let part = |name: [u8; 16], length: u64| [&name[..], &length.to_le_bytes()].concat();
        let asf = |data: u64| {
            let header = [part(ASF_HEADER, 40), vec![0; 16]].concat();
            [header, part(ASF_DATA, data)].concat()
        };
        let end = |bytes: Vec<u8>| end_of_asf(&mut Cursor::new(bytes));
        assert_eq!(end(asf(900)), Some(940));
        assert_eq!([end(asf(50)), end(asf(0)), end(vec![0; 99])], [None; 3]);
    }

    #[test]
    fn an_ogg_ends_with_its_last_page() {
        let page = |flags: u8| {
            let head = [&b"OggS\0"[..], &[flags], &[0; 20], &[2, 255, 10]].concat();
            [head, vec![9; 265]].concat()
        };
        let whole = [page(2), page(0), page(4)].concat();
        assert_eq!(why_cut_ogg(&whole), None);
        let told = |end: usize| why_cut_ogg(&whole[..end]).unwrap();
        assert!(told(2 * page(0).len()).contains("without its end mark"));
        for cut in [1, 100, 264, 266, 268, 280] {
            assert!(told(whole.len() - cut).contains("within a page"), "{cut}");
        }
        assert_eq!(why_cut_ogg(&[1; 400]), None);
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic(tail in prop::collection::vec(any::<u8>(), 0..40)) {
            for head in [&b""[..], b"OggS\0", b"RIFF1234AVI LIST", &ASF_HEADER] {
                read_any_end(&[head, &tail].concat());
            }
            let mut head = vec![0x1A, 0x45, 0xDF, 0xA3];
            head.extend(&tail);
            let _ = declared_matroska_bytes(&head);
        }
    }
}
