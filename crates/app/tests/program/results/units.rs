//! Which unit does the ending of a key say?

/// Which of many values a key is; behind the unit.
const WHICH: [&str; 10] = [
    "_mean",
    "_median",
    "_max",
    "_p5",
    "_p90",
    "_p95",
    "_worst",
    "_per_frame",
    "_per_level",
    "_most",
];

/// Endings and what they say; of two that fit the longer one counts.
const ENDINGS: [(&str, &str); 30] = [
    ("arcmin", "arcmin"),
    ("bytes", "bytes"),
    ("cd_m2", "cd/m²"),
    ("cpd", "cycles/degree"),
    ("db", "dB"),
    ("deg", "degrees"),
    ("deg_s", "degrees/s"),
    ("degrees", "degrees"),
    ("file", "path"),
    ("fps", "frames/s"),
    ("frames", "frames"),
    ("hz", "Hz"),
    ("jod", "JOD"),
    ("mbit_s", "Mbit/s"),
    ("mib", "MiB"),
    ("megapixels", "Mpx"),
    ("mpix_per_cpu_s", "Mpx/s"),
    ("mpix_per_s", "Mpx/s"),
    ("ms", "ms"),
    ("per_deg2", "1/degree²"),
    ("per_minute", "1/minute"),
    ("pixels", "pixels"),
    ("ppd", "pixels/degree"),
    ("px", "pixels"),
    ("ratio", "ratio"),
    ("s", "s"),
    ("samples", "samples"),
    ("seconds", "s"),
    ("share", "share"),
    ("tiles", "tiles"),
];

/// The unit that a key of this name must have, if its ending says one.
pub(super) fn unit_of(key: &str) -> Option<&'static str> {
    let mut key = key;
    while let Some(shorter) = WHICH.iter().find_map(|which| key.strip_suffix(which)) {
        key = shorter;
    }
    let fits = |ending: &str| {
        let before = key.strip_suffix(ending);
        before.is_some_and(|before| before.is_empty() || before.ends_with('_'))
    };
    let fitting = ENDINGS.iter().filter(|(ending, _)| fits(ending));
    let longest = fitting.max_by_key(|(ending, _)| ending.len());
    longest.map(|(_, unit)| *unit)
}

#[test]
fn an_ending_says_the_unit_whatever_stands_behind_it() {
    for (key, unit) in [
        ("decode_ms_p95", Some("ms")),
        ("seconds", Some("s")),
        ("prepare_mpix_per_s", Some("Mpx/s")),
        ("within_5_deg_share", Some("share")),
        ("bytes_per_level", Some("bytes")),
        ("prepare_s_per_frame", Some("s")),
        ("levels", None),
        ("pixels_of_full", None),
    ] {
        assert_eq!(unit_of(key), unit, "{key}");
    }
}
