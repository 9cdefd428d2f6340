//! Does a file carry what belongs to one machine, or is it too big for a repository?

use super::Finding;
use super::tree::LARGEST_FILE;

/// The top folders in which homes, checkouts and build farms live.
const FOLDERS: [&str; 5] = ["home", "Users", "root", "work", "farm"];

/// A file of more than 1 MiB.
pub(super) fn check_size(path: &str, bytes: u64) -> Option<Finding> {
    (bytes > LARGEST_FILE).then(|| {
        let message = format!("{bytes} bytes, at most 1 MiB: generate or fetch it instead");
        Finding::new(path, 1, message)
    })
}

/// Lines that name a path of one machine.
pub(super) fn check_paths(path: &str, text: &str) -> Vec<Finding> {
    if path.ends_with(".lock") || path.ends_with("package-lock.json") {
        return Vec::new();
    }
    let lines = (1..).zip(text.lines());
    lines
        .filter_map(|(number, line)| {
            let folder = FOLDERS
                .into_iter()
                .find(|folder| names_path_under(line, folder))?;
            let message = format!("a path under /{folder}: name it from the repository's root");
            Some(Finding::new(path, number, message))
        })
        .collect()
}

fn names_path_under(line: &str, folder: &str) -> bool {
    let start = format!("/{folder}/");
    line.match_indices(&start).any(|(at, _)| {
        let before = line[..at].chars().next_back();
        let after = line[at + start.len()..].chars().next();
        !before.is_some_and(|c| c.is_ascii_alphanumeric() || "_.".contains(c))
            && after.is_some_and(|c| c.is_ascii_alphanumeric() || "._-".contains(c))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_machine_path_is_found_on_its_line() {
        for folder in FOLDERS {
            let text = format!("fine\nsee /{folder}/person\n");
            let findings = check_paths("docs/a.md", &text);
            assert_eq!(findings.len(), 1, "{folder}");
            assert_eq!(findings[0].line, 2);
            assert!(check_paths("Cargo.lock", &text).is_empty());
        }
    }

    #[test]
    fn addresses_and_relative_paths_are_fine() {
        let text = "https://example.org/home/page src/work/x ./root/x /work/ /workshop/x";
        assert!(check_paths("a.md", text).is_empty());
    }

    #[test]
    fn a_mebibyte_fits_and_a_byte_more_does_not() {
        assert_eq!(check_size("a.png", 1 << 20), None);
        assert!(check_size("a.png", (1 << 20) + 1).is_some());
    }
}
