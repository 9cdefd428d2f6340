//! How does a site get into a folder?

use crate::commands::site::about::AboutOptions;
use crate::commands::site::listing::{GENERATOR, Listed, Listing};
use crate::commands::site::pack_names::names_of;
use crate::commands::site::site_pack::growth;
use crate::commands::site::{About, LISTING, Site, SiteFile, open_packs};
use crate::report::output::{self, Counting, WrongUsage};
use anyhow::{Context, bail};
use clap::{Args, Subcommand};
use foveal_core::units::counted;
use foveal_media::pack::pack::Pack;
use foveal_media::plain_file::{read_plain, rename_durably};
use serde::Serialize;
use std::collections::BTreeSet;
use std::io::ErrorKind;
use std::path::{Component, Path, PathBuf};

/// Largest list of an earlier site that is read, in bytes: some thousand times a usual one.
const MOST_LISTING: u64 = 16 << 20;

/// What can be exported.
#[derive(Clone, Debug, Subcommand)]
pub(crate) enum Export {
    /// Write a folder of pages and packs that any web host can serve.
    Site(SiteArgs),
}

#[derive(Clone, Debug, Args)]
pub(crate) struct SiteArgs {
    /// The packs that it shows.
    #[arg(required = true, value_name = "PACK")]
    packs: Vec<PathBuf>,
    /// Folder of the site; made if it is not there. An earlier site in it is replaced.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    about: AboutOptions,
    /// Say what it would hold, and write nothing.
    #[arg(long)]
    dry_run: bool,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// What `export site` prints.
#[derive(Serialize)]
struct Exported<'a> {
    dry_run: bool,
    out: &'a Path,
    files: usize,
    /// Of all files together, as a host sees them.
    bytes: u64,
    /// Packs that share their bytes on disk with the pack that was given.
    linked: usize,
    packs: &'a [Listed],
}

pub(crate) fn run(command: &Export) -> anyhow::Result<()> {
    let Export::Site(args) = command;
    refuse_foreign_folder(&args.out)?;
    let about = About::read(&args.about)?;
    about.check(&names_of(args.packs.iter().map(PathBuf::as_path))?)?;
    let packs = open_packs(&args.packs)?;
    if !args.dry_run {
        tell_damage(&packs)?;
    }
    let site = Site::of(&packs, &about)?;
    let sizes = site.files.values().map(SiteFile::bytes);
    let mut exported = Exported {
        dry_run: args.dry_run,
        out: &args.out,
        files: site.files.len(),
        bytes: sizes.sum::<anyhow::Result<u64>>()?,
        linked: 0,
        packs: &site.packs,
    };
    packs
        .iter()
        .filter_map(growth)
        .for_each(|it| output::say(&it));
    if !args.dry_run {
        exported.linked = write(&site, &args.out, exported.bytes)?;
    }
    output::result(args.json, &exported, &exported.text())
}

/// Reads the packs through: what is damaged is published, as the rest of it can be watched, and
/// reported.
fn tell_damage(packs: &[Pack]) -> anyhow::Result<()> {
    for file in packs {
        let bar = output::bar(Some(file.bytes()), Counting::Bytes);
        let damage = file.verify(|done, _| bar.set_position(done));
        bar.finish_and_clear();
        if let (true, Some(first)) = (damage.is_tangled(), damage.first().first()) {
            bail!("{first}");
        }
        if let Some(first) = damage.first().first() {
            output::say(&format!(
                "warning: {first} ({} in all; the site shows the rest of it)",
                counted(damage.places(), "damaged place")
            ));
        }
    }
    Ok(())
}

impl Exported<'_> {
    fn text(&self) -> String {
        let out = self.out.display();
        let (files, bytes) = (counted(self.files, "file"), self.bytes as f64 / 1e6);
        if self.dry_run {
            return format!("{out}: would hold {files}, {bytes:.2} MB");
        }
        format!(
            "{out}: {files}, {bytes:.2} MB\nsee it:     foveal serve {out}\npublish it: copy \
             the folder to any web host that serves byte ranges (docs/deploy.md)"
        )
    }
}

/// A folder with other things in it is left alone.
fn refuse_foreign_folder(out: &Path) -> anyhow::Result<()> {
    let name = out.display();
    let mut entries = match std::fs::read_dir(out) {
        Ok(entries) => entries,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
        Err(error) => {
            return Err(error).with_context(|| format!("--out {name}: is no folder to write to"));
        }
    };
    if entries.next().is_none() || is_site(out) {
        return Ok(());
    }
    bail!(WrongUsage(format!(
        "--out {name}: the folder is not empty and holds no site; give a new or an empty one"
    )));
}

/// Whether an earlier export made this folder, or began to.
fn is_site(folder: &Path) -> bool {
    [LISTING, BEGUN]
        .iter()
        .any(|name| listing_in(folder, name).is_some())
}

/// Where the list grows; from the first moment on, so that the folder of an export that was stopped
/// is known, and holds no list.
const BEGUN: &str = "packs.json.partial";

/// The list of the site that an earlier export made in this folder, under this name.
fn listing_in(folder: &Path, name: &str) -> Option<serde_json::Value> {
    let bytes = read_plain(&folder.join(name), MOST_LISTING).ok()?;
    let listing: serde_json::Value = serde_json::from_slice(&bytes).ok()?;
    let program = GENERATOR.split(' ').next();
    let generator = listing["generator"].as_str().unwrap_or_default();
    (generator.split(' ').next() == program).then_some(listing)
}

