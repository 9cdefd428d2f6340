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
        let zip = zip.map_err(|error| format!("is no whole zip: {error}"))?;
        // Names that are not text are skipped: nothing asks for them.
        let names = zip
            .file_names()
            .map(|it| it.unwrap_or_default().into_owned());
        let names = names.collect();
        Ok(Self { zip, names })
    }

    /// The outermost name that ends in `.xml`.
    pub(super) fn xml_name(&self) -> Option<String> {
        let ours = self.names.iter();
        let ours = ours.filter(|it| it.to_ascii_lowercase().ends_with(".xml"));
        let depth = |name: &str| name.matches(['/', '\\']).count();
        ours.min_by_key(|name| (depth(name), name.len())).cloned()
    }

    /// The bytes of an entry, at most so many: what its header says of its size is not believed.
    pub(super) fn read(&mut self, name: &str, most: u64) -> Result<Vec<u8>, String> {
        if name.split(['/', '\\']).any(|part| part == "..") {
            return Err("leads out of the archive".to_owned());
        }
        let index = self.names.iter().position(|it| is_same(it, name));
        let entry = self.zip.by_index(index.ok_or("is not in the archive")?);
        let entry = entry.map_err(|error| format!("cannot be read: {error}"))?;
        let mut bytes = Vec::new();
        let read = entry.take(most + 1).read_to_end(&mut bytes);
        read.map_err(|error| format!("cannot be unpacked: {error}"))?;
        match bytes.len() as u64 > most {
            true => Err(format!("unpacks to more than the {most} bytes it can need")),
            false => Ok(bytes),
        }
    }
}

/// Names are the same whatever the case of letters and the kind of separators.
fn is_same(known: &str, name: &str) -> bool {
    let plain = |it: &str| {
        it.replace('\\', "/")
            .trim_start_matches("./")
            .to_lowercase()
    };
    plain(known) == plain(name)
}
