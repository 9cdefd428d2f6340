//! Which boxes of an MP4 file about the sphere and the eyes are broken, and where?

use crate::plain_file::open_plain;
use foveal_core::units::counted;
use std::io::{Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::Path;

/// Boxes looked at before the rest of a file counts as intact.
const MOST_BOXES: u32 = 100_000;
/// Bytes of a video sample entry before its own boxes.
const SAMPLE_ENTRY: u64 = 78;
/// Bytes of a box's size and name.
const HEAD: u64 = 8;
/// Bytes of a box's version and flags, where it has any.
const VERSION: u64 = 4;
/// What is wrong with a box that says again what was said.
const SECOND: &str = "is the second one of its track";

/// A box about the projection (`sv3d`) or the eyes (`st3d`) that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BrokenBox {
    /// Its four letters.
    pub name: &'static str,
    /// Where these letters stand in the file, in bytes. A box that is called `free` is passed over.
    pub at: u64,
    /// What is wrong with it, as the end of a sentence that begins with the box.
    pub what: String,
    /// What FFmpeg makes of it.
    pub ffmpeg: Ffmpeg,
}

/// What FFmpeg makes of a broken box.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Ffmpeg {
    /// It does not open the file.
    Refuses,
    /// It takes something else for the box, or one of two that contradict each other.
    Misreads,
    /// It reads on as if the box were not there.
    PassesOver,
}

/// The broken boxes of the first video track that has any; none in a file that is no MP4.
///
/// Reads the heads of the boxes on the way, not the file.
#[must_use]
pub fn broken_boxes(file: &mut (impl Read + Seek)) -> Vec<BrokenBox> {
    let Ok(end) = file.seek(SeekFrom::End(0)) else {
        return Vec::new();
    };
    let mut boxes = Boxes::of(file);
    let tracks: Vec<Found> = boxes
        .named(0..end, *b"moov")
        .into_iter()
        .flat_map(|film| boxes.named(film.inside, *b"trak"))
        .collect();
    let broken = tracks.into_iter().map(|track| boxes.broken_in(track));
    broken
        .into_iter()
        .find(|broken| !broken.is_empty())
        .unwrap_or_default()
}

/// What a file says of the part of its pictures that is to be shown.
pub(crate) struct ApertureNumbers {
    /// Columns and rows of its pictures.
    pub(crate) coded: [u32; 2],
    /// Numerator and denominator of width, height, and the way to the right and down.
    pub(crate) numbers: [u32; 8],
    /// Whether it says what shape its pixels have (`pasp`).
    pub(crate) has_pixel_shape: bool,
}

/// The `clap` box of the first video track that has one.
pub(crate) fn aperture_numbers(file: &mut (impl Read + Seek)) -> Option<ApertureNumbers> {
    let end = file.seek(SeekFrom::End(0)).ok()?;
    let mut boxes = Boxes::of(file);
    let films = boxes.named(0..end, *b"moov");
    let tracks = films.into_iter().next()?;
    let tracks = boxes.named(tracks.inside, *b"trak");
    tracks
        .into_iter()
        .find_map(|track| boxes.aperture_of(track))
}

/// The broken boxes of the file at `path`; none where it cannot be read.
pub(crate) fn broken_boxes_of(path: &Path) -> Vec<BrokenBox> {
    open_plain(path)
        .map(|(mut file, _)| broken_boxes(&mut file))
        .unwrap_or_default()
}

/// A box: its name, where that stands, how long the box says it is, and what it holds.
pub(crate) struct Found {
    pub(crate) name: [u8; 4],
    pub(crate) at: u64,
    pub(crate) size: u64,
    pub(crate) inside: Range<u64>,
}

impl Found {
    fn bytes(&self) -> u64 {
        self.inside.end - self.inside.start
    }

    fn broken(&self, name: &'static str, ffmpeg: Ffmpeg, what: &str) -> Option<BrokenBox> {
        Some(BrokenBox {
            name,
            at: self.at,
            what: what.to_owned(),
            ffmpeg,
        })
    }

    /// With such a box FFmpeg leaves the list of boxes that it stands in.
    fn without_head(&self, name: &'static str) -> Option<BrokenBox> {
        let size = self.size;
        let size = counted(size, "byte");
        let what = format!("says that it is {size} long, which is less than its head");
        self.broken(name, Ffmpeg::PassesOver, &what)
    }
}

