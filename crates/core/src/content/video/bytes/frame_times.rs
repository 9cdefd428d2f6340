//! When is each frame of a pack shown?

use crate::content::video::bytes::description::Description;
use crate::pack::PackError;
use crate::units::counted;

/// Name of the side table.
pub const FRAME_TIMES: &str = "frame_times";

/// Nanoseconds after the first frame, where no table says them: evenly at the nominal rate.
#[must_use]
pub fn nominal_times(description: &Description) -> Vec<i64> {
    let fps = description.fps();
    let time = |frame| (f64::from(frame) * 1e9 / fps) as i64;
    (0..description.frames).map(time).collect()
}

/// Reads the side table of a pack of `frames` frames: nanoseconds after the first.
pub fn parse_frame_times(frames: u32, version: u32, bytes: &[u8]) -> Result<Vec<i64>, PackError> {
    let wrong = |found: String| {
        let expected = format!(
            "version 1: {} of 8 bytes that grow",
            counted(frames, "time")
        );
        PackError::new(&format!("side table {FRAME_TIMES}"), found, expected)
    };
    if version != 1 || bytes.len() as u64 != u64::from(frames) * 8 {
        return Err(wrong(format!(
            "version {version}, {}",
            counted(bytes.len(), "byte")
        )));
    }
    let number = |word: &[u8]| {
        let bytes = word.iter().rev();
        bytes.fold(0, |time, byte| time << 8 | i64::from(*byte))
    };
    let times: Vec<i64> = bytes.chunks_exact(8).map(number).collect();
    if let Some(first) = times.first().filter(|first| **first != 0) {
        return Err(wrong(format!("frame 0 at {first}, not at 0")));
    }
    match times.windows(2).position(|pair| pair[1] <= pair[0]) {
        Some(frame) => Err(wrong(format!(
            "frame {} not after the one before",
            frame + 1
        ))),
        None => Ok(times),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_read_back_and_those_that_do_not_grow_are_refused() {
        let bytes = |times: &[i64]| -> Vec<u8> {
            let words = times.iter().map(|time| time.to_le_bytes());
            words.flatten().collect()
        };
        let good = [0, 33_000_000, 70_000_000];
        assert_eq!(parse_frame_times(3, 1, &bytes(&good)), Ok(good.to_vec()));
        for (frames, version, times) in [
            (2, 1, &good[..]),
            (3, 2, &good[..]),
            (2, 1, &[1, 5][..]),
            (2, 1, &[i64::MIN, 0][..]),
            (3, 1, &[0, 5, 5][..]),
        ] {
            assert!(parse_frame_times(frames, version, &bytes(times)).is_err());
        }
    }
}
