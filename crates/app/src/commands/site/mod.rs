//! Which files make a site that shows these packs?
//!
//! The pages and the wasm that the program carries, the packs, a poster of each and `packs.json`,
//! which the list page reads. All names are relative, so that a site works in a folder of any host.

mod about;
pub(crate) mod export;
mod listing;
mod poster;

pub(crate) use about::About;

use crate::report::output::WrongUsage;
use crate::web_files::web_files;
use anyhow::{Context, bail};
use foveal_media::pack::pack_file::PackFile;
use listing::{Listed, Listing};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The list that the pages read.
pub(crate) const LISTING: &str = "packs.json";
/// The page that shows it.
const LIST_PAGE: &str = "index.html";
/// The ending of every pack.
const ENDING: &str = ".foveal";

/// Where a file of a site comes from.
#[derive(Clone, Debug)]
pub(crate) enum SiteFile {
    /// These bytes.
    Bytes(Cow<'static, [u8]>),
    /// That file, as it is.
    File(PathBuf),
}

impl SiteFile {
    /// How long it is.
    pub(crate) fn bytes(&self) -> anyhow::Result<u64> {
        Ok(match self {
            Self::Bytes(bytes) => bytes.len() as u64,
            Self::File(path) => std::fs::metadata(path)
                .with_context(|| format!("{}: cannot be read", path.display()))?
                .len(),
        })
    }
}

/// A site, by the names under which its files are fetched.
pub(crate) struct Site {
    pub(crate) files: BTreeMap<String, SiteFile>,
    pub(crate) packs: Vec<Listed>,
}

impl Site {
    /// The site of these packs, with what the user says of them; draws a poster of each.
    pub(crate) fn of(packs: &[PathBuf], about: &About) -> anyhow::Result<Self> {
        let names = names(packs)?;
        about.check(&names)?;
        let opened = packs.iter().map(|pack| PackFile::open(pack));
        let opened = opened.collect::<Result<Vec<PackFile>, _>>()?;
        if web_files().is_empty() {
            bail!("this program was built without its pages; build it with `make build`");
        }
        let drawing = poster::drawing();
        let mut files = BTreeMap::new();
        for file in web_files() {
            let bytes = match file.name {
                LIST_PAGE => about.titled(file.bytes).into(),
                _ => file.bytes.into(),
            };
            files.insert(file.name.to_owned(), SiteFile::Bytes(bytes));
        }
        let mut listed = Vec::new();
        for (name, file) in names.into_iter().zip(opened) {
            let path = file.path().to_owned();
            let file = Arc::new(file);
            let poster = poster::poster(Arc::clone(&file), &drawing)
                .with_context(|| format!("{}: no poster can be drawn", path.display()))?;
            let one = Listed::new(&name, &file, &poster, about.of(&name))?;
            files.insert(one.poster.file.clone(), SiteFile::Bytes(poster.jpeg.into()));
            files.insert(one.file.clone(), SiteFile::File(path));
            listed.push(one);
        }
        about.sort(&mut listed);
        let listing = serde_json::to_vec(&Listing::new(&listed))?;
        files.insert(LISTING.to_owned(), SiteFile::Bytes(listing.into()));
        Ok(Self {
            files,
            packs: listed,
        })
    }
}

/// The name of each pack in a site, without its ending; refuses two that are alike.
fn names(packs: &[PathBuf]) -> Result<Vec<String>, WrongUsage> {
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
        // Some hosts do not tell A from a.
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
        names(&packs.iter().map(PathBuf::from).collect::<Vec<_>>())
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
