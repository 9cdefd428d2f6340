//! What does a TypeScript file say to people, and what does it import?

/// What is being read.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Part {
    Code,
    /// Up to the end of the line.
    Line,
    Block,
    /// Up to this quote, which is in it.
    Text(char),
    /// A pattern: `/ab+/`.
    Pattern,
}

/// `text` with code as spaces; lines stay where they were. Enough of the grammar for prose.
pub(crate) fn comments_and_texts(text: &str) -> String {
    let chars: Vec<char> = text.chars().collect();
    let mut kept = String::with_capacity(text.len());
    let mut part = Part::Code;
    // Braces that are open in each value that stands within a template.
    let mut values: Vec<usize> = Vec::new();
    let mut at = 0;
    while at < chars.len() {
        let (c, next) = (chars[at], chars.get(at + 1).copied());
        let mut taken = 1;
        let mut is_prose = !matches!(part, Part::Code | Part::Pattern);
        match (part, c) {
            (Part::Code, '/') if next == Some('/') => part = Part::Line,
            (Part::Code, '/') if next == Some('*') => (part, taken) = (Part::Block, 2),
            (Part::Code, '/') if begins_pattern(&chars[..at]) => part = Part::Pattern,
            (Part::Code, '"' | '\'' | '`') => part = Part::Text(c),
            (Part::Code, '{') => values.iter_mut().last().into_iter().for_each(|it| *it += 1),
            (Part::Code, '}') => match values.last_mut() {
                Some(0) => {
                    values.pop();
                    part = Part::Text('`');
                }
                Some(open) => *open -= 1,
                None => {}
            },
            (Part::Line | Part::Pattern, '\n') => part = Part::Code,
            (Part::Block, '*') if next == Some('/') => (part, taken) = (Part::Code, 2),
            (Part::Text(_) | Part::Pattern, '\\') => taken = 2,
            (Part::Pattern, '/') => part = Part::Code,
            (Part::Text('`'), '$') if next == Some('{') => {
                values.push(0);
                (part, taken, is_prose) = (Part::Code, 2, false);
            }
            (Part::Text(quote), _) if c == quote => (part, is_prose) = (Part::Code, false),
            _ => {}
        }
        for &c in chars.iter().skip(at).take(taken) {
            kept.push(if is_prose || c == '\n' { c } else { ' ' });
        }
        at += taken;
    }
    kept
}

/// Whether a `/` after this code begins a pattern, and is no division.
fn begins_pattern(before: &[char]) -> bool {
    let last = before.iter().rev().find(|c| !c.is_whitespace());
    last.is_none_or(|c| "(,=:[!&|?{};".contains(*c))
}

/// What a file imports or hands on, at the beginning of lines and all at once: the names, and from
/// where.
pub(crate) fn imports(text: &str) -> Vec<(String, String)> {
    let mut found = Vec::new();
    let mut statement: Option<String> = None;
    for line in text.lines() {
        if line.starts_with("import ") || line.starts_with("export ") {
            statement = Some(String::new());
        }
        let Some(begun) = &mut statement else {
            continue;
        };
        *begun += line;
        begun.push(' ');
        let Some((names, path)) = begun.split_once("from \"") else {
            statement = statement.filter(|_| !line.contains(['=', '(', ';']));
            continue;
        };
        let is_name = |word: &&str| !["", "import", "export", "type", "as"].contains(word);
        let words = names.split(|c: char| !(c.is_alphanumeric() || c == '_'));
        let names: Vec<&str> = words.filter(is_name).collect();
        let path = path.split('"').next().unwrap_or_default();
        found.push((names.join(", "), path.to_owned()));
        statement = None;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<String> {
        let kept = comments_and_texts(text);
        let words = kept.split(|c: char| !c.is_alphanumeric());
        words
            .filter(|it| !it.is_empty())
            .map(str::to_owned)
            .collect()
    }

    #[test]
    fn comments_strings_and_templates_are_for_people() {
        assert_eq!(
            words("a = 1; // b\n/* c\n d */ e(\"f\", 'g', `h`)"),
            ["b", "c", "d", "f", "g", "h"]
        );
        assert_eq!(words("`a ${b({ c: `d ${e}` })} f` + g"), ["a", "d", "f"]);
    }

    #[test]
    fn patterns_and_divisions_are_code() {
        assert_eq!(words("x.match(/\"a'/u); b / c; \"d\""), ["d"]);
        assert_eq!(words("a / b; c / d; \"e \\\" f\""), ["e", "f"]);
    }

    #[test]
    fn lines_stay_where_they_were() {
        let text = "a\n`b\n${c\n}`\n// d\n";
        assert_eq!(
            comments_and_texts(text).lines().count(),
            text.lines().count()
        );
    }
}
