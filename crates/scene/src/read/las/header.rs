//! What does the header of a LAS file say, and does it fit to the file?

use super::super::error::Fault;
use super::mends::LasMends;
use foveal_core::units::counted;

/// What mends counts.
const REPAIR: &str = "copy the file again if it was cut short, or repair it, for instance with \
                      `lasinfo -repair`";
/// Bytes of the header up to LAS 1.2, and of those of 1.3 and 1.4.
const HEADER_BYTES: [usize; 3] = [227, 235, 375];
/// A record before the points begins with that many bytes.
const RECORD_HEAD: usize = 54;
/// And one behind the points with that many.
const LATER_RECORD_HEAD: usize = 60;
/// Stands for an unknown number of points.
const UNCOUNTED: u64 = u32::MAX as u64;
/// Where the bounds begin: the most and the least of each axis.
pub(super) const BOUNDS_AT: usize = 179;
/// Bits of the point format by which LASzip says that points are packed.
const PACKED: u8 = 0xc0;

pub(super) fn half_at(bytes: &[u8], at: usize) -> u16 {
    u16::from_le_bytes([bytes[at], bytes[at + 1]])
}

pub(super) fn word_at(bytes: &[u8], at: usize) -> u32 {
    u32::from(half_at(bytes, at)) | u32::from(half_at(bytes, at + 2)) << 16
}

pub(super) fn long_at(bytes: &[u8], at: usize) -> u64 {
    u64::from(word_at(bytes, at)) | u64::from(word_at(bytes, at + 4)) << 32
}

/// Where in a record is what is kept of a point?
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Layout {
    /// Bytes of a record without what a file adds.
    pub(super) least_bytes: usize,
    /// Where red begins.
    pub(super) colour: Option<usize>,
    /// Whether it is one of the formats of LAS 1.4.
    is_new: bool,
    /// Whether it names a waveform.
    pub(super) has_waves: bool,
}

impl Layout {
    /// Of a point format: tables of the specification's chapter 2.6.
    fn of(format: u8) -> Option<Self> {
        let (least_bytes, colour) = match format {
            0 => (20, None),
            1 => (28, None),
            2 => (26, Some(20)),
            3 => (34, Some(28)),
            4 => (57, None),
            5 => (63, Some(28)),
            6 => (30, None),
            7 => (36, Some(30)),
            8 => (38, Some(30)),
            9 => (59, None),
            10 => (67, Some(30)),
            _ => return None,
        };
        Some(Self {
            least_bytes,
            colour,
            is_new: format >= 6,
            has_waves: matches!(format, 4 | 5 | 9 | 10),
        })
    }

    /// The class: up to LAS 1.3 in the low bits of a byte, of which the others are flags.
    pub(super) fn class_of(&self, record: &[u8]) -> u8 {
        match self.is_new {
            true => record[16],
            false => record[15] & 31,
        }
    }
}

/// Whether a number can be the length of a step, along an axis or against it.
pub(super) fn is_step(scale: f64) -> bool {
    scale.is_finite() && scale != 0.0 && scale.abs() <= 1e12
}

/// Whether a number can be where a grid begins.
pub(super) fn is_place(offset: f64) -> bool {
    offset.abs() <= 1e15
}

/// How far the header says that points reach along an axis: the least and the most, of a whole
/// header.
pub(super) fn bounds_of(bytes: &[u8], axis: usize) -> [f64; 2] {
    let number = |at: usize| f64::from_bits(long_at(bytes, at));
    let at = BOUNDS_AT + 16 * axis;
    [number(at + 8), number(at)]
}

