//! What does an MP4 say of its time and of its parts that FFmpeg passes over?
//!
//! ISO/IEC 14496-12. The heads of boxes are read.

use std::io::{Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::Path;

use foveal_core::units::counted;

use crate::plain_file::open_plain;
use crate::read::film::corrected::bytes::Corrections;
use crate::surround::spherical_boxes::{Boxes, Found};

/// Frames a second where no length says how many there are.
const USUAL_RATE: u64 = 25;
/// Most entries of an edit list that are looked at.
const MOST_EDITS: u64 = 1000;
/// Full speed, in the 16.16 fixed point of an edit list.
const FULL_SPEED: u32 = 1 << 16;

/// The same of the file at `path`.
pub(crate) fn notes_of(path: &Path) -> Vec<String> {
    open_plain(path)
        .map(|(mut file, _)| notes(&mut file))
        .unwrap_or_default()
}

/// What is not shown as the file asks for.
pub fn notes(file: &mut (impl Read + Seek)) -> Vec<String> {
    let Ok(end) = file.seek(SeekFrom::End(0)) else {
        return Vec::new();
    };
    let mut boxes = Boxes::of(file);
    let all = boxes.all(0..end);
    let mut notes = Vec::new();
    let film = all.iter().find(|it| it.name == *b"moov");
    if let Some(film) = film {
        let tracks = boxes.named(film.inside.clone(), *b"trak");
        let speed = tracks
            .into_iter()
            .find_map(|it| other_speed(&mut boxes, it));
        notes.extend(speed.map(|speed| {
            format!("its edit list asks for the speed {speed:.3}: it is shown at full speed")
        }));
    }
    if let Some(from) = mixed_at(&mut boxes, &all) {
        notes.push(format!(
            "another film is joined to it at byte {from}, whose times begin again: the frames of \
             both are mixed, and some are lost; cut the second off with `dd if=FILE of=PART bs=1M \
             iflag=skip_bytes skip={from}`"
        ));
    }
    if let Some(from) = joined_at(&mut boxes, &all) {
        let left = counted(end - from, "byte");
        notes.push(format!(
            "another film is joined to it: {left} from byte {from} on are not shown; cut them off \
             with `dd if=FILE of=PART bs=1M iflag=skip_bytes skip={from}`"
        ));
    }
    notes
}

/// The speed other than full that an edit of a video track asks for.
fn other_speed(boxes: &mut Boxes<'_, impl Read + Seek>, track: Found) -> Option<f64> {
    let media = boxes.first(track.inside.clone(), *b"mdia")?;
    let handler = boxes.first(media.inside, *b"hdlr")?;
    if boxes.word(handler.inside.start + 8)?.to_be_bytes() != *b"vide" {
        return None;
    }
    let edits = boxes.first(track.inside, *b"edts")?;
    let list = boxes.first(edits.inside, *b"elst")?.inside;
    let is_wide = boxes.word(list.start)? >> 24 == 1;
    let bytes = if is_wide { 20 } else { 12 };
    let count = u64::from(boxes.word(list.start + 4)?).min(MOST_EDITS);
    let of_entry = |k: u64| list.start + 8 + k * bytes;
    for at in (0..count)
        .map(of_entry)
        .take_while(|at| at + bytes <= list.end)
    {
        let speed = boxes.word(at + bytes - 4)?;
        let is_empty = boxes.word(at + bytes - 8)? == u32::MAX;
        // A speed of 0 holds a picture.
        if !is_empty && speed != FULL_SPEED {
            return Some(f64::from(speed as i32) / f64::from(FULL_SPEED));
        }
    }
    None
}

/// Where a second film begins, whose list of samples FFmpeg passes over.
fn joined_at(boxes: &mut Boxes<'_, impl Read + Seek>, all: &[Found]) -> Option<u64> {
    let lists = all.iter().enumerate().filter(|(_, it)| it.name == *b"moov");
    let (second, list) = lists.into_iter().nth(1)?;
    // Pieces that follow each other may each have one.
    if boxes.first(list.inside.clone(), *b"mvex").is_some() {
        return None;
    }
    let first = all.iter().position(|it| it.name == *b"moov")?;
    let between = &all[first + 1..=second];
    let begin = between.iter().find(|it| it.name == *b"ftyp");
    // A box's size stands before its name.
    Some(begin.unwrap_or(list).at.saturating_sub(4))
}

/// Where a second film of pieces begins, whose times are not behind those of the first.
fn mixed_at(boxes: &mut Boxes<'_, impl Read + Seek>, all: &[Found]) -> Option<u64> {
    let is_list = |it: &&Found| it.name == *b"moov";
    let first = all.iter().position(|it| is_list(&it))?;
    let second = first + 1 + all[first + 1..].iter().position(|it| is_list(&it))?;
    let is_piece = |it: &&Found| it.name == *b"moof";
    let before = all[first..second].iter().rfind(is_piece)?;
    let after = all[second..].iter().find(is_piece)?;
    let times = [before, after].map(|it| piece_time(boxes, it.inside.clone()));
    let [Some(before), Some(after)] = times else {
        return None;
    };
    let begin = all[first + 1..=second]
        .iter()
        .find(|it| it.name == *b"ftyp");
    let begin = begin.unwrap_or(&all[second]).at.saturating_sub(4);
    (after <= before).then_some(begin)
}

/// When the first samples of a piece are to be decoded, in units of their track.
fn piece_time(boxes: &mut Boxes<'_, impl Read + Seek>, inside: Range<u64>) -> Option<u64> {
    let track = boxes.first(inside, *b"traf")?;
    let time = boxes.first(track.inside, *b"tfdt")?.inside.start;
    let is_wide = boxes.word(time)? >> 24 == 1;
    length_at(boxes, time + 4, is_wide)
}

/// What a file lacks: what describes its tracks, as a segment of a stream or a recording that broke
/// off does, the end of that, or all of the rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Lacks {
    Init,
    Segments,
    Index,
    IndexEnd,
}

