//! Which bytes does a `Range` header ask for?
//!
//! RFC 9110 section 14. One range of bytes is answered; several at once, other units and what is
//! malformed count as no range, as the RFC allows.

/// What of a file is sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    /// All of it.
    Whole,
    /// From the first to the last of these, both included.
    Range(u64, u64),
    /// Nothing: the range lies outside.
    Outside,
}

/// The part of a file of `length` bytes that this header names.
pub(super) fn part_of(header: &str, length: u64) -> Part {
    let Some((unit, range)) = header.trim().split_once('=') else {
        return Part::Whole;
    };
    if !unit.eq_ignore_ascii_case("bytes") {
        return Part::Whole;
    }
    let Some((first, last)) = range.trim().split_once('-') else {
        return Part::Whole;
    };
    let digits = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    // What does not fit into 64 bits lies beyond any file.
    let number = |text: &str| text.parse().unwrap_or(u64::MAX);
    match (digits(first), digits(last)) {
        (true, true) if number(last) < number(first) => Part::Whole,
        (true, _) if !last.is_empty() && !digits(last) => Part::Whole,
        (true, _) if number(first) >= length => Part::Outside,
        (true, true) => Part::Range(number(first), number(last).min(length - 1)),
        (true, false) => Part::Range(number(first), length - 1),
        (false, true) if !first.is_empty() => Part::Whole,
        (false, true) if number(last) == 0 || length == 0 => Part::Outside,
        (false, true) => Part::Range(length.saturating_sub(number(last)), length - 1),
        (false, false) => Part::Whole,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn ranges_are_clipped_to_the_file() {
        assert_eq!(part_of("bytes=0-0", 10), Part::Range(0, 0));
        assert_eq!(part_of("bytes=2-", 10), Part::Range(2, 9));
        assert_eq!(part_of("bytes=2-99", 10), Part::Range(2, 9));
        assert_eq!(part_of("bytes=-3", 10), Part::Range(7, 9));
        assert_eq!(part_of("bytes=-99", 10), Part::Range(0, 9));
        assert_eq!(
            part_of("bytes=0-99999999999999999999", 10),
            Part::Range(0, 9)
        );
    }

    #[test]
    fn ranges_outside_are_told_from_no_ranges() {
        for outside in [
            "bytes=10-",
            "bytes=10-12",
            "bytes=-0",
            "bytes=99999999999999999999-",
        ] {
            assert_eq!(part_of(outside, 10), Part::Outside, "{outside}");
        }
        assert_eq!(part_of("bytes=0-", 0), Part::Outside);
        let none =
            "bytes=|bytes=-|bytes=3-2|bytes=0-1,3-4|bytes=a-b|items=0-1|bytes 0-1|bytes=+1-2";
        for none in none.split('|') {
            assert_eq!(part_of(none, 10), Part::Whole, "{none}");
        }
    }

    proptest! {
        #[test]
        fn a_part_lies_within_the_file(header in ".{0,24}|bytes=[0-9]{0,3}-[0-9]{0,3}",
                                       length in 0_u64..200) {
            if let Part::Range(first, last) = part_of(&header, length) {
                prop_assert!(first <= last && last < length);
            }
        }
    }
}
