//! What does only the reading of an input show, and how does a pack record it?

pub(super) mod time_notes;

use super::error::PrepareError;
use super::plan::PreparationPlan;
use super::sound::SoundFound;
use crate::read::film::mended::Mended;
use foveal_core::content::video::bytes::description::{Description, MAX_FRAMES};
use foveal_core::units::counted;
use std::collections::BTreeMap;
use std::path::Path;
use time_notes::{length_of, time_notes};

/// Bytes of remarks, and of one, that a description has room for once its length is decided.
const MOST_BYTES: usize = 900;
const MOST_OF_ONE: usize = 400;
/// What is done to every film of its kind, and is no damage.
const NO_DAMAGE: [&str; 3] = ["deinterlaced_frames", "joined_recordings", "time_gaps"];
/// A last frame that is shown for longer than this is reported; seconds.
const LONG_LAST_S: f64 = 1.0;
/// By how much the last frame must be shown longer than others, or shorter, to be reported.
const UNLIKE: f64 = 0.05;
/// Of so many frames one place may lack some in an even film of so many at least; a frame that
/// stands for more periods than this is meant to, or reported otherwise.
const HOLES: usize = 50;
const LEAST_EVEN: usize = 8;
const MOST_LENGTH: f64 = 1000.0;
/// Of fewer frames than these it is not said that they are missing at the start.
const LEAST_MISSING: u64 = 2;
/// Codecs of animations, which say of every picture how long it is shown.
pub const ANIMATIONS: [&str; 3] = ["gif", "apng", "webp"];

/// What was found of an input once it was read.
pub(super) struct ReadThrough {
    pub(super) mended: Mended,
    /// How long the last frame is shown, in nanoseconds, where the input was read to its end and
    /// says so.
    pub(super) last_ns: Option<i64>,
    /// Time stamp of the first frame, in nanoseconds.
    pub(super) begins_ns: i64,
}

/// What reading showed.
pub(super) struct Findings {
    /// What a person should know that no plan could say.
    pub(super) warnings: Vec<String>,
    repairs: BTreeMap<String, u64>,
    last_frame_s: Option<f64>,
}

/// What the reading of a planned input showed, whose frames are shown at `times`.
pub(super) fn findings(
    plan: &PreparationPlan,
    times: &[i64],
    through: &ReadThrough,
    sound: &SoundFound,
) -> Findings {
    let fps = plan.description.fps();
    let ReadThrough {
        mended,
        last_ns,
        begins_ns,
    } = through;
    let most = u64::from(plan.most_frames.unwrap_or(MAX_FRAMES));
    // What does not come at the start is reported as that, and not as an end.
    let left_out = mended.dropped_at_start + mended.lost;
    let of = plan
        .frames_told
        .map(|of| of.saturating_sub(left_out).min(most));
    let of = of.filter(|_| mended.breaks_off.is_none());
    let is_short = |of: u64| of > times.len() as u64 + LEAST_MISSING;
    let is_short = mended.breaks_off.is_some() || of.is_some_and(is_short);
    let lacks_start = lacks_start(plan, times, *begins_ns).filter(|_| is_short);
    let of = of.map(|of| of.saturating_sub(lacks_start.unwrap_or(0)));
    let mended = &Mended {
        breaks_off: mended.breaks_off.clone().filter(|_| lacks_start.is_none()),
        ..mended.clone()
    };
    let mut warnings = sound.notes.clone();
    warnings.extend(lacks_start.map(|lost| {
        let begins = *begins_ns as f64 / 1e9;
        let lost = counted(lost, "frame");
        format!("it lacks about {lost} at its start: its time stamps begin at {begins:.2} s")
    }));
    warnings.extend(mended.remarks(times.len() as u64, length_of(times, fps)));
    if mended.is_transparent && !plan.tells_of_transparency {
        warnings.push("what is transparent in it is shown over black".to_owned());
    }
    if plan.is_still && times.len() > 1 {
        warnings.push(format!(
            "it is a row of pictures without a frame rate: {fps:.3} frames a second are taken"
        ));
    }
    let notes = time_notes(times, fps, mended.repaired_stamps, of);
    let mut repairs = mended.repairs();
    if let Some(lost) = lacks_start {
        repairs.insert("missing_frames".to_owned(), lost);
    }
    tell_missing((plan, times), mended, &mut repairs, &mut warnings);
    if notes.ends_early {
        repairs.insert("cut_short".to_owned(), 1);
    }
    if sound.damaged > 0 {
        repairs.insert("damaged_sound_packets".to_owned(), sound.damaged);
    }
    warnings.extend(notes.said);
    let last_frame_s = last_frame_s(plan, times, *last_ns);
    let is_animation = is_animation(plan);
    if let Some(seconds) = last_frame_s.filter(|it| *it > LONG_LAST_S && !is_animation) {
        warnings.push(format!("its last frame is shown for {seconds:.2} s"));
    }
    Findings {
        warnings,
        repairs,
        last_frame_s,
    }
}

fn is_animation(plan: &PreparationPlan) -> bool {
    ANIMATIONS.contains(&plan.description.source.codec.as_str())
}