/// What is to be known of a file before its points.
#[derive(Clone, Debug)]
pub(super) struct LasHeader {
    pub(super) layout: Layout,
    /// Whether LASzip packed the points.
    pub(super) is_packed: bool,
    /// Bytes of a record.
    pub(super) record_bytes: usize,
    /// Number of points that it gives; more than any file has, if it does not count packed points.
    pub(super) count: u64,
    pub(super) is_counted: bool,
    /// Where the points begin, in bytes.
    pub(super) points_at: usize,
    /// Where what comes after the points begins, or the file ends.
    pub(super) points_end: usize,
    pub(super) scale: [f64; 3],
    pub(super) offset: [f64; 3],
    header_bytes: usize,
    /// Number of records before the points.
    records: u32,
}

impl LasHeader {
    /// Reads the header; what it says that does not fit the file, and that nothing shown depends
    /// on, is noted in `mends`.
    pub(super) fn parse(bytes: &[u8], mends: &mut LasMends) -> Result<Self, Fault> {
        if !bytes
            .get(..4)
            .is_some_and(|it| it.eq_ignore_ascii_case(b"LASF"))
        {
            return Err(Fault::at("byte 0", "a LAS file begins with `LASF`"));
        }
        if bytes.len() < HEADER_BYTES[0] {
            let what = format!(
                "the file ends after {} of {} bytes of its header",
                bytes.len(),
                HEADER_BYTES[0]
            );
            return Err(Fault::at(format!("byte {}", bytes.len()), what));
        }
        let [is_packed, format] = [bytes[104] & PACKED, bytes[104] & !PACKED];
        let layout = Layout::of(format).ok_or_else(|| {
            let what = format!("point format {format}");
            Fault::unsupported(what, "write it with a point format from 0 to 10")
        })?;
        let number = |at: usize| f64::from_bits(long_at(bytes, at));
        let minor = version(bytes, mends)?;
        let mut header = Self {
            layout,
            is_packed: is_packed != 0,
            record_bytes: usize::from(half_at(bytes, 105)),
            count: 0,
            is_counted: true,
            points_at: word_at(bytes, 96) as usize,
            points_end: bytes.len(),
            scale: [131, 139, 147].map(number),
            offset: [155, 163, 171].map(number),
            header_bytes: header_bytes_of(bytes),
            records: word_at(bytes, 100),
        };
        header.mend_begin(bytes, minor, mends);
        header.points_end = end_of_points(bytes, minor, layout.has_waves, header.points_at);
        header.mend_record_bytes(bytes, minor, mends);
        header.check(bytes.len())?;
        header.count = header.count_of(bytes, minor, mends)?;
        let is_said = word_at(bytes, 107) > 0 || minor >= 4 && long_at(bytes, 247) > 0;
        header.is_counted = is_said || header.count < UNCOUNTED;
        header.note_records(bytes, mends);
        note_later_records(bytes, minor, mends);
        note_returns(bytes, minor, header.count, mends);
        Ok(header)
    }

    /// The number of points: of several that the header gives, the one that the file holds.
    fn count_of(&self, bytes: &[u8], minor: u8, mends: &mut LasMends) -> Result<u64, Fault> {
        let old = u64::from(word_at(bytes, 107));
        let new = if minor >= 4 { long_at(bytes, 247) } else { old };
        let held = (self.points_end.saturating_sub(self.points_at) / self.record_bytes) as u64;
        let count = match [old, new] {
            [0, 0] if !self.is_packed && held > 0 => {
                mends.stale_count(format!(
                    "the header counts no points; the {held} that the file holds are shown"
                ));
                held
            }
            [0, 0] if self.is_packed && self.points_at < self.points_end => {
                let of_echoes = echoes_of(bytes, minor)
                    .iter()
                    .fold(0_u64, |all, it| all.saturating_add(*it));
                let count = match of_echoes {
                    0 => UNCOUNTED,
                    all => all.min(UNCOUNTED - 1),
                };
                let what = match of_echoes {
                    0 => "those of its chunks are shown".to_owned(),
                    all => format!("the {all} whose echoes it counts are read"),
                };
                mends.stale_count(format!("the header counts no points; {what}"));
                count
            }
            [0, 0] => {
                let found = "the file has no points".to_owned();
                return Err(Fault::Empty { found });
            }
            [old, 0] => old,
            [0, new] => new,
            [old, new] if old == new => new,
            [old, new] => {
                let count = if !self.is_packed && old == held {
                    old
                } else {
                    new
                };
                mends.stale_count(format!(
                    "the header counts {old} points, and at byte 247 {new}: {count} are read"
                ));
                count
            }
        };
        let there = if self.is_packed {
            count
        } else {
            count.min(held)
        };
        if u32::try_from(there).is_err() {
            let next = "cut the file into tiles of less than 4 thousand million points";
            return Err(Fault::unsupported(format!("{count} points"), next));
        }
        Ok(count)
    }

