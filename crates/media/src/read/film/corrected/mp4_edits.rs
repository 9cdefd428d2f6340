//! Which edit lists and orders of frames of an MP4 leave out what is meant to be shown?
//!
//! ISO/IEC 14496-12, sections 8.6.1 and 8.6.6. FFmpeg shows what an edit list says, even where that
//! is nothing.

use std::io::{Read, Seek, SeekFrom};
use std::ops::Range;

use foveal_core::units::counted;

use crate::read::film::corrected::bytes::Corrections;
use crate::read::film::corrected::mp4_says::{Times, sample_length};
use crate::surround::spherical_boxes::{Boxes, Found};

/// So many frames may be decoded before they are shown.
const MOST_AHEAD: i64 = 16;
/// An edit that begins there is empty.
const EMPTY: i64 = -1;

/// The edit of a track that has one.
struct Edit {
    /// Where its length stands, and when it begins, in bytes of `wide` each.
    at: u64,
    is_wide: bool,
    /// In units of the film.
    length: u64,
    /// In units of the track.
    begins: i64,
}

/// What a track says of its samples.
struct Samples {
    /// Of the track, units a second and their number.
    times: Times,
    /// Of the film, units a second.
    film_units: u64,
    /// Units of a sample.
    one: i64,
    /// Where the list of when samples are shown, after they are decoded, begins.
    shown: Option<u64>,
    /// Whether only some of its samples can be decoded alone.
    leans: bool,
}

/// Corrections of edit lists, and of the first entry of when samples are shown.
pub(super) fn edits(file: &mut (impl Read + Seek)) -> Corrections {
    let mut corrections = Corrections::default();
    let Ok(end) = file.seek(SeekFrom::End(0)) else {
        return corrections;
    };
    let mut boxes = Boxes::of(file);
    let Some(film) = boxes.first(0..end, *b"moov") else {
        return corrections;
    };
    // In pieces, a length of 0 stands for all of them.
    if boxes.first(film.inside.clone(), *b"mvex").is_some() {
        return corrections;
    }
    let units = boxes.first(film.inside.clone(), *b"mvhd");
    let Some(units) = units.and_then(|it| Times::of(&mut boxes, it)) else {
        return corrections;
    };
    for track in boxes.named(film.inside, *b"trak") {
        let samples = Samples::of(&mut boxes, &track, u64::from(units.units));
        let edit = samples.and_then(|it| Some((edit_of(&mut boxes, &track)?, it)));
        if let Some((edit, samples)) = edit {
            correct(&mut boxes, &edit, &samples, &mut corrections);
        }
    }
    corrections
}

impl Samples {
    /// Of a video track; none of another, and where it does not say enough.
    fn of(boxes: &mut Boxes<'_, impl Read + Seek>, track: &Found, film_units: u64) -> Option<Self> {
        let media = boxes.first(track.inside.clone(), *b"mdia")?;
        let handler = boxes.first(media.inside.clone(), *b"hdlr")?;
        if boxes.word(handler.inside.start + 8)?.to_be_bytes() != *b"vide" {
            return None;
        }
        let head = boxes.first(media.inside.clone(), *b"mdhd")?;
        let times = Times::of(boxes, head).filter(|it| it.units > 0 && it.length > 0)?;
        let one = i64::try_from(sample_length(boxes, media.inside.clone())?).ok()?;
        let information = boxes.first(media.inside, *b"minf")?;
        let table = boxes.first(information.inside, *b"stbl")?.inside;
        let shown = boxes
            .first(table.clone(), *b"ctts")
            .map(|it| it.inside.start);
        let leans = boxes.first(table, *b"stss").is_some();
        (film_units > 0).then_some(Self {
            times,
            film_units,
            one,
            shown,
            leans,
        })
    }

    /// A length in units of the track, in those of the film.
    fn in_film(&self, length: u64) -> u64 {
        let units = u128::from(length) * u128::from(self.film_units);
        u64::try_from(units / u128::from(self.times.units)).unwrap_or(u64::MAX)
    }
}

