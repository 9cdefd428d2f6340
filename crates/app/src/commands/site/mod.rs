//! Which files make a site that shows these packs?
//!
//! The pages and the wasm that the program carries, the packs, a poster of each and `packs.json`,
//! which the list page reads. All names are relative, so that a site works in a folder of any host.

mod about;
pub(crate) mod export;
mod listing;
mod pack_names;
mod poster;
mod site_pack;

pub(crate) use about::About;

use crate::web_files::web_files;
use anyhow::{Context, bail};
use foveal_media::pack::pack::Pack;
use foveal_media::pack::pack_file::PackFileError;
use listing::{Listed, Listing};
use pack_names::names_of;
use site_pack::shown;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// The list that the pages read.
pub(crate) const LISTING: &str = "packs.json";
/// The page that shows it.
const LIST_PAGE: &str = "index.html";

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

/// Opens packs, in their order.
pub(crate) fn open_packs(paths: &[PathBuf]) -> Result<Vec<Pack>, PackFileError> {
    paths.iter().map(|path| Pack::open(path)).collect()
}

/// A site, by the names under which its files are fetched.
pub(crate) struct Site {
    pub(crate) files: BTreeMap<String, SiteFile>,
    pub(crate) packs: Vec<Listed>,
}

impl Site {
    /// The site of these packs, with what the user says of them; draws a poster of each.
    pub(crate) fn of(packs: &[Pack], about: &About) -> anyhow::Result<Self> {
        let names = names_of(packs.iter().map(Pack::path))?;
        about.check(&names)?;
        if web_files().is_empty() {
            bail!("this program was built without its pages; build it with `make build`");
        }
        let drawing = poster::drawing();
        let mut files = BTreeMap::new();
        let mut listed = Vec::new();
        for (name, file) in names.into_iter().zip(packs) {
            let path = file.path().to_owned();
            let (shows, poster) = shown(file, &drawing)?;
            let one = Listed::new(&name, file, (shows, &poster), about.of(&name));
            files.insert(one.poster.file.clone(), SiteFile::Bytes(poster.jpeg.into()));
            files.insert(one.file.clone(), SiteFile::File(path));
            listed.push(one);
        }
        let kinds: Vec<_> = listed.iter().map(|it| it.shows.content).collect();
        for file in web_files() {
            let bytes = match file.name {
                LIST_PAGE => about.titled(file.bytes, &kinds).into(),
                _ => file.bytes.into(),
            };
            files.insert(file.name.to_owned(), SiteFile::Bytes(bytes));
        }
        listed.sort_by_key(|pack| about.place(&pack.name));
        let listing = serde_json::to_vec(&Listing::new(&listed))?;
        files.insert(LISTING.to_owned(), SiteFile::Bytes(listing.into()));
        Ok(Self {
            files,
            packs: listed,
        })
    }
}
