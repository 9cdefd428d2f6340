//! What does a user say of a site and its packs?

use crate::commands::site::pack_names::bare;
use crate::commands::site::site_pack::ListedKind;
use crate::report::html::escape;
use crate::report::output::{self, WrongUsage};
use anyhow::{Context, anyhow, bail};
use clap::Args;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Most characters of a title or a licence, and of a description.
const MOST: [usize; 2] = [200, 4000];
/// The heading of the list page, where it stands in the page.
const HEADING: &str = "Videos";

/// What the list of packs says.
#[derive(Clone, Debug, Default, Args)]
pub(crate) struct AboutOptions {
    /// The heading of the list (default: what is in it, as Videos).
    #[arg(long, value_name = "TEXT")]
    title: Option<String>,
    /// Which packs come first in the list, by their names without .foveal, as b,a; the others
    /// follow as they are given.
    #[arg(long, value_name = "NAME,..", value_delimiter = ',')]
    order: Vec<String>,
    /// More about packs, in TOML: under [NAME], the pack's name without .foveal, any of title,
    /// description and licence, each a text in quotes (default: the name as the title).
    #[arg(long, value_name = "FILE.toml")]
    about: Option<PathBuf>,
}

/// What a file says of one pack.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct AboutPack {
    pub(super) title: Option<String>,
    pub(super) description: Option<String>,
    pub(super) licence: Option<String>,
}

impl AboutPack {
    fn check(&self) -> Result<(), String> {
        let fields = [
            ("title", &self.title, MOST[0]),
            ("description", &self.description, MOST[1]),
            ("licence", &self.licence, MOST[0]),
        ];
        for (name, text, most) in fields {
            let Some(text) = text else { continue };
            // Only a description has paragraphs.
            let lines = text.replace('\n', if name == "description" { "" } else { "\n" });
            check_text(name, &lines, most)?;
        }
        Ok(())
    }
}

fn check_text(name: &str, text: &str, most: usize) -> Result<(), String> {
    let found = match text.chars().count() {
        _ if text.trim().is_empty() => "empty".to_owned(),
        count if count > most => format!("{count} characters long"),
        _ if text.chars().any(char::is_control) => "broken by a line's end or a tab".to_owned(),
        _ => return Ok(()),
    };
    let range = format!("a text of 1 to {most} characters");
    Err(output::out_of_range(name, found, &range).to_string())
}

/// The options, read.
#[derive(Clone, Debug, Default)]
pub(crate) struct About {
    title: Option<String>,
    order: Vec<String>,
    packs: BTreeMap<String, AboutPack>,
    /// Where that of the packs was read.
    file: PathBuf,
}

impl About {
    /// Reads what the options name; refuses what cannot be shown.
    pub(super) fn read(options: &AboutOptions) -> anyhow::Result<Self> {
        if let Some(title) = &options.title {
            check_text("--title", title, MOST[0]).map_err(WrongUsage)?;
        }
        let mut about = Self {
            title: options.title.clone(),
            order: options.order.iter().map(|name| bare(name)).collect(),
            ..Self::default()
        };
        if let Some(path) = &options.about {
            let of_file = || format!("--about {}", path.display());
            let text = output::read_settings(path, "a TOML file about packs")?;
            let said: BTreeMap<String, AboutPack> = toml::from_str(&text).with_context(of_file)?;
            for (name, pack) in said {
                let wrong = |what| anyhow!("{}: [{name}]: {what}", of_file());
                pack.check().map_err(wrong)?;
                about.packs.insert(bare(&name), pack);
            }
            about.file.clone_from(path);
        }
        Ok(about)
    }

    /// Refuses names that none of the packs has.
    pub(super) fn check(&self, names: &[String]) -> anyhow::Result<()> {
        let is_there = |name: &&String| names.contains(name);
        let packs = names.join(", ");
        if let Some(name) = self.order.iter().find(|name| !is_there(name)) {
            bail!(WrongUsage(format!(
                "--order: no pack is named {name}; give names out of {packs}"
            )));
        }
        if let Some(name) = self.packs.keys().find(|name| !is_there(name)) {
            bail!(
                "--about {}: [{name}]: no pack is named so; give names out of {packs}",
                self.file.display()
            );
        }
        Ok(())
    }

    /// What is said of a pack.
    pub(super) fn of(&self, name: &str) -> AboutPack {
        self.packs.get(name).cloned().unwrap_or_default()
    }

    /// Where a pack stands in the order that was asked for; one that is not named comes last.
    pub(super) fn place(&self, pack: &str) -> usize {
        let place = self.order.iter().position(|name| name == pack);
        place.unwrap_or(usize::MAX)
    }

    /// The list page with its heading, for packs that show `kinds` of content.
    pub(super) fn titled(&self, page: &'static [u8], kinds: &[ListedKind]) -> Vec<u8> {
        let page = String::from_utf8_lossy(page).into_owned();
        let title = match &self.title {
            Some(title) => escape(title),
            None => heading_of(kinds),
        };
        let headed = |page: String, tag: &str| {
            let with = |heading: &str| format!("<{tag}>{heading}</{tag}>");
            page.replace(&with(HEADING), &with(&title))
        };
        headed(headed(page, "title"), "h1").into_bytes()
    }
}

/// The default title of a list of packs.
fn heading_of(kinds: &[ListedKind]) -> String {
    let all = [
        (ListedKind::Video, "videos"),
        (ListedKind::Picture, "pictures"),
        (ListedKind::Scene, "scenes"),
    ];
    let there = all.iter().filter(|(kind, _)| kinds.contains(kind));
    let there: Vec<&str> = there.map(|(_, name)| *name).collect();
    let text = match there.split_last() {
        Some((last, [])) => (*last).to_owned(),
        Some((last, others)) => format!("{} and {last}", others.join(", ")),
        None => return HEADING.to_owned(),
    };
    let (first, rest) = text.split_at(1);
    first.to_uppercase() + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_is_headed_by_what_is_in_it() {
        use ListedKind::{Picture, Scene, Video};
        assert_eq!(heading_of(&[]), "Videos");
        assert_eq!(heading_of(&[Video, Video]), "Videos");
        assert_eq!(heading_of(&[Scene]), "Scenes");
        assert_eq!(heading_of(&[Scene, Video]), "Videos and scenes");
        assert_eq!(
            heading_of(&[Scene, Picture, Video]),
            "Videos, pictures and scenes"
        );
    }
}
