//! Which frames of a damaged stream are not what they were meant to be?

use std::collections::BTreeSet;

use av::frame::Video;
use av::{Packet, decoder};
use ffmpeg_next as av;

use crate::read::film::damage_log::DamageLog;

/// Packets that may come to nothing before the first frame: two minutes at 25 frames a second,
/// more than any distance of key frames that is used.
const MOST_EARLY: usize = 3000;
/// Frames after the first within which some may follow in the file that were to be shown before
/// it: more than any decoder reorders.
const MOST_LATE: u32 = 32;
/// Frames after the first that may ask for what lies before the stream's beginning.
const FRESH: u32 = 16;
/// Damaged frames that are left out while no good one has come.
pub(crate) const MOST_LEFT_OUT: u64 = 64;
/// Stamps of damaged packets that are kept until their frames come out.
const MOST_KEPT: usize = 4096;
/// Errors in a row after which a decoder takes nothing more.
const MOST_ERRORS: u32 = 10_000;

/// What identifies the packet that a frame came from, in the order of display where that is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Place {
    /// Its stamp.
    Stamp(i64),
    /// Where it lies in a file without stamps.
    Byte(i64),
    /// Nothing.
    Unknown,
}

impl Place {
    pub(crate) fn of_packet(packet: &Packet) -> Self {
        let stamp = packet.pts().map(Self::Stamp);
        stamp.unwrap_or_else(|| Self::of_byte(packet.position() as i64))
    }

    fn of_frame(frame: &Video) -> Self {
        let stamp = frame.pts().map(Self::Stamp);
        stamp.unwrap_or_else(|| Self::of_byte(frame.packet().position))
    }

    fn of_byte(at: i64) -> Self {
        match at {
            0.. => Self::Byte(at),
            _ => Self::Unknown,
        }
    }

    fn is_before(self, other: Self) -> bool {
        match (self, other) {
            (Self::Stamp(one), Self::Stamp(other)) | (Self::Byte(one), Self::Byte(other)) => {
                one < other
            }
            _ => false,
        }
    }
}

/// The packets round the first frame.
#[derive(Default)]
pub(crate) struct Beginning {
    /// Packets before the first frame came out, and where each lies in the file.
    early: Vec<(Place, i64)>,
    /// The first frame, once it came out, and where its packet lies; -1 where that is unknown.
    first: Option<Place>,
    first_at: i64,
    late: u32,
    /// Where packets lie whose stamps tell nothing and whose frames have not come out.
    untold: Vec<i64>,
    /// Whether the first packet leans on others, which are gone.
    is_open: bool,
    dropped: u64,
    shown: u32,
}

impl Beginning {
    /// Takes note of a packet that is to be shown, and where it lies. The error says that there
    /// were too many without a frame.
    pub(crate) fn fed(&mut self, place: Place, at: i64) -> Result<(), String> {
        match self.first {
            None if self.early.len() >= MOST_EARLY => {
                return Err(format!(
                    "none of its first {MOST_EARLY} packets can be decoded"
                ));
            }
            None => self.early.push((place, at)),
            Some(first) if self.late < MOST_LATE => {
                self.late += 1;
                self.note_untold((place, at), first);
                self.dropped += u64::from(place.is_before(first));
            }
            Some(_) => {}
        }
        Ok(())
    }

    /// Takes note of a packet that has no stamp in a stream with stamps, or that of the first
    /// frame, whose own it is not.
    fn note_untold(&mut self, (place, at): (Place, i64), first: Place) {
        let is_untold = matches!((place, first), (Place::Byte(_), Place::Stamp(_)));
        let is_same = place == first && place != Place::Unknown;
        if at >= 0 && (is_untold || is_same && self.first_at >= 0 && at != self.first_at) {
            self.untold.push(at);
        }
    }

    /// Whether nothing was taken note of.
    pub(crate) fn is_nothing(&self) -> bool {
        self.first.is_none() && self.early.is_empty()
    }

