//! What does a Rust file declare, import and name, its tests left out?

/// One module of a file: the file itself, or one that stands in it with its braces.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scope {
    /// The modules with braces that lead here from the file itself.
    pub(crate) inside: Vec<String>,
    /// Modules that have files of their own.
    pub(crate) children: Vec<String>,
    pub(crate) items: Vec<Item>,
    pub(crate) imports: Vec<Import>,
    /// Paths of two names or more, imports left out.
    pub(crate) paths: Vec<Vec<String>>,
    /// Every identifier, those of imports too.
    pub(crate) names: Vec<Name>,
    /// Does it hold more than modules and imports?
    pub(crate) defines: bool,
}

/// What others can name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Item {
    pub(crate) name: String,
    pub(crate) line: usize,
    /// A struct, enum, union, trait or alias.
    pub(crate) is_type: bool,
    pub(crate) seen: Seen,
}

/// From where an item can be named.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Seen {
    Here,
    Crate,
    Everywhere,
}

/// One name, or all of a module, that a `use` brings.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Import {
    pub(crate) path: Vec<String>,
    /// What it is called here; nothing for `*`.
    pub(crate) name: Option<String>,
    /// Is it imported for others to import from here?
    pub(crate) hands_on: bool,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Name {
    pub(crate) text: String,
    pub(crate) line: usize,
    pub(crate) is_import: bool,
}

impl Scope {
    /// Is `name` written anywhere but in imports?
    pub(crate) fn uses(&self, name: &str) -> bool {
        let mut names = self.names.iter();
        names.any(|known| !known.is_import && known.text == name)
    }
}

/// The crate's folder under `crates/` to whose sources `path` belongs.
pub(crate) fn crate_of(path: &str) -> Option<&str> {
    let (name, rest) = path.strip_prefix("crates/")?.split_once('/')?;
    (rest.starts_with("src/") && path.ends_with(".rs")).then_some(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sources_belong_to_their_crate_and_other_files_to_none() {
        assert_eq!(crate_of("crates/core/src/view/axes.rs"), Some("core"));
        assert_eq!(crate_of("crates/core/tests/axes.rs"), None);
        assert_eq!(crate_of("crates/core/src/view/axes.json"), None);
        assert_eq!(crate_of("xtask/src/main.rs"), None);
    }
}