/// The edit of a track with one that is not empty.
fn edit_of(boxes: &mut Boxes<'_, impl Read + Seek>, track: &Found) -> Option<Edit> {
    let list = boxes.first(track.inside.clone(), *b"edts")?.inside;
    let Range { start, end } = boxes.first(list, *b"elst")?.inside;
    let is_wide = boxes.word(start)? >> 24 == 1;
    let at = start + 8;
    if boxes.word(start + 4)? != 1 || at + if is_wide { 20 } else { 12 } > end {
        return None;
    }
    let wide = |boxes: &mut Boxes<'_, _>, at: u64| {
        Some(u64::from(boxes.word(at)?) << 32 | u64::from(boxes.word(at + 4)?))
    };
    let (length, begins) = match is_wide {
        true => (wide(boxes, at)?, wide(boxes, at + 8)? as i64),
        false => (
            u64::from(boxes.word(at)?),
            i64::from(boxes.word(at + 4)? as i32),
        ),
    };
    (begins != EMPTY).then_some(Edit {
        at,
        is_wide,
        length,
        begins,
    })
}

fn correct(
    boxes: &mut Boxes<'_, impl Read + Seek>,
    edit: &Edit,
    samples: &Samples,
    corrections: &mut Corrections,
) {
    let whole = samples.times.length;
    let mut begins = edit.begins;
    let mut tell = |what: String| corrections.told.push(what);
    if u64::try_from(begins).is_ok_and(|it| it >= whole) {
        let seconds = begins as f64 / f64::from(samples.times.units);
        tell(format!(
            "its edit list begins at {seconds:.3} s, behind its last frame: it is shown from its \
             first frame on"
        ));
        // The first is shown as late as this, if the file says that.
        let late = samples.shown.and_then(|at| boxes.word(at + 12));
        begins = i64::from(late.map_or(0, |it| it as i32)).clamp(0, samples.one * MOST_AHEAD);
    }
    // Where frames are shown in another order than they are decoded in, an edit list leaves out the
    // time by which the first is late. Without the list of that, it would leave out frames.
    let reaches = samples.in_film(u64::try_from(begins).unwrap_or(0));
    let all = samples.in_film(whole);
    let length = if edit.length == 0 { all } else { edit.length };
    let is_beyond = reaches.saturating_add(length) > all.saturating_add(1);
    let is_late = begins > 0 && begins <= MOST_AHEAD.saturating_mul(samples.one);
    if samples.shown.is_none() && samples.leans && is_late && is_beyond {
        let frames = (begins / samples.one.max(1)).max(1).unsigned_abs();
        tell(format!(
            "it lacks the list of when its frames are shown (ctts), and its edit list would leave \
             out {} at its start: all are shown",
            counted(frames, "frame")
        ));
        begins = 0;
    }
    if edit.length == 0 {
        tell("its edit list has a length of 0: all of it is shown".to_owned());
        corrections.bytes.push((edit.at, number(edit.is_wide, all)));
    }
    if begins != edit.begins {
        let at = edit.at + if edit.is_wide { 8 } else { 4 };
        corrections
            .bytes
            .push((at, number(edit.is_wide, begins as u64)));
    }
    if let Some(at) = samples.shown
        && let Some(late) = first_late(boxes, at)
        && i64::from(late) < 0
    {
        corrections.told.push(format!(
            "its first frame should be shown {:.3} s before its beginning, and is shown there",
            -f64::from(late) / f64::from(samples.times.units)
        ));
        let right = u32::try_from(begins).unwrap_or(0);
        corrections
            .bytes
            .push((at + 12, right.to_be_bytes().to_vec()));
    }
}

