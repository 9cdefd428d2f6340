//! What lies where a pack is to go, and may it be replaced?

use crate::commands::info::PackInfo;
use crate::report::output::WrongUsage;
use anyhow::bail;
use foveal_core::pack::{Difference, Identity, MAGIC};
use foveal_core::units::one_line;
use foveal_media::pack::name_claim::IfTaken;
use foveal_media::pack::pack_file::PackFile;
use foveal_media::plain_file::first_bytes;
use foveal_scene::read::is_scene_file;
use std::path::{Path, PathBuf};

/// A pack that lies where another is to go.
pub(crate) struct PackThere(PathBuf);

/// What lies there; refuses what is neither a pack nor an empty file, as nothing but a pack is ever
/// replaced by one.
pub(crate) fn pack_at(out: &Path) -> Result<Option<PackThere>, WrongUsage> {
    let Ok(there) = std::fs::symlink_metadata(out) else {
        return Ok(None);
    };
    let what = match there.file_type() {
        kind if kind.is_dir() => "a folder is there, not a pack",
        kind if kind.is_symlink() => "a link is there; name its target",
        kind if !kind.is_file() => "what is there is not a plain file",
        _ if there.len() == 0 => return Ok(None),
        _ if begins_as_pack(out) => return Ok(Some(PackThere(out.to_owned()))),
        _ => "a file is there that is not a pack",
    };
    Err(WrongUsage(format!(
        "--out {}: {what}; choose another --out, or move it away (--force replaces nothing but \
         packs)",
        out.display()
    )))
}

/// Refuses a name for a pack that says it is a film, a picture or a 3D file, as other programs
/// would open it by.
pub(crate) fn refuse_name_of_another(out: &Path) -> Result<(), WrongUsage> {
    const OTHERS: [&str; 11] = [
        "mp4", "m4v", "mkv", "mov", "webm", "avi", "jpg", "jpeg", "png", "webp", "gif",
    ];
    let ending = out.extension().unwrap_or_default().to_string_lossy();
    let is_other = OTHERS.iter().any(|it| it.eq_ignore_ascii_case(&ending));
    match is_other || is_scene_file(out) {
        true => Err(WrongUsage(format!(
            "--out {}: a pack is written, which only Foveal opens, not a file of .{ending}; give \
             --out {}",
            out.display(),
            out.with_extension("foveal").display()
        ))),
        false => Ok(()),
    }
}

/// What becomes of a pack at that name: another that comes meanwhile is not replaced.
pub(crate) fn if_taken(there: Option<&PackThere>) -> IfTaken {
    match there {
        Some(_) => IfTaken::Replace,
        None => IfTaken::Refuse,
    }
}

/// Whether a file is a pack by its first bytes, whatever its name.
pub(crate) fn begins_as_pack(path: &Path) -> bool {
    first_bytes(path, MAGIC.len() as u64).is_ok_and(|begin| begin == MAGIC)
}

impl PackThere {
    /// What is in it, where it is the pack that is wanted; refuses another, which stays.
    pub(crate) fn if_it_is(&self, wanted: &Identity) -> anyhow::Result<PackInfo> {
        let Ok(file) = PackFile::open(&self.0) else {
            bail!(self.in_the_way("a damaged pack, or one of another version, is there"));
        };
        let about = file.pack().description();
        let difference = match &about.identity {
            Some(identity) => identity.difference(wanted),
            None => {
                let what = format!(
                    "a pack is there of {} that does not say how it was made",
                    one_line(&about.source.name)
                );
                bail!(self.in_the_way(&what));
            }
        };
        let how = match difference {
            None if file.verify(|_, _| ()).is_empty() => return PackInfo::new(&file),
            None => bail!(self.in_the_way("the pack that is there is damaged")),
            Some(Difference::Program) => "by another version of the program",
            Some(Difference::Input) => "of another input, or of this one before it changed",
            Some(Difference::Settings) => "with other settings",
        };
        let (name, [w, h]) = (one_line(&about.source.name), about.source.size);
        let what = format!("a pack is there of {name} ({w}x{h}), made {how}");
        bail!(self.in_the_way(&what))
    }

    fn in_the_way(&self, what: &str) -> WrongUsage {
        WrongUsage(format!(
            "--out {}: {what}; give --force to replace it once the new one is whole, or choose \
             another --out",
            self.0.display()
        ))
    }
}
