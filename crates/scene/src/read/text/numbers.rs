//! Which number is a word?

/// Most digits of a number that is read here: ten to this power is less than 2^64.
const MOST_DIGITS: usize = 19;
/// Whole numbers up to here are exact.
const MOST_EXACT: u64 = 1 << 53;
const TENS: [f64; MOST_DIGITS + 1] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19,
];

/// The number at the start of a text and its length, where that is a few digits, maybe a sign
/// before and a point between them, and a blank or the end follows. Such digits and powers of ten
/// are exact, so that dividing them rounds once, to what any reader gives. Source: Clinger 1990,
/// "How to Read Floating Point Numbers Accurately".
pub(in crate::read) fn plain_number(text: &[u8]) -> Option<(f64, usize)> {
    let is_negative = text.first() == Some(&b'-');
    let begin = usize::from(is_negative);
    let (mut whole, mut at, mut point) = (0_u64, begin, None);
    loop {
        let byte = text.get(at).copied().unwrap_or(b' ');
        match byte {
            b'0'..=b'9' => whole = whole.wrapping_mul(10).wrapping_add(u64::from(byte - b'0')),
            b'.' if point.is_none() => point = Some(at),
            _ if byte.is_ascii_whitespace() => break,
            _ => return None,
        }
        at += 1;
    }
    let digits = at - begin - usize::from(point.is_some());
    if digits == 0 || digits > MOST_DIGITS || whole > MOST_EXACT {
        return None;
    }
    let behind = point.map_or(0, |point| at - point - 1);
    let size = whole as f64 / TENS[behind];
    Some((if is_negative { -size } else { size }, at))
}

/// The number that a word is, maybe NaN or infinity, as any program writes it: also as C does on
/// Windows, as Fortran, and with a decimal comma, which is counted. `None` if it is not.
pub(in crate::read) fn number_of(word: &str, commas: &mut usize) -> Option<f64> {
    if let Ok(number) = word.parse() {
        return Some(number);
    }
    let small = word.to_ascii_lowercase();
    let bare = small.trim_start_matches(['+', '-']);
    let [is_nan, is_infinite] = [
        &["nan", "1.#qnan", "1.#snan", "1.#ind"][..],
        &["inf", "1.#inf", "1.#j"],
    ]
    .map(|names| names.iter().any(|name| bare.starts_with(name)));
    if is_nan {
        return Some(f64::NAN);
    }
    if is_infinite {
        return Some(f64::INFINITY);
    }
    if let Some((whole, part)) = small.split_once(',') {
        // A comma behind a number parts it from the next.
        let number = match part {
            "" => return whole.parse().ok(),
            _ => format!("{whole}.{part}").parse().ok(),
        };
        *commas += usize::from(number.is_some());
        return number;
    }
    // C ends real numbers with a letter.
    let bare = small.strip_suffix(['f', 'd']).unwrap_or(&small);
    let is_number = bare.ends_with(|it: char| it.is_ascii_digit() || it == '.');
    let word = if is_number { bare } else { &small };
    word.replace('d', "e").parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_numbers_are_those_of_any_reader_to_the_last_bit() {
        let words = [
            "0",
            "-0",
            "7",
            "5.",
            ".5",
            "-.25",
            "0.1",
            "-123.456",
            "9007199254740992",
            "0.3",
            "1234567.8901234",
            "0.000000000000000001",
            "18446744073709551616",
            "1.7976931348623157",
            "9007199254740993",
            "00000000000000000000001",
            "0.30000000000000004",
            "-12.5",
        ];
        for word in words {
            let right: f64 = word.parse().unwrap();
            if let Some((number, length)) = plain_number(format!("{word} 8").as_bytes()) {
                assert_eq!(
                    (number.to_bits(), length),
                    (right.to_bits(), word.len()),
                    "{word}"
                );
            }
        }
        assert_eq!(plain_number(b"-123.456\t"), Some((-123.456, 8)));
        for word in [
            "", "-", ".", "+1", "1e5", "1,5", "1-2", "nan", "1..2", "--1",
        ] {
            assert_eq!(plain_number(word.as_bytes()), None, "{word}");
        }
    }

    #[test]
    fn numbers_are_read_however_they_are_written() {
        let mut commas = 0;
        for (word, number) in [
            ("-1.5e3", -1500.0),
            ("+.5", 0.5),
            ("5.", 5.0),
            ("1.0e+003", 1000.0),
            ("1.5D+02", 150.0),
            ("2,", 2.0),
            ("-0,25", -0.25),
            ("1.0f", 1.0),
            ("-2.F", -2.0),
            ("1e3f", 1000.0),
        ] {
            assert_eq!(number_of(word, &mut commas), Some(number), "{word}");
        }
        assert_eq!(commas, 1);
        for word in ["nan", "-nan(ind)", "1.#QNAN", "-1.#IND00", "NaN"] {
            assert!(number_of(word, &mut commas).is_some_and(f64::is_nan));
        }
        for word in ["inf", "-Infinity", "1e999", "1.#INF", "-1.#J"] {
            assert!(number_of(word, &mut commas).is_some_and(f64::is_infinite));
        }
        for word in ["x", "", "1,2,3", "--", "d", "f", "-f"] {
            assert_eq!(number_of(word, &mut commas), None, "{word}");
        }
    }
}
