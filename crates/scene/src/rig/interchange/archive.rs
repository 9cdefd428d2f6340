//! Which files does a zip hold, and none larger than it may be?

use std::io::{Cursor, Read};

use zip::ZipArchive;

/// Most entries of an archive.
const MOST_ENTRIES: usize = 10_000;
/// What an entry of its directory begins with.
const ENTRY: &[u8] = b"PK\x01\x02";

/// Files by name; nothing is ever written where a name says.
pub(super) struct Archive<'a> {
    zip: ZipArchive<Cursor<&'a [u8]>>,
    names: Vec<String>,
}

impl<'a> Archive<'a> {
    /// Whether bytes begin as a zip does.
    pub(super) fn is_one(bytes: &[u8]) -> bool {
        bytes.starts_with(b"PK")
    }

    pub(super) fn open(bytes: &'a [u8]) -> Result<Self, String> {
        // Before anything is kept of them.
        let entries = bytes.windows(ENTRY.len()).filter(|it| *it == ENTRY);
        if entries.take(MOST_ENTRIES + 1).count() > MOST_ENTRIES {
            return Err(format!("holds more than {MOST_ENTRIES} files"));
        }
        let zip = ZipArchive::new(Cursor::new(bytes));
        let zip = zip.map_err(|error| format!("is not a whole zip: {error}"))?;
        // Names that are not text are skipped: nothing asks for them.
        let names = zip
            .file_names()
            .map(|it| it.unwrap_or_default().into_owned());
        let names = names.collect();
        Ok(Self { zip, names })
    }

    /// The names that end in `.xml`, outermost first; of those alike the one that MPCDI wants.
    pub(super) fn xml_names(&self) -> Vec<String> {
        let is_hidden = |name: &str| {
            let mut parts = name.split(['/', '\\']);
            parts.any(|part| part.starts_with("._") || part == "__MACOSX")
        };
        let ours = self.names.iter().map(String::as_str);
        let ours = ours.filter(|it| it.to_ascii_lowercase().ends_with(".xml") && !is_hidden(it));
        let mut names: Vec<&str> = ours.collect();
        let is_other = |name: &str| !name.to_ascii_lowercase().ends_with("mpcdi.xml");
        names.sort_by_key(|name| {
            (
                name.matches(['/', '\\']).count(),
                is_other(name),
                name.len(),
            )
        });
        names.into_iter().map(str::to_owned).collect()
    }

    /// The bytes of an entry that a file in a folder of the archive names, at most so many, and
    /// whether it lies in another place than it says: what its header says of its size is not
    /// believed.
    pub(super) fn read(
        &mut self,
        folder: &str,
        name: &str,
        most: u64,
    ) -> Result<(Vec<u8>, bool), String> {
        let (index, is_elsewhere) = self.find(folder, name)?;
        let entry = self.zip.by_index(index);
        let entry = entry.map_err(|error| format!("cannot be read: {error}"))?;
        let mut bytes = Vec::new();
        let read = entry.take(most + 1).read_to_end(&mut bytes);
        read.map_err(|error| format!("cannot be unpacked: {error}"))?;
        match bytes.len() as u64 > most {
            true => Err(format!("unpacks to more than the {most} bytes it can need")),
            false => Ok((bytes, is_elsewhere)),
        }
    }

    /// The entry of a name: counted from the folder, else from the outermost one, else the only one
    /// that is called so anywhere.
    fn find(&self, folder: &str, name: &str) -> Result<(usize, bool), String> {
        let from_folder = format!("{folder}/{name}");
        let wanted = plain(&from_folder).ok_or("leads out of the archive")?;
        let of = |wanted: &str| {
            let mut names = self.names.iter();
            names.position(|it| plain(it).is_some_and(|it| it == wanted))
        };
        if let Some(index) = of(&wanted).or_else(|| of(&plain(name)?)) {
            return Ok((index, false));
        }
        let last = |path: &str| path.rsplit('/').next().unwrap_or_default().to_owned();
        let called = |it: &String| plain(it).is_some_and(|it| last(&it) == last(&wanted));
        let mut alike = (0..self.names.len()).filter(|index| called(&self.names[*index]));
        match (alike.next(), alike.next()) {
            (Some(index), None) => Ok((index, true)),
            _ => Err("is not in the archive".to_owned()),
        }
    }
}

/// A name by which all that are meant to be the same are: whatever the case of letters and the kind
/// of separators. `None` where it leads out.
fn plain(name: &str) -> Option<String> {
    let mut parts: Vec<&str> = Vec::new();
    for part in name.split(['/', '\\']) {
        match part {
            "" | "." => {}
            ".." => {
                parts.pop()?;
            }
            part => parts.push(part),
        }
    }
    Some(parts.join("/").to_lowercase())
}