/// Reports frames that are missing between others.
fn tell_missing(
    (plan, times): (&PreparationPlan, &[i64]),
    mended: &Mended,
    repairs: &mut BTreeMap<String, u64>,
    warnings: &mut Vec<String>,
) {
    let missing = missing_frames(times, plan.description.fps());
    let are_missing = |frames| match frames {
        1 => "1 frame is".to_owned(),
        more => format!("{more} frames are"),
    };
    let is_damaged = mended.damaged + mended.lost + mended.clusters.damaged > 0;
    if is_damaged && missing.is_even && missing.frames > 0 {
        *repairs.entry("missing_frames".to_owned()).or_default() += missing.frames;
        warnings.push(format!(
            "about {} missing where it is damaged; the frame before stays there",
            are_missing(missing.frames)
        ));
    } else if missing.are_holes() && !is_animation(plan) {
        repairs.insert("time_gaps".to_owned(), missing.gaps as u64);
        warnings.push(format!(
            "by its time stamps about {} missing between others, the first after frame {}: lost, \
             or left out when it was recorded; the frame before stays there",
            are_missing(missing.frames),
            missing.first
        ));
    }
}

/// Frames that a film lacks at its start, where its time stamps begin late, and the frames that
/// came are as many fewer than expected.
fn lacks_start(plan: &PreparationPlan, times: &[i64], begins_ns: i64) -> Option<u64> {
    let late = (begins_ns.max(0) as f64 / 1e9 * plan.description.fps()).round() as u64;
    let came = times.len() as u64;
    let fits = |of: u64| of.abs_diff(came.saturating_add(late)) <= LEAST_MISSING;
    (late >= LEAST_MISSING && plan.frames.is_some_and(fits)).then_some(late)
}

/// What a film lacks between frames, by its rate.
struct Missing {
    frames: u64,
    /// The frame before the first gap.
    first: usize,
    gaps: usize,
    /// Lengths between frames that are no period and no gap.
    uneven: usize,
    lengths: usize,
    /// Whether most frames last a period.
    is_even: bool,
}

impl Missing {
    /// Whether few places of an otherwise even film lack frames: one whose rate changes lacks none.
    fn are_holes(&self) -> bool {
        let most = (self.lengths / HOLES).max(1);
        self.gaps > 0 && self.gaps <= most && self.uneven == 0 && self.lengths >= LEAST_EVEN
    }
}

/// Frames that a film of one rate lacks between others.
fn missing_frames(times: &[i64], fps: f64) -> Missing {
    let lengths = times
        .windows(2)
        .map(|pair| (pair[1] - pair[0]) as f64 / 1e9 * fps);
    let lengths: Vec<f64> = lengths.collect();
    let even = lengths.iter().filter(|it| (0.9..1.1).contains(*it)).count();
    let gaps = || lengths.iter().filter(|it| **it > 1.5);
    // A jump is reported as that.
    let is_jump = |length: &f64| *length > MOST_LENGTH;
    let uneven = lengths.len() - even - gaps().count() + gaps().filter(|it| is_jump(it)).count();
    Missing {
        frames: gaps().map(|it| it.round() as u64 - 1).sum(),
        first: lengths.iter().position(|it| *it > 1.5).unwrap_or(0),
        gaps: gaps().count(),
        uneven,
        lengths: lengths.len(),
        is_even: even * 4 >= lengths.len() * 3,
    }
}

/// How long the last frame is shown, where that is known and is not a period.
fn last_frame_s(plan: &PreparationPlan, times: &[i64], last_ns: Option<i64>) -> Option<f64> {
    let codec = plan.description.source.codec.as_str();
    let period = 1.0 / plan.description.fps();
    let seconds = last_ns.filter(|ns| *ns > 0)? as f64 / 1e9;
    let is_long = seconds > period * (1.0 + UNLIKE);
    let is_short = seconds < period * (1.0 - UNLIKE) && ANIMATIONS.contains(&codec);
    (times.len() > 1 && (is_long || is_short)).then_some(seconds.min(86_400.0))
}

impl Findings {
    /// Refuses what was mended, and names all of it.
    pub(super) fn refuse(&self, input: &Path) -> Result<(), PrepareError> {
        let damage = self
            .repairs
            .iter()
            .filter(|(name, _)| !NO_DAMAGE.contains(&name.as_str()));
        let damage: Vec<String> = damage
            .map(|(name, count)| format!("{}: {count}", name.replace('_', " ")))
            .collect();
        match damage.is_empty() {
            true => Ok(()),
            false => Err(PrepareError::Strict(
                input.display().to_string(),
                format!("would have to be mended ({})", damage.join(", ")),
            )),
        }
    }

    /// Writes it into a description, after what the plan said.
    pub(super) fn tell_in(&self, description: &mut Description) {
        let mut left = MOST_BYTES;
        let mut untold = 0;
        for warning in &self.warnings {
            let text: String = warning.chars().take(MOST_OF_ONE).collect();
            match left.checked_sub(serde_length(&text)) {
                Some(rest) => {
                    left = rest;
                    description.remarks.push(text);
                }
                None => untold += 1,
            }
        }
        if untold > 0 {
            let text = format!("{} more when it was prepared", counted(untold, "remark"));
            description.remarks.push(text);
        }
        for (name, count) in &self.repairs {
            *description.repairs.entry(name.clone()).or_default() += count;
        }
        description.last_frame_s = self.last_frame_s;
    }
}

/// Bytes of a text in JSON, at most: with quotes and a comma, escapes counted as long as they get.
fn serde_length(text: &str) -> usize {
    let of = |c: char| match c {
        '"' | '\\' => 2,
        c if c.is_control() => 6,
        c => c.len_utf8(),
    };
    text.chars().map(of).sum::<usize>() + 3
}
