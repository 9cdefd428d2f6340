//! What are packs called in a site?

use crate::report::output::WrongUsage;
use std::collections::BTreeMap;
use std::path::Path;

/// The ending of every pack.
pub(super) const ENDING: &str = ".foveal";

/// A pack's name without its ending.
pub(super) fn bare(name: &str) -> String {
    let name = name.trim();
    name.strip_suffix(ENDING).unwrap_or(name).to_owned()
}

/// The name of each pack in a site, without its ending; refuses two that are alike.
pub(super) fn names_of<'a>(
    packs: impl Iterator<Item = &'a Path>,
) -> Result<Vec<String>, WrongUsage> {
    let mut by_name: BTreeMap<String, &Path> = BTreeMap::new();
    let mut names = Vec::new();
    for pack in packs {
        let path = pack.display();
        let Some(name) = pack.file_name().unwrap_or_default().to_str() else {
            return Err(WrongUsage(format!(
                "{path}: its name is no UTF-8; rename it"
            )));
        };
        let name = name.strip_suffix(ENDING).unwrap_or(name).to_owned();
        if name.is_empty() || name.starts_with('.') {
            return Err(WrongUsage(format!("{path}: give a pack with a name")));
        }
        // Hosts and browsers take these for something else than a name.
        if name.contains(['\\', ':']) || name.chars().any(char::is_control) {
            return Err(WrongUsage(format!(
                "{path}: rename it: a site's names hold no colon, backslash or line break"
            )));
        }
        // Some hosts do not distinguish A from a.
        if let Some(other) = by_name.insert(name.to_lowercase(), pack) {
            return Err(WrongUsage(format!(
                "{} and {} would both be {name}{ENDING} in the site; rename one",
                other.display(),
                pack.display()
            )));
        }
        names.push(name);
    }
    Ok(names)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(packs: &[&str]) -> Result<Vec<String>, WrongUsage> {
        names_of(packs.iter().map(Path::new))
    }

    #[test]
    fn a_pack_is_named_for_its_file() {
        let names = named(&["a.foveal", "folder/b c.foveal", "d"]).unwrap();
        assert_eq!(names, ["a", "b c", "d"]);
    }

    #[test]
    fn names_that_no_host_would_find_are_refused() {
        for name in ["12:30.foveal", "e\\f.foveal", "g\nh.foveal", ".foveal"] {
            assert!(named(&[name]).is_err(), "{name}");
        }
    }

    #[test]
    fn two_packs_of_one_name_are_refused_with_both_paths() {
        for pair in [["x/a.foveal", "y/a.foveal"], ["a.foveal", "A"]] {
            let refused = named(&pair).unwrap_err().to_string();
            assert!(pair.iter().all(|path| refused.contains(path)), "{refused}");
        }
    }
}
