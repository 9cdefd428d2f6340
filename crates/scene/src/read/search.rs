//! Which file does a name mean that was written on another machine?
//!
//! Names in 3D files are paths on their author's machine: `C:\work\wood.png`,
//! `../textures/wood.png`, `"Wood.PNG"`. The file of that name in the folder of the 3D file is
//! used instead, as viewers do.

use std::collections::HashMap;
use std::path::{Component, Path, PathBuf};
use std::rc::Rc;

use super::error::Fault;
use super::text::shortened;
use unicode_normalization::UnicodeNormalization;

/// Most folders in a name; what stands before them is of no help.
const MOST_PARTS: usize = 16;
/// Folders next to a model in which pictures are put.
const USUAL: [&str; 6] = ["textures", "texture", "tex", "maps", "images", "materials"];
/// Most other names that are reported one by one.
const MOST_TOLD: u64 = 16;

/// Where the files lie that a scene file names.
pub(super) trait Folder {
    /// The bytes of the file at a relative path, the same for all paths of one file.
    fn open(&mut self, relative: &Path) -> Result<Rc<Vec<u8>>, NotOpened>;

    /// The bytes of a file that lies elsewhere, where that may be opened.
    fn open_outside(&mut self, _name: &Path) -> Option<Rc<Vec<u8>>> {
        None
    }

    /// The names in a folder of it, by [`key`].
    fn names(&mut self, relative: &Path) -> Rc<Names>;

    /// Hears of a file that is used in place of one of another name.
    fn tell(&mut self, taken: Taken);
}

/// The bytes of the file that one of these names means, the first that there is.
pub(super) fn read(folder: &mut dyn Folder, names: &[&str]) -> Result<Rc<Vec<u8>>, Fault> {
    let mut search = Search::default();
    for name in names {
        if let Some(bytes) = search.exactly(folder, name) {
            return Ok(bytes);
        }
    }
    for name in names {
        if let Some(bytes) = search.nearly(folder, name) {
            return Ok(bytes);
        }
    }
    Err(search.missing(names.last().copied().unwrap_or("")))
}

/// The names in a folder by what makes them alike, each with the first in order that is.
pub(super) type Names = HashMap<String, String>;

/// A file that is used in place of one of another name.
pub(super) struct Taken {
    /// Whether they differ in capitals alone, or in how letters are composed.
    pub(super) by_case: bool,
    pub(super) remark: String,
}

impl Taken {
    /// Under which name it is counted.
    pub(super) fn repair(&self) -> &'static str {
        match self.by_case {
            true => "files_found_by_case",
            false => "files_found_elsewhere",
        }
    }

    /// Whether one more is reported, after so many.
    pub(super) fn is_told(after: u64) -> bool {
        after < MOST_TOLD
    }
}

/// Why a file is not there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum NotOpened {
    /// It lies elsewhere.
    Outside,
    /// What the system said.
    Because(String),
}

/// What is alike in names that differ in capitals, or in how letters are composed.
pub(super) fn key(name: &str) -> String {
    name.nfc().flat_map(char::to_lowercase).collect()
}

#[derive(Default)]
struct Search {
    is_outside: bool,
    reason: Option<String>,
}

impl Search {
    /// The file of just this name.
    fn exactly(&mut self, folder: &mut dyn Folder, name: &str) -> Option<Rc<Vec<u8>>> {
        let bare = unquoted(name);
        let Some(path) = inside(bare) else {
            self.is_outside = true;
            return folder.open_outside(Path::new(bare));
        };
        self.open(folder, &path)
    }

    fn open(&mut self, folder: &mut dyn Folder, path: &Path) -> Option<Rc<Vec<u8>>> {
        match folder.open(path) {
            Ok(bytes) => Some(bytes),
            Err(NotOpened::Outside) => {
                self.is_outside = true;
                folder.open_outside(path)
            }
            Err(NotOpened::Because(reason)) => {
                self.reason.get_or_insert(reason);
                None
            }
        }
    }

    /// A file whose name is like the end of this one.
    fn nearly(&mut self, folder: &mut dyn Folder, name: &str) -> Option<Rc<Vec<u8>>> {
        let bare = unquoted(name);
        // A file may be asked for as of a server; some have such a name all the same.
        let file = bare.split(['?', '#']).next().unwrap_or(bare);
        self.nearly_bare(folder, bare)
            .or_else(|| match file == bare {
                true => None,
                false => self.nearly_bare(folder, file),
            })
    }

    fn nearly_bare(&mut self, folder: &mut dyn Folder, bare: &str) -> Option<Rc<Vec<u8>>> {
        let parts = parts(bare);
        let whole = inside(bare);
        let last = parts.last()?;
        let ends = (0..parts.len()).map(|first| parts[first..].to_vec());
        let usual = USUAL.iter().map(|it| vec![*it, *last]);
        for wanted in ends.chain(usual) {
            let Some(path) = like(folder, &wanted) else {
                continue;
            };
            let Some(bytes) = self.open(folder, &path) else {
                continue;
            };
            let by_case = whole.as_ref().is_some_and(|whole| is_like(whole, &path));
            let [name, taken] = [bare, &*path.to_string_lossy()].map(shortened);
            let remark = match by_case {
                true => format!("there is no \"{name}\", but \"{taken}\", which is used instead"),
                false => format!(
                    "there is no \"{name}\" in the folder of the model: \"{taken}\" is used \
                     instead"
                ),
            };
            folder.tell(Taken { by_case, remark });
            return Some(bytes);
        }
        None
    }

