//! Which commands do the documents and the help show?

use std::fs;
use std::path::{Path, PathBuf};

/// A command of the program that a text shows.
pub(crate) struct Shown {
    /// The file, and its line.
    pub(crate) place: String,
    /// The words after `foveal`.
    pub(crate) words: Vec<String>,
    /// It stands in a block of its own, so it is whole; in a sentence, arguments may be missing.
    pub(crate) is_whole: bool,
}

/// Commands of README and of everything in `docs` and `examples` but decisions, which record what
/// was run on their day.
pub(crate) fn of_documents() -> Vec<Shown> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut files = vec![root.join("README.md")];
    for folder in ["docs", "docs/concepts", "docs/formats", "examples/bridges"] {
        let entries = fs::read_dir(root.join(folder)).unwrap();
        let paths = entries.map(|entry| entry.unwrap().path());
        files.extend(paths.filter(|path| path.extension().is_some_and(|e| e == "md")));
    }
    files.sort();
    files.iter().flat_map(|file| of_file(&root, file)).collect()
}

fn of_file(root: &Path, file: &PathBuf) -> Vec<Shown> {
    let text = fs::read_to_string(file).unwrap();
    let name = file.strip_prefix(root).unwrap().display().to_string();
    let mut fenced = false;
    let mut found = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        if line.starts_with("```") {
            fenced = !fenced;
            continue;
        }
        let place = format!("{name}:{number}");
        if fenced || line.starts_with("    ") {
            found.extend(of_line(&place, line, true));
        } else {
            let code = line.split('`').skip(1).step_by(2);
            found.extend(code.flat_map(|code| of_line(&place, code, false)));
        }
    }
    found
}

/// Commands of a line of a shell, without comments, what describes them and other programs.
pub(crate) fn of_line(place: &str, line: &str, is_whole: bool) -> Vec<Shown> {
    let line = line.trim().split(" #").next().unwrap_or_default();
    let parts = line.split("&&").flat_map(|part| part.split(" | "));
    let commands = parts.filter_map(|part| part.trim().strip_prefix("foveal "));
    let shown = |command: &str| Shown {
        place: place.to_owned(),
        words: words(command.split("   ").next().unwrap_or_default()),
        is_whole,
    };
    commands
        .map(shown)
        .filter(|s| !s.words.is_empty())
        .collect()
}

/// The words of a command; what stands in quotes is one. What may be left out stands in brackets
/// and is kept; `..` says that more may follow; of `a|b` the first is taken.
fn words(command: &str) -> Vec<String> {
    let plain = command
        .replace(['[', ']'], " ")
        .replace("$(seq -s, 0 20 500)", "0,20");
    let first = |word: &str| word.split('|').next().unwrap_or_default().to_owned();
    let mut words = Vec::new();
    for (number, part) in plain.split('"').enumerate() {
        match number % 2 {
            0 => words.extend(part.split_whitespace().map(first)),
            _ => words.push(part.to_owned()),
        }
    }
    words.retain(|word| !["&", ".."].contains(&word.as_str()));
    words
}
