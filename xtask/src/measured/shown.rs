//! How is a figure written in a document?

/// `value` as `format` asks: `.2` has two digits after the point, `%1` is a percentage with one,
/// `n` a whole number in groups of three, `MB1` megabytes with one digit, `ms1` milliseconds of
/// seconds, `x2` as `.2` and a `×`.
pub(super) fn shown(value: f64, format: &str) -> Option<String> {
    let digits = |from: usize| format.get(from..)?.parse::<usize>().ok();
    let text = match format {
        "n" => grouped(value),
        _ if format.starts_with('.') => format!("{value:.*}", digits(1)?),
        _ if format.starts_with('%') => format!("{:.*} %", digits(1)?, value * 100.0),
        _ if format.starts_with("MB") => format!("{:.*} MB", digits(2)?, value / 1e6),
        _ if format.starts_with("kB") => format!("{:.*} kB", digits(2)?, value / 1e3),
        _ if format.starts_with("ms") => format!("{:.*} ms", digits(2)?, value * 1e3),
        _ if format.starts_with('x') => format!("{value:.*}×", digits(1)?),
        _ => return None,
    };
    Some(text)
}

fn grouped(value: f64) -> String {
    let text = format!("{value:.0}");
    let (sign, digits) = text
        .strip_prefix('-')
        .map_or(("", &*text), |rest| ("-", rest));
    let mut groups: Vec<&str> = Vec::new();
    let mut rest = digits;
    while rest.len() > 3 {
        let (before, last) = rest.split_at(rest.len() - 3);
        groups.insert(0, last);
        rest = before;
    }
    groups.insert(0, rest);
    format!("{sign}{}", groups.join(","))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_written_as_their_formats_say() {
        let all = [
            (0.245_3, "%1", "24.5 %"),
            (1_037_435.0, "n", "1,037,435"),
            (12.0, "n", "12"),
            (9.349, ".2", "9.35"),
            (4.2e6, "MB1", "4.2 MB"),
            (0.163, "ms0", "163 ms"),
            (72.4, "x0", "72×"),
        ];
        for (value, format, expected) in all {
            assert_eq!(shown(value, format).as_deref(), Some(expected));
        }
        assert_eq!(shown(1.0, "?"), None);
    }
}
