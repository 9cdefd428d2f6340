//! What is odd about when frames are shown?

/// Frames that stand for longer than this, and than [`MANY`] others, are told; seconds.
const LONG_S: f64 = 1.0;
/// In frames of the nominal rate.
const MANY: f64 = 10.0;

/// What a person should know of the times of frames in nanoseconds, nominally `fps` a second,
/// `repaired` of which came from stamps that did not rise.
pub(super) fn time_notes(times: &[i64], fps: f64, repaired: u64) -> Vec<String> {
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
            more => format!("; {more} other frames stand for more than {long:.1} s"),
        };
        notes.push(format!(
            "its time stamps jump: frame {frame} stands for {length:.2} s{others}; where that is \
             not meant, `ffmpeg -i FILE -vf setpts=N/{fps:.3}/TB OUT` evens them out"
        ));
    }
    if repaired > 0 {
        notes.push(format!(
            "{repaired} of its time stamps do not rise; their frames follow at {fps:.3} frames a \
             second"
        ));
    }
    notes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_jump_is_told_with_its_frame_and_even_or_slow_times_are_not() {
        let even: Vec<i64> = (0..9).map(|n| n * 40_000_000).collect();
        assert!(time_notes(&even, 25.0, 0).is_empty());
        let slow: Vec<i64> = (0..9).map(|n| n * 5_000_000_000).collect();
        assert!(time_notes(&slow, 0.2, 0).is_empty());
        let mut jumps = even;
        jumps[4..]
            .iter_mut()
            .for_each(|time| *time += 7_000_000_000);
        let told = time_notes(&jumps, 25.0, 2).join("\n");
        assert!(told.contains("frame 3 stands for 7.04 s;"), "{told}");
        assert!(told.contains("2 of its time stamps"), "{told}");
    }
}
