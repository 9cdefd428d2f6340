//! What does a document say once its tables are written from figures?
//!
//! A table stands between `<!-- measured NAME -->` and `<!-- end -->`. Its text has figures as
//! `{run.figure:format}`.

use super::list::{LIST, List};
use super::shown::shown;

const END: &str = "<!-- end -->";

/// The text of a document with every table of the list in its place.
pub(super) fn written(list: &List, file: &str, text: &str) -> Result<String, String> {
    let mut text = text.to_owned();
    for table in list.tables.iter().filter(|table| table.file == file) {
        let begin = format!("<!-- measured {} -->", table.name);
        let (before, rest) = text
            .split_once(&begin)
            .ok_or_else(|| format!("{begin} is missing, where {LIST} has a table for it"))?;
        let (_, after) = rest
            .split_once(END)
            .ok_or_else(|| format!("{begin} has no {END}"))?;
        let filled = filled(list, &table.text).map_err(|e| format!("{}: {e}", table.name))?;
        text = format!("{before}{begin}\n{}\n{END}{after}", filled.trim_end());
    }
    Ok(text)
}

/// `text` with numbers in place of the figures that it names.
fn filled(list: &List, text: &str) -> Result<String, String> {
    let mut pieces = text.split('{');
    let mut filled = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        let (named, rest) = piece.split_once('}').ok_or("a { has no }")?;
        let (id, format) = named.split_once(':').unwrap_or((named, "n"));
        let figure = list
            .figure(id)
            .ok_or_else(|| format!("no figure is called {id}"))?;
        let number = shown(figure.value, format);
        filled += &number.ok_or_else(|| format!("{format} is no format of a figure"))?;
        filled += rest;
    }
    Ok(filled)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIST: &str = "
[[run]]
name = \"cube\"
command = \"foveal select --json\"
minutes = 0.1
[run.figures]
pixels = { key = \"pixels\", value = 1037435, tolerance = \"exact\" }
[[table]]
name = \"one\"
file = \"a.md\"
text = \"| {cube.pixels} | {cube.pixels:.1} |\"
";

    #[test]
    fn a_table_is_written_between_its_marks_and_nothing_else_changes() {
        let list = List::parse(LIST.to_owned()).unwrap();
        let old = "before\n<!-- measured one -->\nstale\n<!-- end -->\nafter\n";
        let new = "before\n<!-- measured one -->\n| 1,037,435 | 1037435.0 |\n<!-- end -->\nafter\n";
        assert_eq!(written(&list, "a.md", old).as_deref(), Ok(new));
        assert_eq!(written(&list, "b.md", old).as_deref(), Ok(old));
        assert!(written(&list, "a.md", "no marks").is_err());
    }

    #[test]
    fn a_figure_that_is_not_in_the_list_is_named() {
        let list = List::parse(LIST.replace("{cube.pixels}", "{cube.gone}")).unwrap();
        let text = "<!-- measured one -->\n<!-- end -->";
        assert!(written(&list, "a.md", text).is_err_and(|message| message.contains("cube.gone")));
    }
}
