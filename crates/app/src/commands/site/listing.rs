//! What does a list of packs say of each?

use crate::commands::site::about::AboutPack;
use crate::commands::site::pack_names::ENDING;
use crate::commands::site::poster::Poster;
use crate::commands::site::site_pack::Shows;
use foveal_media::pack::pack::Pack;
use serde::Serialize;

/// `packs.json`.
#[derive(Debug, Serialize)]
pub(super) struct Listing<'a> {
    /// Of this form.
    version: u32,
    generator: &'static str,
    packs: &'a [Listed],
}

/// Who wrote a list; an export replaces only sites that carry it.
pub(super) const GENERATOR: &str = concat!("foveal ", env!("CARGO_PKG_VERSION"));

impl<'a> Listing<'a> {
    pub(super) fn new(packs: &'a [Listed]) -> Self {
        Self {
            version: 1,
            generator: GENERATOR,
            packs,
        }
    }
}

/// A pack in a site; names are relative to the list.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Listed {
    pub(super) name: String,
    /// What people read of it.
    title: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    description: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    licence: Option<String>,
    pub(crate) file: String,
    pub(crate) poster: ListedPoster,
    bytes: u64,
    #[serde(flatten)]
    pub(super) shows: Shows,
}

/// The picture that stands for a pack in a list.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct ListedPoster {
    pub(super) file: String,
    width: u32,
    height: u32,
}

impl Listed {
    pub(super) fn new(
        name: &str,
        file: &Pack,
        (shows, poster): (Shows, &Poster),
        said: AboutPack,
    ) -> Self {
        Self {
            name: name.to_owned(),
            title: said.title.unwrap_or_else(|| name.to_owned()),
            description: said.description,
            licence: said.licence,
            file: format!("{name}{ENDING}"),
            poster: ListedPoster {
                file: format!("posters/{name}.jpg"),
                width: poster.size[0],
                height: poster.size[1],
            },
            bytes: file.bytes(),
            shows,
        }
    }
}
