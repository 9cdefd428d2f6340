//! Has every row of a table as many cells as its head?

use super::Finding;
use super::known::Breach;

/// Checks the tables of a document of the root or of `docs/`.
pub(super) fn check(path: &str, text: &str) -> Vec<Breach> {
    let is_document = path.ends_with(".md") && (!path.contains('/') || path.starts_with("docs/"));
    if !is_document {
        return Vec::new();
    }
    let mut breaches = Vec::new();
    let mut head = None;
    let mut before: Option<Vec<&str>> = None;
    let mut fenced = false;
    for (number, line) in (1..).zip(text.lines()) {
        fenced ^= line.trim_start().starts_with("```");
        let cells = if fenced { None } else { cells(line) };
        if cells.as_deref().is_some_and(is_rule) {
            head = head.or(before.as_ref().map(Vec::len));
        }
        before = cells;
        let Some(cells) = &before else {
            head = None;
            continue;
        };
        if head.is_some_and(|head| head != cells.len()) {
            let message = format!(
                "{} cells, the head has {}: mend the row; a | of a cell is \\|, in backticks too",
                cells.len(),
                head.unwrap_or_default()
            );
            let key = format!("{path} {}", cells[0]);
            breaches.push(Breach::new(
                "tables",
                key,
                Finding::new(path, number, message),
            ));
        }
    }
    breaches
}

/// The cells of a row; nothing where the line is none. A bar splits a cell wherever it stands, even
/// in backticks, unless a backslash is before it.
fn cells(line: &str) -> Option<Vec<&str>> {
    let row = line.trim().strip_prefix('|')?;
    let is_escaped = |at: usize| row[..at].ends_with('\\');
    let bars = row.match_indices('|').map(|(at, _)| at);
    let mut cells = Vec::new();
    let mut start = 0;
    for bar in bars.filter(|&at| !is_escaped(at)) {
        cells.push(row[start..bar].trim());
        start = bar + 1;
    }
    if start < row.len() {
        cells.push(row[start..].trim());
    }
    Some(cells)
}

/// Is it the line under a head?
fn is_rule(cells: &[&str]) -> bool {
    !cells.is_empty()
        && cells.iter().all(|cell| {
            let dashes = cell.trim_matches(':');
            !dashes.is_empty() && dashes.chars().all(|c| c == '-')
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &str) -> Vec<String> {
        let found = check("docs/a.md", text);
        found.iter().map(|breach| breach.key().to_owned()).collect()
    }

    #[test]
    fn a_row_with_more_or_fewer_cells_than_its_head_is_reported() {
        let table = "| a | b |\n|---|:-:|\n| 1 | 2 |\n| 3 | 4 | 5 |\n| 6 |\n| 7 | |\n";
        assert_eq!(lines(table), ["docs/a.md 3", "docs/a.md 6"]);
        assert_eq!(lines("| a | b |\n|---|\n"), ["docs/a.md ---"]);
    }

    #[test]
    fn an_escaped_bar_is_no_border_and_one_in_backticks_is() {
        assert!(lines("| a | b |\n|---|---|\n| `1\\|2` | 3 |\n| \\| | |").is_empty());
        assert_eq!(
            lines("| a | b |\n|---|---|\n| `1|2` | 3 |"),
            ["docs/a.md `1"]
        );
    }

    #[test]
    fn each_table_has_its_own_head_and_code_has_none() {
        let two = "| a |\n|---|\n| 1 |\n\n| a | b |\n|---|---|\n| 1 | 2 |\n";
        assert!(lines(two).is_empty());
        assert!(lines("```\n| a |\n|---|\n| 1 | 2 |\n```\n| x | y |\n| z |").is_empty());
        assert!(check("crates/x/README.md", "| a |\n|---|\n| 1 | 2 |").is_empty());
    }
}