    /// Takes note that the first packet may lean on others before it.
    pub(crate) fn opens(&mut self) {
        self.is_open = true;
    }

    /// Whether frames still come that may ask for others before the beginning.
    pub(crate) fn is_open(&self) -> bool {
        self.is_open && self.shown < FRESH
    }

    /// Takes note of a frame that is shown.
    pub(crate) fn shown(&mut self, frame: &Video) {
        self.shown = self.shown.saturating_add(1);
        let at = frame.packet().position;
        if self.first.is_none() {
            let first = match (Place::of_frame(frame), frame.timestamp()) {
                (Place::Unknown, Some(guess)) => Place::Stamp(guess),
                (known, _) => known,
            };
            let early = std::mem::take(&mut self.early);
            let before = early.iter().filter(|(place, _)| place.is_before(first));
            self.dropped = before.count() as u64;
            self.first_at = at;
            for packet in early {
                self.note_untold(packet, first);
            }
            self.first = Some(first);
        }
        self.untold.retain(|it| *it != at);
    }

    /// Whether a frame has come out.
    pub(crate) fn has_begun(&self) -> bool {
        self.first.is_some()
    }

    /// Whether a stream that begins in the middle is at its beginning, where frames are whole and
    /// yet ask for others that are gone to be kept or forgotten.
    pub(crate) fn is_fresh(&self) -> bool {
        self.dropped > 0 && self.shown < FRESH
    }

    /// The first frame.
    pub(crate) fn first(&self) -> Option<Place> {
        self.first
    }

    /// Packets that should have been shown before the first frame, and are not. Once all frames
    /// have come out, packets that became no frame count too.
    pub(crate) fn dropped(&self, have_all_come: bool) -> u64 {
        let untold = if have_all_come { self.untold.len() } else { 0 };
        self.dropped + untold as u64
    }
}

/// A decoder that refuses damage, and what it says.
pub(crate) struct Judge {
    decoder: decoder::Video,
    log: DamageLog,
}

impl Judge {
    pub(crate) fn of(open: impl FnOnce(&DamageLog) -> Option<decoder::Video>) -> Option<Self> {
        let log = DamageLog::of_judge();
        open(&log).map(|decoder| Self { decoder, log })
    }

    fn finds(&mut self, packet: &Packet) -> Verdict {
        let mut is_bad = self.decoder.send_packet(packet).is_err();
        loop {
            match self.decoder.receive_frame(&mut Video::empty()) {
                Ok(()) => {}
                Err(av::Error::Eof) => break,
                Err(error) if crate::ffmpeg::wants_more(error) => break,
                Err(_) => {
                    is_bad = true;
                    break;
                }
            }
        }
        match (is_bad, self.log.has_heard()) {
            (false, _) => Verdict::Good,
            (true, false) => Verdict::LacksOthers,
            (true, true) => Verdict::Bad,
        }
    }
}

/// What is wrong with a packet.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Verdict {
    Good,
    /// That pictures before it are missing, and no more.
    LacksOthers,
    Bad,
}

/// Counts what is concealed. Decoders that conceal report little of it, so another one that refuses
/// damage reads the same packets.
pub(crate) struct Mending {
    judge: Option<Judge>,
    has_forgiven: bool,
    /// Damaged packets whose frames have not come out.
    waiting: BTreeSet<Place>,
    /// Damaged packets that cannot be identified.
    unknown: u64,
    /// Damaged frames that were shown, and those left out before the first good one.
    damaged: u64,
    left_out: u64,
    most_left_out: u64,
    /// Whether the decoder makes frames up from where a stream begins in the middle, so that all
    /// are left out before the first that leans on none.
    needs_key: bool,
    errors_in_a_row: u32,
    /// Frames that the decoder that shows flags, and the judge finds nothing wrong with.
    flagged: u64,
}

