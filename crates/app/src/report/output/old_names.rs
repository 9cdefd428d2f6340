//! Which keys had another name in the version before, and are printed under both for this one?

/// The command, the key, and its old name.
const OLD: [(&str, &str, &str); 41] = [
    ("bench perception", "size_px", "size"),
    ("bench prepare", "prepare_mpix_per_s", "source_mpix_per_s"),
    (
        "bench prepare",
        "prepare_mpix_per_cpu_s",
        "source_mpix_per_cpu_s",
    ),
    ("bench prepare", "prepare_s", "seconds"),
    ("bench prepare", "prepare_cpu_s", "cpu_seconds"),
    ("bench prepare", "bytes", "pack_bytes"),
    ("bench score", "size_px", "size"),
    ("bench video", "size_px", "size"),
    ("demo", "damaged_tiles", "failed_tiles"),
    ("evaluate codecs", "source_bytes", "input_bytes"),
    ("evaluate codecs", "foveated_fps_median", "fps_median"),
    (
        "evaluate codecs",
        "foveated_saccade_fps_p5",
        "fps_saccade_p5",
    ),
    ("evaluate codecs", "full_fps", "fps_full"),
    ("evaluate codecs", "coarsest_fps", "fps_coarsest"),
    ("evaluate grid-sweep", "foveated_fps_median", "fps_median"),
    (
        "evaluate grid-sweep",
        "foveated_saccade_fps_p5",
        "fps_saccade_p5",
    ),
    ("evaluate grid-sweep", "full_fps", "fps_full"),
    ("evaluate grid-sweep", "coarsest_fps", "fps_coarsest"),
    ("gaze eval delay", "delay_ms", "ms"),
    ("gaze eval delay", "last_mean_deg", "last"),
    ("gaze eval delay", "head_mean_deg", "head"),
    ("gaze eval delay", "blend_mean_deg", "blend"),
    ("gaze eval head", "within_5_deg_share", "within_5"),
    ("gaze eval head", "within_10_deg_share", "within_10"),
    ("gaze eval head", "within_15_deg_share", "within_15"),
    ("gaze eval head", "centre_mean_deg", "centre"),
    ("gaze eval head", "sgaze_mean_deg", "sgaze"),
    ("gaze eval head", "foveal_mean_deg", "foveal"),
    ("gaze fit head", "file", "out"),
    ("info", "rate_hz", "rate"),
    ("prepare video", "rate_hz", "rate"),
    ("prepare video", "prepare_s", "seconds"),
    ("prepare video", "prepare_s_per_frame", "seconds_per_frame"),
    ("score", "size_px", "size"),
    ("select", "pixels_share", "share"),
    ("select", "pixels_share_mean", "share_mean"),
    ("select", "pixels_share_p95", "share_p95"),
    ("select", "pixels_share_max", "share_max"),
    ("simulate", "damaged_tiles", "failed_tiles"),
    ("simulate", "size_px", "size"),
    ("view", "sound_ms_max", "sound_ms_worst"),
];

/// A JSON object as `serde_json` writes it, in which every key that had another name stands under
/// that one too, right behind itself.
pub(super) fn with_old_names(command: &str, mut line: String) -> String {
    let command = command.strip_prefix("foveal ").unwrap_or(command);
    for (_, key, old) in OLD.iter().filter(|(of, ..)| *of == command) {
        line = doubled(&line, key, old);
    }
    line
}

fn doubled(line: &str, key: &str, old: &str) -> String {
    // Quotes within a text are escaped, so this stands nowhere but before the value of a key.
    let start = format!("\"{key}\":");
    let (mut out, mut rest) = (String::with_capacity(line.len() + 64), line);
    while let Some(at) = rest.find(&start) {
        let (before, after) = rest.split_at(at + start.len());
        let (value, next) = after.split_at(value_length(after));
        out.extend([before, value, ",\"", old, "\":", value]);
        rest = next;
    }
    out.push_str(rest);
    out
}

/// Bytes of the value that a text begins with.
fn value_length(text: &str) -> usize {
    let (mut depth, mut quoted, mut escaped) = (0_usize, false, false);
    for (at, byte) in text.bytes().enumerate() {
        match byte {
            _ if escaped => escaped = false,
            b'\\' => escaped = true,
            b'"' => quoted = !quoted,
            _ if quoted => {}
            b'{' | b'[' => depth += 1,
            b',' | b'}' | b']' if depth == 0 => return at,
            b'}' | b']' => depth -= 1,
            _ => {}
        }
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::with_old_names;

    #[test]
    fn a_key_with_an_old_name_stands_there_under_both() {
        let line = |old: [&str; 2]| {
            format!(
                r#"{{"a":"\"pixels_share\":1,","pixels_share":0.5{},{}{}}}]}}"#,
                old[0], r#""b":[{"pixels_share":[1,{"c":"]"}]"#, old[1]
            )
        };
        let plain = line(["", ""]);
        let both = line([r#","share":0.5"#, r#","share":[1,{"c":"]"}]"#]);
        assert_eq!(with_old_names("foveal select", plain.clone()), both);
        assert_eq!(with_old_names("foveal info", plain.clone()), plain);
    }
}