/// Packs and posters that a list names, as far as they lie in its folder.
fn listed_files(listing: &serde_json::Value) -> Vec<String> {
    let packs = listing["packs"].as_array().into_iter().flatten();
    let files = packs.flat_map(|pack| [&pack["file"], &pack["poster"]["file"]]);
    let names = files.filter_map(|name| name.as_str().map(str::to_owned));
    let inside = |name: &String| {
        let mut parts = Path::new(name).components();
        parts.all(|part| matches!(part, Component::Normal(_)))
    };
    names.filter(inside).collect()
}

/// Writes every file whole or not at all, the list last: packs that it names are there. Packs of an
/// earlier site that are not in this one are removed. Where there was none, a failure leaves
/// nothing. Returns how many are links.
fn write(site: &Site, out: &Path, bytes: u64) -> anyhow::Result<usize> {
    if let Some(earlier) = listing_in(out, LISTING) {
        let linked = write_files(site, out, bytes)?;
        remove_stale(site, out, &earlier)?;
        return Ok(linked);
    }
    let was_there = out.is_dir();
    let begun = begin(out).and_then(|()| write_files(site, out, bytes));
    if begun.is_err() {
        take_back(site, out, was_there);
    }
    begun
}

/// Makes the folder of a site, and marks it as one that is not whole yet.
fn begin(out: &Path) -> anyhow::Result<()> {
    std::fs::create_dir_all(out)
        .with_context(|| format!("--out {}: the folder cannot be made", out.display()))?;
    let mark = out.join(BEGUN);
    let written = std::fs::write(&mark, serde_json::to_vec(&Listing::new(&[]))?);
    written.with_context(|| format!("{}: cannot be written", mark.display()))
}

/// Removes what was written of a site that did not become whole, and folders that are empty then.
fn take_back(site: &Site, out: &Path, was_there: bool) {
    let names = site.files.keys().map(String::as_str).chain([BEGUN]);
    let mut folders = BTreeSet::new();
    for path in names.map(|name| out.join(name)) {
        // What cannot be removed is left for the next export.
        let _ = std::fs::remove_file(&path);
        let parents = path.ancestors().skip(1);
        let inner = parents.take_while(|it| *it != out);
        folders.extend(inner.map(Path::to_owned));
    }
    // Inner ones come after those that they lie in.
    for folder in folders.iter().rev() {
        let _ = std::fs::remove_dir(folder);
    }
    if !was_there {
        let _ = std::fs::remove_dir(out);
    }
}

fn write_files(site: &Site, out: &Path, bytes: u64) -> anyhow::Result<usize> {
    let bar = output::bar(Some(bytes), Counting::Bytes);
    let mut linked = 0;
    let last = |name: &&String| name.as_str() == LISTING;
    let names = site.files.keys().filter(|name| !last(name));
    for name in names.chain(site.files.keys().filter(last)) {
        let path = out.join(name);
        let folder = path.parent().unwrap_or(out);
        std::fs::create_dir_all(folder)
            .with_context(|| format!("--out {}: the folder cannot be made", folder.display()))?;
        let file = &site.files[name];
        match file {
            SiteFile::Bytes(bytes) => output::write_whole(&path, bytes)?,
            SiteFile::File(from) => linked += usize::from(place(from, &path)?),
        }
        bar.inc(file.bytes()?);
    }
    bar.finish_and_clear();
    Ok(linked)
}

/// Removes what only an earlier site had.
fn remove_stale(site: &Site, out: &Path, earlier: &serde_json::Value) -> anyhow::Result<()> {
    let stale = listed_files(earlier).into_iter();
    for name in stale.filter(|name| !site.files.contains_key(name)) {
        let path = out.join(name);
        let is_pack = path.extension().is_some_and(|ending| ending == "foveal");
        match std::fs::remove_file(&path) {
            Ok(()) if is_pack => output::say(&format!(
                "{}: was in the earlier site and is removed; name it too to keep it",
                path.display()
            )),
            Err(error) if error.kind() != ErrorKind::NotFound => {
                return Err(error).with_context(|| {
                    format!(
                        "{}: is of the earlier site and cannot be removed",
                        path.display()
                    )
                });
            }
            _ => {}
        }
    }
    Ok(())
}

/// Makes `to` the file `from`: by a hard link where the file system has them, which takes no room,
/// else by a copy. Returns whether it is a link.
fn place(from: &Path, to: &Path) -> anyhow::Result<bool> {
    let from = from
        .canonicalize()
        .with_context(|| format!("{}: cannot be read", from.display()))?;
    let mut growing = to.as_os_str().to_owned();
    growing.push(".partial");
    let growing = Path::new(&growing);
    let _ = std::fs::remove_file(growing);
    let linked = std::fs::hard_link(&from, growing).is_ok();
    let placed = if linked {
        Ok(())
    } else {
        std::fs::copy(&from, growing).map(drop)
    };
    let placed = placed.and_then(|()| rename_durably(growing, to));
    // Renaming one name of a file to another name of it does nothing, and a failure leaves a part.
    let _ = std::fs::remove_file(growing);
    placed.with_context(|| format!("{}: cannot be written", to.display()))?;
    Ok(linked)
}
