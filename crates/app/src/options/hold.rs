//! For how long is shown what never moves?

use crate::report::output::WrongUsage;
use anyhow::{Context, bail};
use clap::Args;
use foveal_core::units::Seconds;

/// Longest time that is played of what has no end of its own, in seconds: more needs a number of
/// frames.
pub(crate) const LONGEST_S: f64 = 3600.0;
/// Pictures a second of a still where no interval is given.
pub(crate) const STILL_HZ: f64 = 30.0;

/// How long a still is shown.
#[derive(Clone, Debug, Args)]
pub(crate) struct HoldOptions {
    /// Stills, and scenes before a viewer who stands still: for how long they are shown, in
    /// seconds, at most 3600 (default: as long as the trace of --gaze lasts; without a trace a
    /// still is one picture).
    #[arg(long, value_name = "SECONDS", value_parser = parse_hold)]
    pub(crate) hold: Option<Seconds>,
}

impl HoldOptions {
    /// Refuses it for what has a length of its own, such as `a video of 50 frames`.
    pub(crate) fn refuse_for(&self, what: &str) -> Result<(), WrongUsage> {
        self.hold.map_or(Ok(()), |_| Err(moves(what)))
    }
}

/// Why `--hold` does not apply to something that moves.
pub(crate) fn moves(what: &str) -> WrongUsage {
    WrongUsage(format!(
        "--hold is for what never moves, and this is {what}; leave it out"
    ))
}

/// Pictures, one every `interval`, of what is shown for so long; at least one.
pub(crate) fn pictures_in(length: Seconds, interval: Seconds) -> Result<u32, WrongUsage> {
    if length.0 > LONGEST_S {
        return Err(WrongUsage(format!(
            "--gaze: the trace lasts {:.0} s, more than the {LONGEST_S} s that are played \
             without being asked for; give --hold SECONDS or --frames N",
            length.0
        )));
    }
    // What lasts a whole number of intervals, but for rounding, has as many pictures.
    Ok((length.0 / interval.0 - 1e-6).ceil().max(1.0) as u32)
}

/// Reads the value of `--hold`.
pub(crate) fn parse_hold(text: &str) -> anyhow::Result<Seconds> {
    let seconds: f64 = text
        .trim()
        .parse()
        .context("expected a number of seconds, as 2.5")?;
    if seconds > 0.0 && seconds <= LONGEST_S {
        Ok(Seconds(seconds))
    } else {
        bail!("{seconds} is not above 0 and at most {LONGEST_S} seconds")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_held_has_a_picture_for_every_interval_that_begins_within() {
        let of = |length: f64, interval| pictures_in(Seconds(length), Seconds(interval)).unwrap();
        let third = 1.0 / 30.0;
        assert_eq!(
            [0.0, 0.01, third, 0.1, 2.0].map(|it| of(it, third)),
            [1, 1, 1, 3, 60]
        );
        assert_eq!(of(3600.0, 0.001), 3_600_000);
        assert!(pictures_in(Seconds(3601.0), Seconds(1.0)).is_err());
    }

    #[test]
    fn a_length_is_a_number_of_seconds_above_nothing() {
        assert_eq!(parse_hold("2.5").unwrap(), Seconds(2.5));
        for wrong in ["0", "-1", "nan", "inf", "3601", "2s", ""] {
            assert!(parse_hold(wrong).is_err(), "{wrong}");
        }
    }
}