impl Lacks {
    /// What the file at `path` lacks; none where it lacks nothing.
    pub(crate) fn of(path: &Path) -> Option<Self> {
        let (mut file, _) = open_plain(path).ok()?;
        Self::read(&mut file)
    }

    fn read(file: &mut (impl Read + Seek)) -> Option<Self> {
        let end = file.seek(SeekFrom::End(0)).ok()?;
        let mut boxes = Boxes::of(file);
        let all = boxes.all(0..end);
        let has = |name: &[u8; 4]| all.iter().any(|it| it.name == *name);
        let film = all.iter().find(|it| it.name == *b"moov");
        match (film, has(b"moof")) {
            (None, true) => Some(Self::Init),
            // The size that a box gives may be more than there is of it.
            (None, false) => {
                let begins = [*b"ftyp", *b"wide", *b"free", *b"skip", *b"mdat"];
                let is_mp4 = all.first().is_some_and(|it| begins.contains(&it.name));
                (is_mp4 && has(b"mdat")).then_some(Self::Index)
            }
            (Some(film), false) if film.at.saturating_add(film.size) > end.saturating_add(4) => {
                Some(Self::IndexEnd)
            }
            (Some(film), false) => {
                let is_of_pieces = boxes.first(film.inside.clone(), *b"mvex").is_some();
                is_of_pieces.then_some(Self::Segments)
            }
            _ => None,
        }
    }
}

/// What joins a segment of a stream with what describes its tracks, for people.
pub(crate) fn how_to_join(segment: &Path) -> String {
    let name = |path: &Path| {
        path.file_name()
            .map(|it| it.to_string_lossy().into_owned())
            .unwrap_or_default()
    };
    let folder = match segment.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let beside = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let is_init = |it: &String| {
        let lower = it.to_lowercase();
        let endings = [".mp4", ".m4s", ".m4i", ".m4v", ".cmfv", ".init", ".mp4i"];
        lower.contains("init") && endings.iter().any(|ending| lower.ends_with(ending))
    };
    let mut inits: Vec<String> = beside
        .take(100_000)
        .map(|it| it.file_name().to_string_lossy().into_owned())
        .filter(is_init)
        .collect();
    inits.sort();
    let segment = name(segment);
    match inits.iter().find(|it| **it != segment) {
        Some(init) => format!(
            "its init segment may be {init} next to it; join them with `cat {init} {segment} > \
             whole.mp4`"
        ),
        None => format!(
            "find its init segment (as init.mp4) and join them with `cat init.mp4 {segment} > \
             whole.mp4`"
        ),
    }
}