    /// A record that is shorter than its format requires has one of these lengths wrong: the bytes
    /// of all points show which.
    fn mend_record_bytes(&mut self, bytes: &[u8], minor: u8, mends: &mut LasMends) {
        let (said, least) = (self.record_bytes, self.layout.least_bytes);
        if said >= least || self.points_at > bytes.len() {
            return;
        }
        let new = if minor >= 4 { long_at(bytes, 247) } else { 0 };
        let count = u64::from(word_at(bytes, 107)).max(new);
        let room = self.points_end.saturating_sub(self.points_at) as u64;
        let fits = |length: usize| count > 0 && count.saturating_mul(length as u64) <= room;
        let shorter = (0..=3)
            .filter_map(Layout::of)
            .find(|it| it.least_bytes == said);
        if self.is_packed || fits(least) {
            self.record_bytes = least;
            mends.stale_count(format!(
                "a point is said to have {said} bytes, but its format has at least {least}, and \
                 there are as many: {least} are read"
            ));
        } else if let Some(shorter) = shorter.filter(|_| fits(said)) {
            self.layout = shorter;
            mends.stale_count(format!(
                "a point has {said} bytes, but its format at least {least}: it is read as one \
                 of a format of {said} bytes"
            ));
        }
    }

    /// The records that the header counts should lie between it and the points.
    fn note_records(&self, bytes: &[u8], mends: &mut LasMends) {
        let found = self.each_record(bytes).count();
        if found as u64 != u64::from(self.records) {
            mends.stale_count(format!(
                "the header counts {} before the points, of which {found} fit",
                counted(self.records, "record")
            ));
        }
    }

    /// Finds where the points begin, where the header says a place within itself, behind the end,
    /// or within its records though the points fit exactly behind them.
    fn mend_begin(&mut self, bytes: &[u8], minor: u8, mends: &mut LasMends) {
        let said = usize::from(half_at(bytes, 94));
        if said != self.header_bytes {
            mends.stale_count(format!(
                "the header is said to have {said} bytes: {} are read, as of its version",
                self.header_bytes
            ));
        }
        let Some(begin) = self.behind_records(bytes) else {
            return;
        };
        let is_possible = (self.header_bytes..=bytes.len()).contains(&self.points_at);
        let new = if minor >= 4 { long_at(bytes, 247) } else { 0 };
        let count = u64::from(word_at(bytes, 107)).max(new);
        let length = self.record_bytes.max(1);
        let held = (bytes.len().saturating_sub(begin) / length) as u64;
        let is_exact = |at: usize| {
            let room = bytes.len().saturating_sub(at) as u64;
            count > 0 && count.checked_mul(length as u64) == Some(room)
        };
        let is_within_records = self.points_at < begin && !is_exact(self.points_at);
        let fits = match (is_possible, self.is_packed) {
            (true, _) => is_within_records && !self.is_packed && is_exact(begin),
            (false, true) => begin < bytes.len(),
            (false, false) => held > 0 && held >= count,
        };
        if fits {
            mends.stale_count(format!(
                "points are said to begin at byte {}: those behind the records before them, at \
                 byte {begin}, are read",
                self.points_at
            ));
            self.points_at = begin;
        }
    }