/// Reads the heads of the boxes of a file, at most so many.
pub(crate) struct Boxes<'a, R> {
    file: &'a mut R,
    left: u32,
}

impl<'a, R: Read + Seek> Boxes<'a, R> {
    /// Of a file.
    pub(crate) fn of(file: &'a mut R) -> Self {
        Self {
            file,
            left: MOST_BOXES,
        }
    }

    /// Four bytes as a number.
    pub(crate) fn word(&mut self, at: u64) -> Option<u32> {
        self.file.seek(SeekFrom::Start(at)).ok()?;
        let mut bytes = [0; 4];
        self.file.read_exact(&mut bytes).ok()?;
        Some(u32::from_be_bytes(bytes))
    }

    /// The box that begins at `at`, cut off at `end`.
    fn at(&mut self, at: u64, end: u64) -> Option<Found> {
        self.left = self.left.checked_sub(1)?;
        let (size, name) = (self.word(at)?, self.word(at + 4)?);
        let (head, size) = match size {
            0 => (HEAD, end - at),
            1 => {
                let [high, low] = [self.word(at + 8)?, self.word(at + 12)?];
                (16, u64::from(high) << 32 | u64::from(low))
            }
            size => (HEAD, u64::from(size)),
        };
        let from = at + head;
        (from <= end).then(|| Found {
            name: name.to_be_bytes(),
            at: at + 4,
            size,
            inside: from..at.saturating_add(size).min(end).max(from),
        })
    }

    /// The boxes that follow each other here, up to the first that is shorter than its head.
    pub(crate) fn all(&mut self, within: Range<u64>) -> Vec<Found> {
        let mut found: Vec<Found> = Vec::new();
        let mut at = within.start;
        while found.last().is_none_or(|last| last.size >= HEAD)
            && at.saturating_add(HEAD) <= within.end
            && let Some(one) = self.at(at, within.end)
        {
            at = at.saturating_add(one.size);
            found.push(one);
        }
        found
    }

    /// Those of a name.
    pub(crate) fn named(&mut self, within: Range<u64>, name: [u8; 4]) -> Vec<Found> {
        let mut all = self.all(within);
        all.retain(|one| one.name == name);
        all
    }

    /// The first box of a name.
    pub(crate) fn first(&mut self, within: Range<u64>, name: [u8; 4]) -> Option<Found> {
        self.named(within, name).into_iter().next()
    }

    /// The boxes in the description of a video track's samples.
    fn description_of(&mut self, track: Found) -> Option<Vec<Found>> {
        let media = self.first(track.inside, *b"mdia")?;
        let handler = self.first(media.inside.clone(), *b"hdlr")?;
        if self.word(handler.inside.start + 8)?.to_be_bytes() != *b"vide" {
            return None;
        }
        let information = self.first(media.inside, *b"minf")?;
        let table = self.first(information.inside, *b"stbl")?;
        let descriptions = self.first(table.inside, *b"stsd")?.inside;
        let entry = self.at(descriptions.start + 8, descriptions.end)?.inside;
        Some(self.all(entry.start + SAMPLE_ENTRY..entry.end))
    }

    fn aperture_of(&mut self, track: Found) -> Option<ApertureNumbers> {
        let all = self.description_of(track)?;
        let clap = all.iter().find(|one| one.name == *b"clap")?;
        let first = all.first()?;
        // The size stands before the boxes.
        let entry = (first.at - 4).checked_sub(SAMPLE_ENTRY)?;
        let size = self.word(entry + 24)?;
        let mut numbers = [0; 8];
        for (k, number) in (0..).zip(&mut numbers) {
            *number = self.word(clap.inside.start + 4 * k)?;
        }
        (clap.bytes() >= 32).then(|| ApertureNumbers {
            coded: [size >> 16, size & 0xffff],
            numbers,
            has_pixel_shape: all.iter().any(|one| one.name == *b"pasp"),
        })
    }

    fn broken_in(&mut self, track: Found) -> Vec<BrokenBox> {
        let mut broken = Vec::new();
        let [mut eyes_told, mut sphere_told] = [false; 2];
        for one in self.description_of(track).unwrap_or_default() {
            broken.extend(match &one.name {
                b"st3d" => self.judge_eyes(&one, std::mem::replace(&mut eyes_told, true)),
                b"sv3d" => self.judge_sphere(&one, std::mem::replace(&mut sphere_told, true)),
                _ => None,
            });
        }
        broken
    }