impl Mending {
    /// With a decoder that refuses damage, where the one that shows does not report it; so many
    /// damaged frames before the first good one are left out.
    pub(crate) fn new(judge: Option<Judge>, most_left_out: u64, needs_key: bool) -> Self {
        Self {
            judge,
            has_forgiven: false,
            waiting: BTreeSet::new(),
            unknown: 0,
            damaged: 0,
            left_out: 0,
            most_left_out,
            needs_key,
            errors_in_a_row: 0,
            flagged: 0,
        }
    }

    /// Looks whether a packet is damaged, as one with a hole is. Where a stream is open at its
    /// beginning, it is not for that pictures before it are missing.
    pub(crate) fn judge(
        &mut self,
        packet: &Packet,
        (place, has_hole): (Place, bool),
        is_open: bool,
    ) {
        let verdict = self.judge.as_mut().map(|judge| judge.finds(packet));
        let is_forgiven = is_open && verdict == Some(Verdict::LacksOthers);
        self.has_forgiven |= is_forgiven;
        let is_bad = verdict.is_some_and(|it| it != Verdict::Good) && !is_forgiven;
        if is_bad || packet.is_corrupt() || has_hole {
            self.note(place);
        }
    }

    /// Whether something was found that is no damage after all.
    pub(crate) fn has_forgiven(&self) -> bool {
        self.has_forgiven
    }

    /// Takes note of a damaged packet.
    pub(crate) fn note(&mut self, place: Place) {
        if place == Place::Unknown {
            self.unknown += 1;
            return;
        }
        self.waiting.insert(place);
        if self.waiting.len() > MOST_KEPT {
            self.waiting.pop_first();
        }
    }

    /// The decoder that shows refused a packet; false where it takes nothing any more.
    pub(crate) fn refuse(&mut self, place: Option<Place>) -> bool {
        self.errors_in_a_row += 1;
        let place = place.unwrap_or(Place::Unknown);
        if place != Place::Unknown || self.judge.is_none() {
            self.note(place);
        }
        self.errors_in_a_row <= MOST_ERRORS
    }

    /// Forgets that the packet of a frame was found damaged.
    pub(crate) fn forgive(&mut self, frame: &Video) {
        self.waiting.remove(&Place::of_frame(frame));
    }

    /// Whether a frame that came out is to be shown: a damaged one is, unless nothing before it
    /// was good.
    pub(crate) fn takes(&mut self, frame: &Video, is_flagged: bool, has_begun: bool) -> bool {
        self.errors_in_a_row = 0;
        // A decoder that conceals flags frames next to the damaged ones too.
        let is_sure = is_flagged && (self.judge.is_none() || frame.is_corrupt());
        self.flagged += u64::from(is_flagged && !is_sure);
        let is_flagged = is_sure;
        let place = Place::of_frame(frame);
        let was_bad = self.waiting.contains(&place);
        let is_made_up = self.needs_key && !has_begun && !frame.is_key();
        if !was_bad && !is_flagged && !is_made_up {
            return true;
        }
        if !has_begun && self.left_out < self.most_left_out {
            self.left_out += 1;
            return false;
        }
        self.waiting.remove(&place);
        self.damaged += 1;
        true
    }

    /// Damaged frames that were shown, and damaged packets that became none, of which those before
    /// the first frame are reported elsewhere.
    pub(crate) fn counts(&self, first: Option<Place>) -> [u64; 2] {
        let lost = self
            .waiting
            .iter()
            .filter(|place| first.is_none_or(|it| !place.is_before(it)));
        // Which frame is meant is unknown.
        let unknown = self.unknown.saturating_sub(self.damaged);
        let lost = lost.count() as u64 + unknown;
        match (self.damaged, lost) {
            // What only one of both decoders finds is damaged all the same.
            (0, 0) => [self.flagged, 0],
            found => found.into(),
        }
    }
}