    /// Where the records before the points end; `None` where they do not fit.
    fn behind_records(&self, bytes: &[u8]) -> Option<usize> {
        let mut at = self.header_bytes;
        for _ in 0..self.records {
            let head = bytes.get(at..at + RECORD_HEAD)?;
            at += RECORD_HEAD + usize::from(half_at(head, 20));
        }
        // LAS 1.0 marks where points begin.
        let is_marked = bytes.get(at..at + 2) == Some(&[0xdd, 0xcc]) && bytes[25] == 0;
        let begin = if is_marked { at + 2 } else { at };
        (begin <= bytes.len()).then_some(begin)
    }

    /// The records before the points, each with its head.
    fn each_record<'a>(&self, bytes: &'a [u8]) -> impl Iterator<Item = (&'a [u8], &'a [u8])> {
        let mut rest = bytes.get(self.header_bytes..self.points_at);
        (0..self.records).map_while(move |_| {
            let (head, behind) = rest?.split_at_checked(RECORD_HEAD)?;
            let (said, behind) = behind.split_at_checked(usize::from(half_at(head, 20)))?;
            rest = Some(behind);
            Some((head, said))
        })
    }

    fn check(&self, length: usize) -> Result<(), Fault> {
        let wrong = |at: u32, what: String| Err(Fault::at(format!("byte {at}"), what));
        if self.header_bytes > self.points_at {
            let what = format!(
                "points are said to begin at byte {}, within the header of {} bytes",
                self.points_at, self.header_bytes
            );
            return wrong(96, what);
        }
        if self.points_at > length {
            let what = format!("points begin at byte {}, behind the end", self.points_at);
            return wrong(96, what);
        }
        if self.record_bytes < self.layout.least_bytes {
            let [found, least] = [self.record_bytes, self.layout.least_bytes];
            return wrong(
                105,
                format!("a point has {found} bytes, of at least {least}"),
            );
        }
        Ok(())
    }

    /// What is wrong with the number of points.
    pub(super) fn wrong_count(&self, what: &str) -> Fault {
        let what = format!("the header counts {} points, but {what}", self.count);
        Fault::broken("byte 107", what, REPAIR)
    }

    /// The records of a file that is not packed: as many as the header counts, or as there are.
    pub(super) fn plain_records<'a>(
        &self,
        bytes: &'a [u8],
        mends: &mut LasMends,
    ) -> Result<&'a [u8], Fault> {
        let length = self.record_bytes;
        let room_to = |end: usize| end.saturating_sub(self.points_at);
        let held = |end: usize| (room_to(end) / length) as u64;
        let mut end = self.points_end;
        if held(end) < self.count && held(bytes.len()) >= self.count {
            mends.stale_count(format!(
                "what comes after the points would begin at byte {end}, within them"
            ));
            end = bytes.len();
        }
        let count = self.count.min(held(end));
        if count == 0 {
            let room = room_to(end);
            let what = format!("no record of {length} bytes fits into the {room} bytes there are");
            return Err(self.wrong_count(&what));
        }
        mends.miss(self.count - count, self.count, "the file ends early");
        let used = count as usize * length;
        if count == self.count {
            mends.leave_behind(room_to(end) - used, self.count);
        }
        Ok(&bytes[self.points_at..self.points_at + used])
    }

    /// What the record before the points says that `user` wrote with this number.
    pub(super) fn record<'a>(&self, bytes: &'a [u8], user: &[u8], number: u16) -> Option<&'a [u8]> {
        let is_it = |(head, _): &(&[u8], &[u8])| {
            let named = head[2..18].strip_prefix(user);
            let is_user = named.is_some_and(|rest| rest.iter().all(|it| *it == 0));
            is_user && half_at(head, 18) == number
        };
        self.each_record(bytes).find(is_it).map(|(_, said)| said)
    }
}

