//! Where were recordings joined, so that the time stamps of a stream start again?
//!
//! Transport and program streams, and Oggs, may be joined end to end as they are (`cat A.ts B.ts`).
//! Within one recording the time to decode at never goes back.

use ffmpeg_next::{Packet, Rational};

/// A step back by more than the first is a new beginning, and so is a step forward by more than the
/// second: FFmpeg treats a stamp below the first one as wrapped around. In seconds.
const BACK_S: f64 = 0.1;
const FORWARD_S: f64 = 3600.0;

/// Headers that an Ogg hands out as pictures where another film follows in it: what the first byte
/// is at least, and what follows it or begins it.
const OGG_HEADERS: [(u8, &[u8]); 2] = [(0x80, b"theora"), (0, b"VP80")];

/// The stamps of one stream, one recording after another.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Joints {
    /// None for containers in which stamps cannot start again.
    tick: Option<f64>,
    /// Ticks to add to the stamps of the file.
    offset: i64,
    /// When the packet before was to be decoded, and how long it lasts.
    last: Option<[i64; 2]>,
    /// The same and the offset before the last joint, until a packet follows it.
    before: Option<([i64; 2], i64)>,
    found: u64,
}

impl Joints {
    /// For a stream whose stamps have this unit, in the container that FFmpeg calls so.
    pub(crate) fn of(container: &str, tick: Rational) -> Self {
        let joins = matches!(container, "mpegts" | "mpeg" | "ogg");
        let tick = f64::from(tick);
        Self {
            tick: (joins && tick > 0.0).then_some(tick),
            offset: 0,
            last: None,
            before: None,
            found: 0,
        }
    }

    /// How often stamps started again.
    pub(crate) fn found(&self) -> u64 {
        self.found
    }

    /// Moves the stamps of the next packet after those before it. Says whether they start again
    /// there.
    pub(crate) fn follow(&mut self, packet: &mut Packet) -> bool {
        let Some((tick, at)) = self.tick.zip(packet.dts().or(packet.pts())) else {
            return false;
        };
        let is_joint = self.takes(tick, [at, packet.duration()]);
        if self.offset != 0 {
            let moved = |it: i64| it.saturating_add(self.offset);
            packet.set_pts(packet.pts().map(moved));
            packet.set_dts(packet.dts().map(moved));
        }
        is_joint
    }

    fn takes(&mut self, tick: f64, [at, length]: [i64; 2]) -> bool {
        let step = |from: i64| at.saturating_sub(from) as f64 * tick;
        let is_new = |from: i64| step(from) < -BACK_S || step(from) > FORWARD_S;
        let mut is_joint = false;
        match (self.last, self.before.take()) {
            // One stamp was wrong.
            (_, Some(([before, _], offset))) if (0.0..1.0).contains(&step(before)) => {
                self.offset = offset;
                self.found -= 1;
            }
            (Some([last, lasted]), _) if is_new(last) => {
                self.before = Some(([last, lasted], self.offset));
                let end = last.saturating_add(lasted.max(1));
                self.offset = self.offset.saturating_add(end.saturating_sub(at));
                self.found += 1;
                is_joint = true;
            }
            _ => {}
        }
        let lasted = match self.last {
            _ if length > 0 => length,
            Some([last, _]) if !is_joint && at > last => at - last,
            last => last.map_or(0, |[_, lasted]| lasted),
        };
        self.last = Some([at, lasted]);
        is_joint
    }
}

/// Whether a packet of an Ogg describes a stream.
pub(crate) fn is_ogg_header(packet: &Packet) -> bool {
    let bytes = packet.data().and_then(<[u8]>::split_first);
    bytes.is_some_and(|(first, rest)| {
        OGG_HEADERS
            .iter()
            .any(|(least, name)| first >= least && rest.starts_with(name))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stamps(file: &[i64]) -> (Vec<i64>, u64) {
        let mut joints = Joints::of("mpegts", Rational(1, 1000));
        let mut packet = Packet::empty();
        let stamps = file.iter().map(|at| {
            packet.set_dts(Some(*at));
            packet.set_pts(Some(*at + 80));
            joints.follow(&mut packet);
            assert_eq!(packet.pts().unwrap(), packet.dts().unwrap() + 80);
            packet.dts().unwrap()
        });
        (stamps.collect(), joints.found())
    }

    #[test]
    fn what_begins_again_follows_what_came_before() {
        let even: Vec<i64> = (0..7).map(|number| 500 + 40 * number).collect();
        assert_eq!(stamps(&even), (even.clone(), 0));
        let joined = [500, 540, 580, 0, 40, 500, 540];
        assert_eq!(stamps(&[500, 540, 580, 0, 40, 80, 300]).1, 1);
        assert_eq!(stamps(&[500, 540, 640, 0, 100, 200, 0]).1, 2);
        assert_eq!(stamps(&[500, 540, 580, 0, 40, 80, 120]), (even.clone(), 1));
        // Gaps stay.
        assert_eq!(stamps(&joined).0[5..], [1120, 1160]);
        let round = (1 << 33) / 90;
        assert_eq!(stamps(&[500, 540, round, round + 40]).0, even[..4]);
    }

    #[test]
    fn one_wrong_stamp_is_no_new_beginning() {
        let found = stamps(&[500, 540, 0, 620, 660]);
        assert_eq!(found, (vec![500, 540, 580, 620, 660], 0));
    }
}