    fn missing(self, name: &str) -> Fault {
        let reason = match (self.is_outside, self.reason) {
            (true, _) => "it does not lie in the folder of the model, nor does one of that name \
                          (--allow-outside opens others)"
                .to_owned(),
            (false, Some(reason)) => reason,
            (false, None) => "it has no name".to_owned(),
        };
        Fault::Missing {
            name: shortened(name),
            reason,
        }
    }
}

/// A name without quotes and blanks round it.
fn unquoted(name: &str) -> &str {
    let name = name.trim();
    let quotes = ['"', '\''];
    let inner = name.strip_prefix(quotes).unwrap_or(name);
    inner.strip_suffix(quotes).unwrap_or(inner).trim()
}

/// The parts of a name with either kind of slash, from where it leads down only.
fn parts(name: &str) -> Vec<&str> {
    let mut parts: Vec<&str> = Vec::new();
    for part in name.split(['/', '\\']) {
        match part {
            "" | "." => {}
            ".." => parts.clear(),
            drive if drive.ends_with(':') || drive.contains('\0') => parts.clear(),
            part => parts.push(part),
        }
    }
    parts.split_off(parts.len().saturating_sub(MOST_PARTS))
}

/// A path of parts that are like these.
fn like(folder: &mut dyn Folder, wanted: &[&str]) -> Option<PathBuf> {
    let mut path = PathBuf::new();
    for part in wanted {
        let names = folder.names(&path);
        path.push(names.get(*part).or_else(|| names.get(&key(part)))?);
    }
    Some(path)
}

fn is_like(a: &Path, b: &Path) -> bool {
    key(&a.to_string_lossy()) == key(&b.to_string_lossy())
}

/// The relative path that `name` is, with either kind of slash; none if it leads out.
pub(super) fn inside(name: &str) -> Option<PathBuf> {
    let name_with_slashes = name.replace('\\', "/");
    let mut path = PathBuf::new();
    // A colon: `C:`, or a scheme such as `http:`.
    let foreign = name.contains(':') || name.contains('\0');
    for part in Path::new(&name_with_slashes).components() {
        match part {
            Component::Normal(part) => path.push(part),
            Component::CurDir => {}
            Component::ParentDir if path.pop() => {}
            Component::ParentDir | Component::RootDir | Component::Prefix(_) => return None,
        }
    }
    (!foreign && !path.as_os_str().is_empty()).then_some(path)
}

#[cfg(test)]
mod tests {
    use super::super::files::Files;
    use super::*;
    use std::collections::BTreeMap;

    #[test]
    fn names_that_lead_out_are_no_paths() {
        for name in [
            "../a.bin",
            "a/../../b.bin",
            "/etc/passwd",
            "C:\\a.bin",
            "..\\a.bin",
            "http://example.com/a.bin",
            "",
            ".",
            "a\0",
        ] {
            assert!(inside(name).is_none(), "{name:?}");
        }
    }

    #[test]
    fn names_that_stay_inside_are_found() {
        for (name, path) in [
            ("a.bin", "a.bin"),
            ("./b/a.bin", "b/a.bin"),
            ("b\\a.bin", "b/a.bin"),
            ("b/../a.bin", "a.bin"),
        ] {
            assert_eq!(inside(name), Some(PathBuf::from(path)), "{name:?}");
        }
    }

    /// Which of some files a name means.
    fn found(name: &str) -> Option<String> {
        let names = [
            "wood.png",
            "Stone.PNG",
            "sub/wood.png",
            "Maps/sky.png",
            "textures/leaf.png",
            "fu\u{308}r.png",
        ];
        let files = names.map(|it| (it, it.as_bytes().to_vec()));
        let bytes = read(&mut Files(BTreeMap::from(files)), &[name]).ok()?;
        Some(String::from_utf8(bytes.to_vec()).unwrap())
    }

    #[test]
    fn the_file_of_that_name_beside_the_model_is_taken() {
        for (name, file) in [
            ("wood.png", "wood.png"),
            ("\"wood.png\"", "wood.png"),
            ("C:\\Users\\me\\wood.png", "wood.png"),
            ("C:\\Users\\me\\sub\\wood.png", "sub/wood.png"),
            ("../textures/wood.png", "wood.png"),
            ("/Volumes/me/SUB/wood.png", "sub/wood.png"),
            ("file:///C:/me/wood.png", "wood.png"),
            ("https://example.com/a/wood.png?size=2", "wood.png"),
            ("WOOD.png", "wood.png"),
            ("stone.png", "Stone.PNG"),
            ("D:/x/maps/sky.png", "Maps/sky.png"),
            ("sky.png", "Maps/sky.png"),
            ("/x/leaf.png", "textures/leaf.png"),
            ("f\u{fc}r.png", "fu\u{308}r.png"),
        ] {
            assert_eq!(found(name).as_deref(), Some(file), "{name:?}");
        }
        for name in [
            "wool.png",
            "",
            "..",
            "/",
            "C:",
            "wood.png/x",
            "a:\0wood.png",
        ] {
            assert_eq!(found(name), None, "{name:?}");
        }
    }
}
