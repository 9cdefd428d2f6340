//! Which known word is nearest to one that is not, and on which line does a byte stand?

/// The line of a byte, counted from 1.
pub(crate) fn line_number(text: &str, byte: usize) -> usize {
    let before = text.as_bytes().iter().take(byte);
    before.filter(|it| **it == b'\n').count() + 1
}

/// The word of `known` that takes the fewest changes.
pub(crate) fn nearest<'a>(known: impl IntoIterator<Item = &'a str>, word: &str) -> Option<&'a str> {
    known.into_iter().min_by_key(|it| edits(it, word))
}

/// How many letters are to be changed, added or taken away to make one word of another
/// (Levenshtein 1966); of a long word only the first letters count.
fn edits(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().take(64).collect();
    let mut before: Vec<usize> = (0..=b.len()).collect();
    for (row, letter) in a.chars().enumerate() {
        let mut now = vec![row + 1];
        for (column, other) in b.iter().enumerate() {
            let changed = before[column] + usize::from(letter != *other);
            let least = changed.min(before[column + 1] + 1).min(now[column] + 1);
            now.push(least);
        }
        before = now;
    }
    before[b.len()]
}