/// A head of times: of a film (`mvhd`) or of a track's media (`mdhd`).
pub(super) struct Times {
    /// Where the units a second stand.
    at: u64,
    pub(super) units: u32,
    pub(super) length: u64,
}

impl Times {
    pub(super) fn of(boxes: &mut Boxes<'_, impl Read + Seek>, head: Found) -> Option<Self> {
        let start = head.inside.start;
        let is_wide = boxes.word(start)? >> 24 == 1;
        let at = start + if is_wide { 20 } else { 12 };
        let units = boxes.word(at)?;
        let length = length_at(boxes, at + 4, is_wide)?;
        Some(Self { at, units, length })
    }
}

fn length_at(boxes: &mut Boxes<'_, impl Read + Seek>, at: u64, is_wide: bool) -> Option<u64> {
    let first = boxes.word(at)?;
    Some(match is_wide {
        true => u64::from(first) << 32 | u64::from(boxes.word(at + 4)?),
        false => u64::from(first),
    })
}

/// The length of a track in units of the film.
fn track_length(boxes: &mut Boxes<'_, impl Read + Seek>, inside: Range<u64>) -> Option<u64> {
    let head = boxes.first(inside, *b"tkhd")?.inside.start;
    let is_wide = boxes.word(head)? >> 24 == 1;
    length_at(boxes, head + if is_wide { 28 } else { 20 }, is_wide)
}

/// How long the first sample of a track lasts, in its units.
pub(super) fn sample_length(
    boxes: &mut Boxes<'_, impl Read + Seek>,
    media: Range<u64>,
) -> Option<u64> {
    let information = boxes.first(media, *b"minf")?;
    let table = boxes.first(information.inside, *b"stbl")?;
    let times = boxes.first(table.inside, *b"stts")?;
    Some(u64::from(boxes.word(times.inside.start + 12)?))
}

/// Units a second of 0, which FFmpeg takes for 1, and what they are by the lengths of film and
/// track.
pub(super) fn times_of_zero(file: &mut (impl Read + Seek)) -> Corrections {
    let mut corrections = Corrections::default();
    let Ok(end) = file.seek(SeekFrom::End(0)) else {
        return corrections;
    };
    let mut boxes = Boxes::of(file);
    let Some(film) = boxes.first(0..end, *b"moov") else {
        return corrections;
    };
    let whole = boxes.first(film.inside.clone(), *b"mvhd");
    let whole = whole.and_then(|it| Times::of(&mut boxes, it));
    for track in boxes.named(film.inside, *b"trak") {
        let found = of_track(&mut boxes, track, whole.as_ref());
        corrections.bytes.extend(found.map(|(at, units)| {
            let told = format!("a track gives a time scale of 0: {units} units a second are taken");
            corrections.told.push(told);
            (at, units.to_be_bytes().to_vec())
        }));
    }
    corrections
}

