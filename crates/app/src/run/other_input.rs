//! Which command reads a file that this one does not?

use crate::report::output::WrongUsage;
use crate::run::not_the_file;
use crate::run::pack_place::begins_as_pack;
use foveal_media::VideoInput;
use foveal_scene::read::is_scene_file;
use std::path::Path;

/// Refuses a file that is a pack already.
pub(crate) fn refuse_pack(input: &Path) -> Result<(), WrongUsage> {
    let name = input.display();
    match begins_as_pack(input) {
        true => Err(WrongUsage(format!(
            "{name}: is a pack already; play it with `foveal view {name}`, or give the file that \
             it was made from"
        ))),
        false => Ok(()),
    }
}

/// Why a file cannot be prepared as a video; for a 3D file, with the command that prepares it.
pub(crate) fn no_video(input: &Path, error: anyhow::Error) -> anyhow::Error {
    if let Some(found) = not_the_file::found(input) {
        return anyhow::anyhow!(found);
    }
    let name = input.display();
    match is_scene_file(input) && input.is_file() {
        true => WrongUsage(format!(
            "{name}: is a 3D file; make a pack of it with `foveal prepare scene {name} --out PACK`"
        ))
        .into(),
        false => error,
    }
}

/// Why a file cannot be prepared as a scene; for a video or a picture, with the command that
/// prepares it.
pub(crate) fn no_scene(inputs: &[impl AsRef<Path>], error: anyhow::Error) -> anyhow::Error {
    let mut all = inputs.iter().map(AsRef::as_ref);
    if let Some(found) = all.find_map(not_the_file::found) {
        return anyhow::anyhow!(found);
    }
    let is_video = |input: &&Path| !is_scene_file(input) && VideoInput::open(input).is_ok();
    match inputs.iter().map(AsRef::as_ref).find(is_video) {
        Some(input) => {
            let name = input.display();
            WrongUsage(format!(
                "{name}: is a video or a picture; make a pack of it with `foveal prepare video \
                 {name} --out PACK`"
            ))
            .into()
        }
        None => error,
    }
}

/// The command to suggest when a file or folder was given in place of one of `command`'s.
pub(crate) fn meant_command(command: &str, word: &str) -> Option<String> {
    let path = Path::new(word);
    if command == "foveal panels" {
        let is_rig = path.is_file() || path.extension().is_some();
        return match path.is_dir() {
            true => Some(format!(
                "{word} is a folder: give a rig file in it, as `foveal panels fit RIG.toml`"
            )),
            false => is_rig.then(|| {
                format!("`foveal panels fit {word}` shows how a source fits to the panels of a rig")
            }),
        };
    }
    if path.is_dir() {
        return Some(format!(
            "{word} is a folder: give a file in it, as `foveal prepare video {word}/FILE --out \
             PACK`"
        ));
    }
    if path.extension().is_some_and(|it| it == "foveal") || begins_as_pack(path) {
        return Some(format!("`foveal view {word}` plays a pack"));
    }
    let is_file = path.is_file() || path.extension().is_some();
    let kind = if is_scene_file(path) {
        "scene"
    } else {
        "video"
    };
    is_file.then(|| format!("`foveal prepare {kind} {word} --out PACK` makes a pack of that file"))
}

/// Why an address given in place of a file cannot be opened.
pub(crate) fn no_address(words: &[String], error: anyhow::Error) -> anyhow::Error {
    let is_address = |word: &&String| {
        let scheme = word.split_once("://").map(|(scheme, _)| scheme);
        scheme.is_some_and(|it| {
            ["http", "https", "ftp"]
                .iter()
                .any(|known| it.eq_ignore_ascii_case(known))
        })
    };
    let text = format!("{error:#}");
    let is_missing = text.contains("No such file or directory");
    let address = words
        .iter()
        .find(|it| is_address(it) && text.contains(it.as_str()));
    match address.filter(|_| is_missing) {
        Some(address) => anyhow::anyhow!(
            "{address}: is an address, and only files on this machine are read; download it first, \
             for example with `curl -LO {address}`, and give the file"
        ),
        None => error,
    }
}
