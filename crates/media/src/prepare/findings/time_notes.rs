//! What is odd about when frames are shown?

use foveal_core::units::counted;

/// Frames that stand for longer than this, and than [`MANY`] others, are reported; seconds.
const LONG_S: f64 = 1.0;
/// In frames of the nominal rate.
const MANY: f64 = 10.0;
/// Share of the frames and of the time that a container gives that may be missing, as it may have
/// been estimated, and as many frames.
const MOST_MISSING: f64 = 0.05;
const MOST_FRAMES_MISSING: f64 = 2.0;

/// Seconds until the last frame has been shown.
pub(in crate::prepare) fn length_of(times: &[i64], fps: f64) -> f64 {
    times.last().map_or(0.0, |&last| last as f64 / 1e9) + 1.0 / fps
}

/// What is odd.
pub(in crate::prepare) struct TimeNotes {
    /// In words.
    pub(in crate::prepare) said: Vec<String>,
    /// Whether frames are missing at the end.
    pub(in crate::prepare) ends_early: bool,
}

/// What a person should know of the times of frames in nanoseconds, nominally `fps` a second,
/// `repaired` of which came from stamps that did not rise; the container announced `of` frames.
pub(in crate::prepare) fn time_notes(
    times: &[i64],
    fps: f64,
    repaired: u64,
    of: Option<u64>,
) -> TimeNotes {
    let lengths = times
        .windows(2)
        .map(|pair| (pair[1] - pair[0]) as f64 / 1e9);
    let long = LONG_S.max(MANY / fps);
    let stills = lengths.enumerate().filter(|(_, length)| *length > long);
    let stills: Vec<(usize, f64)> = stills.collect();
    let longest = stills.iter().max_by(|a, b| a.1.total_cmp(&b.1));
    let mut notes = Vec::new();
    if let Some((frame, length)) = longest {
        let others = match stills.len() - 1 {
            0 => String::new(),
            more => format!(
                ", and {} for more than {long:.1} s",
                counted(more, "other frame")
            ),
        };
        notes.push(format!(
            "its time stamps jump: frame {frame} stands for {length:.2} s{others}; where that is \
             not meant, `ffmpeg -i FILE -vf setpts=N/{fps:.3}/TB OUT` evens them out"
        ));
    }
    if repaired > 0 {
        notes.push(format!(
            "its time stamps fail to rise {}; frames there follow at {fps:.3} frames a second",
            counted(repaired, "time")
        ));
    }
    let end = of.and_then(|of| end_note(times, fps, of as f64));
    let ends_early = end.is_some();
    notes.extend(end);
    TimeNotes {
        said: notes,
        ends_early,
    }
}

/// Whether it ends well before `of` frames, in number and in time.
fn end_note(times: &[i64], fps: f64, of: f64) -> Option<String> {
    let frames = times.len() as f64;
    let seconds = length_of(times, fps);
    let most = (of - MOST_FRAMES_MISSING).min(of * (1.0 - MOST_MISSING));
    (frames < most && seconds * fps < most).then(|| {
        format!(
            "it ends after {frames} of about {} that it should have, at {seconds:.2} s; copy it \
             again if it was cut short",
            counted(of, "frame")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_jump_is_told_with_its_frame_and_even_or_slow_times_are_not() {
        let even: Vec<i64> = (0..9).map(|n| n * 40_000_000).collect();
        assert!(time_notes(&even, 25.0, 0, Some(10)).said.is_empty());
        let slow: Vec<i64> = (0..9).map(|n| n * 5_000_000_000).collect();
        assert!(time_notes(&slow, 0.2, 0, None).said.is_empty());
        let mut jumps = even;
        jumps[4..]
            .iter_mut()
            .for_each(|time| *time += 7_000_000_000);
        let told = time_notes(&jumps, 25.0, 2, Some(9)).said.join("\n");
        assert!(told.contains("frame 3 stands for 7.04 s;"), "{told}");
        assert!(told.contains("fail to rise 2 times"), "{told}");
    }

    #[test]
    fn an_end_well_before_what_the_container_tells_is_told() {
        let even: Vec<i64> = (0..50).map(|n| n * 40_000_000).collect();
        let told = |of| time_notes(&even, 25.0, 0, Some(of)).said.join("\n");
        assert!(
            told(100).contains("after 50 of about 100 frames"),
            "{}",
            told(100)
        );
        assert!([0, 40, 50, 52].into_iter().all(|of| told(of).is_empty()));
        // Fewer frames than estimated, as they stand for longer, are no end.
        let sparse: Vec<i64> = (0..50).map(|n| n * 80_000_000).collect();
        assert!(time_notes(&sparse, 25.0, 0, Some(100)).said.is_empty());
    }
}