/// Where a track says that a second has 0 units, and how many it has.
fn of_track(
    boxes: &mut Boxes<'_, impl Read + Seek>,
    track: Found,
    whole: Option<&Times>,
) -> Option<(u64, u32)> {
    let media = boxes.first(track.inside.clone(), *b"mdia")?;
    let head = boxes.first(media.inside.clone(), *b"mdhd")?;
    let own = Times::of(boxes, head).filter(|it| it.units == 0)?;
    let length = track_length(boxes, track.inside);
    let by_length = whole.zip(length).and_then(|(whole, length)| {
        let units = u128::from(own.length) * u128::from(whole.units);
        u32::try_from(units / u128::from(length).max(1)).ok()
    });
    let by_rate = || {
        let units = sample_length(boxes, media.inside.clone())?.checked_mul(USUAL_RATE)?;
        u32::try_from(units).ok()
    };
    let units = by_length.filter(|it| *it > 0);
    let units = units.or_else(by_rate).filter(|it| *it > 0);
    // Of pieces nothing gives a length here.
    let units = units.or(whole.map(|it| it.units).filter(|it| *it > 0))?;
    Some((own.at, units))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read::film::corrected::made::{boxed, words};
    use proptest::prelude::*;
    use std::io::Cursor;

    /// A film of one track of 1.2 s, at 10,240 units a second, by the number that it gives.
    fn film(units: u32, speed: u32) -> Vec<u8> {
        let hdlr = boxed(b"hdlr", &[&[0; 8][..], b"vide", &[0; 12]].concat());
        let mdhd = boxed(b"mdhd", &words(&[0, 0, 0, units, 12_288, 0]));
        let elst = boxed(b"elst", &words(&[0, 1, 1200, 0, speed]));
        let trak = [
            boxed(b"tkhd", &words(&[0, 0, 0, 1, 0, 1200])),
            boxed(b"edts", &elst),
            boxed(b"mdia", &[mdhd, hdlr].concat()),
        ];
        let mvhd = boxed(b"mvhd", &words(&[0, 0, 0, 1000, 1200]));
        let moov = [mvhd, boxed(b"trak", &trak.concat())].concat();
        [
            boxed(b"ftyp", b"isom"),
            boxed(b"moov", &moov),
            boxed(b"mdat", &[1; 9]),
        ]
        .concat()
    }

    fn told(bytes: &[u8]) -> String {
        notes(&mut Cursor::new(bytes)).join("\n")
    }

    #[test]
    fn a_time_scale_of_0_is_found_by_the_lengths() {
        let bytes = film(0, FULL_SPEED);
        let found = times_of_zero(&mut Cursor::new(&bytes)).bytes;
        assert_eq!(found.len(), 1);
        let (at, right) = &found[0];
        assert_eq!(*right, 10_240_u32.to_be_bytes());
        let mut mended = bytes;
        mended[*at as usize..][..4].copy_from_slice(right);
        assert_eq!(mended, film(10_240, FULL_SPEED));
        assert!(times_of_zero(&mut Cursor::new(&mended)).is_empty());
    }

    #[test]
    fn other_speeds_and_films_behind_the_end_are_told() {
        let whole = film(10_240, FULL_SPEED);
        assert_eq!(told(&whole), "");
        assert!(told(&film(10_240, FULL_SPEED / 2)).contains("0.500"));
        let joined = [&whole[..], &whole].concat();
        assert!(told(&joined).contains(&format!("from byte {} on", whole.len())));
    }

    #[test]
    fn segments_alone_are_told_from_films() {
        let lacks = |bytes: &[u8]| Lacks::read(&mut Cursor::new(bytes));
        assert_eq!(lacks(&film(1, 1)), None);
        let segment = [
            boxed(b"styp", b"msdh"),
            boxed(b"moof", &[]),
            boxed(b"mdat", &[1]),
        ];
        assert_eq!(lacks(&segment.concat()), Some(Lacks::Init));
        let init = [
            boxed(b"ftyp", b"iso5"),
            boxed(b"moov", &boxed(b"mvex", &[])),
        ]
        .concat();
        assert_eq!(lacks(&init), Some(Lacks::Segments));
        assert_eq!(lacks(&[init, segment.concat()].concat()), None);
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic(at in any::<prop::sample::Index>(), byte in any::<u8>()) {
            let mut bytes = [film(0, 7), film(0, 7)].concat();
            let at = at.index(bytes.len());
            bytes[at] = byte;
            for bytes in [&bytes[..], &bytes[..at]] {
                told(bytes);
                times_of_zero(&mut Cursor::new(bytes));
                Lacks::read(&mut Cursor::new(bytes));
            }
        }
    }
}