/// Bytes of the header: what it says, or those of its version where that cannot be.
fn header_bytes_of(bytes: &[u8]) -> usize {
    let said = usize::from(half_at(bytes, 94));
    let minor = bytes[25].clamp(2, 4);
    let usual = HEADER_BYTES[usize::from(minor - 2)];
    let points_at = word_at(bytes, 96) as usize;
    let is_behind_points = said > points_at && points_at >= usual;
    match said < HEADER_BYTES[0] || is_behind_points {
        true => usual,
        false => said,
    }
}

/// The minor version, as far as the header reaches.
fn version(bytes: &[u8], mends: &mut LasMends) -> Result<u8, Fault> {
    let [major, minor] = [bytes[24], bytes[25]];
    if major != 1 {
        return Err(Fault::unsupported(
            format!("LAS {major}.{minor}"),
            "write it as LAS 1.4, or 1.2",
        ));
    }
    let header_bytes = header_bytes_of(bytes).min(bytes.len());
    let reaches = |minor: &u8| HEADER_BYTES[usize::from(*minor - 2)] <= header_bytes;
    let reached = (2..=minor.clamp(2, 4)).rev().find(reaches).unwrap_or(2);
    if minor > 4 {
        mends.remark(format!("LAS 1.{minor} is read as LAS 1.{reached}"));
    } else if minor > reached {
        mends.stale_count(format!(
            "the header of {header_bytes} bytes is no whole one of LAS 1.{minor}, and is read as \
             one of LAS 1.{reached}"
        ));
    }
    Ok(reached)
}

/// Where waveforms and records after the points begin, or else the file ends.
fn end_of_points(bytes: &[u8], minor: u8, has_waves: bool, points_at: usize) -> usize {
    let mut end = bytes.len();
    let has_later = minor >= 4 && word_at(bytes, 243) > 0;
    for (counts, at) in [(minor >= 3 && has_waves, 227), (has_later, 235)] {
        if counts {
            let begin = usize::try_from(long_at(bytes, at)).unwrap_or(usize::MAX);
            if begin > points_at {
                end = end.min(begin);
            }
        }
    }
    end
}

/// The records behind the points that LAS 1.4 counts should lie in the file.
fn note_later_records(bytes: &[u8], minor: u8, mends: &mut LasMends) {
    let said = if minor >= 4 { word_at(bytes, 243) } else { 0 };
    let mut rest = match said {
        0 => return,
        _ => usize::try_from(long_at(bytes, 235)).map_or(None, |at| bytes.get(at..)),
    };
    for found in 0..said {
        let behind = rest.and_then(|it| {
            let length = usize::try_from(long_at(it.get(..LATER_RECORD_HEAD)?, 20)).ok()?;
            it[LATER_RECORD_HEAD..].get(length..)
        });
        if behind.is_none() {
            return mends.stale_count(format!(
                "the header counts {} behind the points, of which {found} fit",
                counted(said, "record")
            ));
        }
        rest = behind;
    }
}

/// How many points are first, second .. echoes of pulses, as the header counts them.
fn echoes_of(bytes: &[u8], minor: u8) -> Vec<u64> {
    match minor {
        4 => (0..15).map(|k| long_at(bytes, 255 + 8 * k)).collect(),
        _ => (0..5)
            .map(|k| u64::from(word_at(bytes, 111 + 4 * k)))
            .collect(),
    }
}

/// No more echoes can be the first, second .. of a pulse than there are points. (Many files count
/// fewer, or none.)
fn note_returns(bytes: &[u8], minor: u8, count: u64, mends: &mut LasMends) {
    let all = echoes_of(bytes, minor)
        .iter()
        .fold(0, |all: u64, it| all.saturating_add(*it));
    if all > count {
        mends.stale_count(format!(
            "the header counts {all} echoes of pulses, but {count} points"
        ));
    }
}
