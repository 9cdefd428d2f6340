//! Which numbers stand in words that have no blank between them?
//!
//! Fortran and `printf` write columns of a fixed width, in which a sign may follow a digit
//! (`0.5-0.3`). Fortran leaves out the letter of an exponent of three digits (`0.5-103`). Others
//! write commas without blanks (`1,2,3`). Which of these a word is shows the number of columns.

use super::numbers::number_of;

/// Most words that are looked at.
const MOST_WORDS: usize = 64;

/// The numbers of words, if they are as many as `fits` asks for.
pub(in crate::read) fn numbers<'a>(
    words: impl Iterator<Item = &'a str>,
    fits: impl Fn(usize) -> bool,
) -> Option<Vec<f64>> {
    let words: Vec<&str> = words.take(MOST_WORDS + 1).collect();
    if words.len() > MOST_WORDS {
        return None;
    }
    let apart: Vec<&str> = words.iter().flat_map(|word| parted(word)).collect();
    let is_one_a_word = fits(words.len());
    if !is_one_a_word && !fits(apart.len()) {
        return None;
    }
    let number = |word: &str| number_of(word, &mut 0);
    match is_one_a_word {
        true => words
            .iter()
            .map(|it| number(it).or_else(|| short(it)))
            .collect(),
        false => apart.into_iter().map(number).collect(),
    }
}

/// The parts of a word, which begin at each sign that follows a digit or a point, and end at each
/// comma or semicolon.
fn parted(word: &str) -> impl Iterator<Item = &str> {
    let parts = word.split([',', ';']).filter(|part| !part.is_empty());
    parts.flat_map(|part| {
        let mut rest = Some(part);
        std::iter::from_fn(move || {
            let part = rest?;
            let is_end = |pair: &[u8]| {
                (pair[0].is_ascii_digit() || pair[0] == b'.') && matches!(pair[1], b'-' | b'+')
            };
            let cut = part.as_bytes().windows(2).position(is_end);
            let cut = cut.map(|before| before + 1);
            rest = cut.and_then(|cut| part.get(cut..));
            Some(cut.and_then(|cut| part.get(..cut)).unwrap_or(part))
        })
    })
}

/// A number whose exponent has no letter, but three digits.
fn short(word: &str) -> Option<f64> {
    let mut parts = parted(word);
    let (size, power, None) = (parts.next()?, parts.next()?, parts.next()) else {
        return None;
    };
    let digits = power.as_bytes().get(1..)?;
    let has_three = digits.len() == 3 && digits.iter().all(u8::is_ascii_digit);
    let number = has_three.then(|| format!("{size}e{power}"))?;
    number.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sign_after_a_digit_begins_a_number_where_columns_are_missing() {
        let of =
            |line: &str, columns: usize| numbers(line.split_ascii_whitespace(), |it| it == columns);
        assert_eq!(of("0.5-0.3 1", 3), Some(vec![0.5, -0.3, 1.0]));
        assert_eq!(of("-1.-2.+3", 3), Some(vec![-1.0, -2.0, 3.0]));
        assert_eq!(of("1e-3-2E+1-3", 3), Some(vec![1e-3, -20.0, -3.0]));
        assert_eq!(of("0.5-103 1 2", 3), Some(vec![0.5e-103, 1.0, 2.0]));
        assert_eq!(of("1,-2,3", 3), Some(vec![1.0, -2.0, 3.0]));
        assert_eq!(of("1.5,2.5;3-4", 4), Some(vec![1.5, 2.5, 3.0, -4.0]));
        assert_eq!(of("0.5-0.3 1 2", 3), None);
        assert_eq!(of("0.5-x 1", 3), None);
        assert_eq!(of("0.5-0.3 1", 4), None);
        assert_eq!(of("1,\u{ad}\u{ad} 2 3", 3), None);
    }
}