    fn judge_eyes(&mut self, eyes: &Found, were_told: bool) -> Option<BrokenBox> {
        let broken = |ffmpeg, what: &str| eyes.broken("st3d", ffmpeg, what);
        if eyes.size < HEAD {
            return eyes.without_head("st3d");
        }
        if were_told {
            return broken(Ffmpeg::Refuses, SECOND);
        }
        if eyes.bytes() < 5 {
            return broken(Ffmpeg::Refuses, "is empty");
        }
        let [mode, ..] = self.word(eyes.inside.start + VERSION)?.to_be_bytes();
        let what = format!(
            "says {mode} (0 is one eye, 1 top and bottom, 2 side by side; others are not known)"
        );
        (mode > 2).then(|| broken(Ffmpeg::PassesOver, &what))?
    }

    fn judge_sphere(&mut self, sphere: &Found, was_told: bool) -> Option<BrokenBox> {
        let broken = |ffmpeg, what: &str| sphere.broken("sv3d", ffmpeg, what);
        let passed_over = |what: &str| broken(Ffmpeg::PassesOver, what);
        if sphere.size < HEAD {
            return sphere.without_head("sv3d");
        }
        if sphere.bytes() < 8 {
            return broken(Ffmpeg::Refuses, "is empty");
        }
        let [parts, inner] = self.parts_of(sphere);
        let mut all = parts.iter().chain(&inner);
        if all.any(|part| part.size > sphere.bytes()) || parts.is_empty() {
            return broken(Ffmpeg::Refuses, "holds a part that is longer than itself");
        }
        let is = |part: Option<&Found>, name: &[u8; 4]| part.is_some_and(|p| p.name == *name);
        if !is(parts.first(), b"svhd") {
            return passed_over("does not begin with its header (svhd)");
        }
        if !is(parts.get(1), b"proj") || !is(inner.first(), b"prhd") {
            return passed_over("holds no projection (proj with prhd)");
        }
        let Some(projection) = inner.get(1) else {
            return passed_over("does not say which projection it is");
        };
        self.judge_projection(sphere, projection)
            .or_else(|| was_told.then(|| broken(Ffmpeg::Misreads, SECOND))?)
    }

    fn judge_projection(&mut self, sphere: &Found, projection: &Found) -> Option<BrokenBox> {
        let broken = |ffmpeg, what: &str| sphere.broken("sv3d", ffmpeg, what);
        let numbers = match &projection.name {
            b"cbmp" => 2,
            b"equi" => 4,
            b"mshp" => {
                let what = "holds its projection as a mesh (mshp)";
                return broken(Ffmpeg::PassesOver, what);
            }
            name => {
                let what = format!("names a projection \"{}\"", name.escape_ascii());
                return broken(Ffmpeg::PassesOver, &what);
            }
        };
        if projection.bytes() < VERSION + 4 * numbers {
            let name = projection.name.escape_ascii();
            let what = format!("ends within the numbers of its projection ({name})");
            return broken(Ffmpeg::Misreads, &what);
        }
        let mut told = [0; 4];
        for (i, number) in (0..numbers).zip(&mut told) {
            *number = self.word(projection.inside.start + VERSION + 4 * i)?;
        }
        if projection.name == *b"cbmp" {
            let what = "holds cube faces in a layout other than 0 (3 x 2)";
            return (told[0] != 0).then(|| broken(Ffmpeg::PassesOver, what))?;
        }
        let [top, bottom, left, right] = told;
        let leaves_nothing = |a: u32, b: u32| b >= u32::MAX - a;
        let is_bad = leaves_nothing(top, bottom) || leaves_nothing(left, right);
        let what = "cuts off more than there is (bounds of equi)";
        is_bad.then(|| broken(Ffmpeg::Refuses, what))?
    }

    /// The parts of an `sv3d` box, and those of the `proj` among them.
    fn parts_of(&mut self, sphere: &Found) -> [Vec<Found>; 2] {
        let parts = self.all(sphere.inside.clone());
        let inside = parts.get(1).map_or(0..0, |part| part.inside.clone());
        let inner = self.all(inside);
        [parts, inner]
    }
}