/// By how much the first sample is shown after it is decoded, where that is said of it alone.
fn first_late(boxes: &mut Boxes<'_, impl Read + Seek>, list: u64) -> Option<i32> {
    let is_alone = boxes.word(list + 4)? > 1 && boxes.word(list + 8)? == 1;
    let late = boxes.word(list + 12)? as i32;
    is_alone.then_some(late)
}

fn number(is_wide: bool, value: u64) -> Vec<u8> {
    match is_wide {
        true => value.to_be_bytes().to_vec(),
        false => u32::try_from(value)
            .unwrap_or(u32::MAX)
            .to_be_bytes()
            .to_vec(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read::film::corrected::made::{boxed, words};
    use proptest::prelude::*;
    use std::io::Cursor;

    /// A film of 20 frames at 10 frames a second, of 1024 units each, with this edit; where it says
    /// when frames are shown, the first one is so late.
    fn film([length, begins]: [u32; 2], late: Option<i32>) -> Vec<u8> {
        let hdlr = boxed(b"hdlr", &[&[0; 8][..], b"vide", &[0; 12]].concat());
        let mdhd = boxed(b"mdhd", &words(&[0, 0, 0, 10_240, 20_480, 0]));
        let shown = late.map(|it| boxed(b"ctts", &words(&[0, 2, 1, it as u32, 19, 0])));
        let table = [
            boxed(b"stts", &words(&[0, 1, 20, 1024])),
            boxed(b"stss", &words(&[0, 1, 1])),
            shown.unwrap_or_default(),
        ];
        let minf = boxed(b"minf", &boxed(b"stbl", &table.concat()));
        let elst = boxed(b"elst", &words(&[0, 1, length, begins, 1 << 16]));
        let trak = [
            boxed(b"edts", &elst),
            boxed(b"mdia", &[mdhd, hdlr, minf].concat()),
        ];
        let mvhd = boxed(b"mvhd", &words(&[0, 0, 0, 1000, 2000]));
        boxed(b"moov", &[mvhd, boxed(b"trak", &trak.concat())].concat())
    }

    fn assert_becomes(wrong: &[u8], right: &[u8], words: &str) {
        let found = edits(&mut Cursor::new(wrong));
        let mut mended = wrong.to_vec();
        found.correct(0, &mut mended);
        assert_eq!(mended, right, "{words}");
        let told = found.told.join("; ");
        assert!(told.contains(words), "{told}");
        assert_eq!(told.is_empty(), words.is_empty(), "{told}");
    }

    #[test]
    fn edits_that_would_leave_out_all_or_the_first_frames_are_corrected() {
        let whole = film([2000, 0], Some(0));
        assert_becomes(&whole, &whole, "");
        assert_becomes(&film([0, 0], Some(0)), &whole, "a length of 0");
        assert_becomes(
            &film([2000, 90_000], Some(0)),
            &whole,
            "behind its last frame",
        );
        // The first frame is late by two, as the edit says.
        let late = film([2000, 2048], Some(2048));
        assert_becomes(&late, &late, "");
        assert_becomes(
            &film([2000, 2048], Some(-5000)),
            &late,
            "0.488 s before its beginning",
        );
        assert_becomes(
            &film([2000, 2048], None),
            &film([2000, 0], None),
            "2 frames at its start",
        );
        assert_becomes(
            &film([0, 2048], None),
            &film([2000, 0], None),
            "2 frames at its start",
        );
        let behind = film([2000, 90_000], Some(2048));
        assert_becomes(&behind, &late, "behind its last frame");
        // A part that is meant.
        for part in [film([500, 2048], None), film([500, 10_240], Some(0))] {
            assert_becomes(&part, &part, "");
        }
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic(at in any::<prop::sample::Index>(), byte in any::<u8>()) {
            let mut bytes = film([0, 2048], Some(-7));
            let at = at.index(bytes.len());
            bytes[at] = byte;
            edits(&mut Cursor::new(&bytes));
            edits(&mut Cursor::new(&bytes[..at]));
        }
    }
}
