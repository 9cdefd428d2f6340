//! Which file lies at the path of a request?
//!
//! Nothing outside the folder is reachable: a path is split into names, none of which may be
//! special, and what the names lead to is opened beneath the folder, through whatever links stay in
//! it. Packs that were named are sent or nothing: what takes the place of one must be a pack, and
//! no link.

use crate::commands::serve::tags::{ContentTags, modified, tag_of};
use crate::commands::site::{Site, SiteFile};
use foveal_media::plain_file::open_unlinked;
use foveal_scene::beneath::Beneath;
use percent_encoding::percent_decode_str;
use std::borrow::Cow;
use std::fs::{File, Metadata};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// What is served, and the tags of its packs.
pub(super) struct ServedPlace {
    pub(super) holds: Holds,
    pub(super) tags: ContentTags,
}

/// What a server finds files in.
pub(super) enum Holds {
    /// A folder.
    Folder(PathBuf),
    /// A site made on the fly, and when it was made.
    Site(Box<Site>, SystemTime),
}

/// What lies at a path.
pub(super) enum Found {
    /// This.
    File(FoundFile),
    /// A folder whose page is at the same path with a `/` behind it.
    Folder,
    /// Nothing.
    Nothing,
}

/// A file that can be sent.
pub(super) struct FoundFile {
    pub(super) name: String,
    pub(super) content: FoundContent,
    pub(super) length: u64,
    pub(super) modified: SystemTime,
    /// Changes with the content.
    pub(super) tag: String,
    /// Whether it is made of the content, as that of a pack.
    pub(super) is_by_content: bool,
}

pub(super) enum FoundContent {
    Bytes(Cow<'static, [u8]>),
    File(File),
}

/// The page of a folder.
const PAGE: &str = "index.html";
/// Most of a page for addresses where nothing lies, in bytes: it is changed before it is sent.
const MOST_OF_PAGE: u64 = 1 << 20;
/// The page of a site for addresses where nothing lies.
const NOTHING: &str = "404.html";

impl ServedPlace {
    /// What lies at the path of a URL, as it was sent. Opens files: blocks, but never waits.
    pub(super) fn find(&self, path: &str) -> Found {
        let Some(mut names) = names_of(path) else {
            return Found::Nothing;
        };
        if names.last().is_none_or(String::is_empty) {
            names.pop();
            names.push(PAGE.to_owned());
        }
        match &self.holds {
            Holds::Folder(folder) => self.in_folder(folder, &names),
            Holds::Site(site, made) => match site.files.get(&names.join("/")) {
                Some(SiteFile::Bytes(bytes)) => Found::File(FoundFile {
                    name: names.join("/"),
                    length: bytes.len() as u64,
                    modified: *made,
                    tag: tag_of(bytes.len() as u64, *made),
                    is_by_content: false,
                    content: FoundContent::Bytes(bytes.clone()),
                }),
                Some(SiteFile::File(path)) => self.pack(path, &names.join("/")),
                None => Found::Nothing,
            },
        }
    }

    /// The page for addresses where nothing lies, whatever their depth; `None` in a folder that
    /// has none.
    pub(super) fn page_of_nothing(&self) -> Option<String> {
        let Found::File(page) = self.find(&format!("/{NOTHING}")) else {
            return None;
        };
        let text = match page.content {
            FoundContent::Bytes(bytes) => String::from_utf8(bytes.into_owned()).ok()?,
            FoundContent::File(file) => {
                let bounded = file.take(MOST_OF_PAGE);
                std::io::read_to_string(bounded).ok()?
            }
        };
        // What it loads and leads to lies at the beginning of the site.
        Some(text.replace("=\"./", "=\"/"))
    }
}

/// The names between the slashes, decoded; the last is empty where the path ends in one. `None`
/// for what could mean anything but a name in a folder.
fn names_of(path: &str) -> Option<Vec<String>> {
    let names = path.strip_prefix('/')?.split('/');
    let decoded = names.map(|name| {
        let name = percent_decode_str(name).decode_utf8().ok()?.into_owned();
        let special = name.starts_with('.')
            || name.contains(['/', '\\', ':'])
            || name.chars().any(char::is_control);
        (!special).then_some(name)
    });
    let names: Vec<String> = decoded.collect::<Option<_>>()?;
    let inner = &names[..names.len() - 1];
    (!inner.iter().any(String::is_empty)).then_some(names)
}

impl ServedPlace {
    fn in_folder(&self, folder: &Path, names: &[String]) -> Found {
        let Ok(beneath) = Beneath::of(folder) else {
            return Found::Nothing;
        };
        let asked: PathBuf = names.iter().collect();
        let opened = |path: &Path| {
            let file = beneath.open(path).ok()?;
            let there = file.metadata().ok()?;
            Some((file, there))
        };
        match opened(&asked) {
            Some((file, there)) if there.is_file() => self.found(&names.join("/"), (file, there)),
            Some((_, there)) if there.is_dir() => match opened(&asked.join(PAGE)) {
                Some((_, page)) if page.is_file() => Found::Folder,
                _ => Found::Nothing,
            },
            _ => Found::Nothing,
        }
    }

    /// A pack that was named, or nothing.
    fn pack(&self, path: &Path, name: &str) -> Found {
        match open_unlinked(path) {
            Ok(opened) => match self.found(name, opened) {
                Found::File(file) if file.is_by_content => Found::File(file),
                _ => Found::Nothing,
            },
            Err(_) => Found::Nothing,
        }
    }

    fn found(&self, name: &str, (mut file, there): (File, Metadata)) -> Found {
        let of_content = self.tags.of(&mut file, &there);
        Found::File(FoundFile {
            name: name.to_owned(),
            length: there.len(),
            modified: modified(&there),
            is_by_content: of_content.is_some(),
            tag: of_content.unwrap_or_else(|| tag_of(there.len(), modified(&there))),
            content: FoundContent::File(file),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_decoded_between_slashes() {
        assert_eq!(names_of("/"), Some(vec![String::new()]));
        assert_eq!(
            names_of("/a%20b/c.js"),
            Some(vec!["a b".into(), "c.js".into()])
        );
        assert_eq!(names_of("/a/"), Some(vec!["a".into(), String::new()]));
    }

    #[test]
    fn what_could_lead_out_of_the_folder_is_no_name() {
        let paths = [
            "",
            "a",
            "/..",
            "/../a",
            "/a/../b",
            "/%2e%2e/a",
            "/a%2fb",
            "/a%5cb",
            "/..%5ca",
            "//a",
            "/a//b",
            "/.git/config",
            "/a%00",
            "/%ff",
            "/c:/a",
            "/a\n",
        ];
        for path in paths {
            assert_eq!(names_of(path), None, "{path:?}");
        }
    }
}
