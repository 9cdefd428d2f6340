//! Where does a screenshot go?

use std::path::{Path, PathBuf};

/// Most screenshots of one frame of a pack.
const MOST: u32 = 10_000;

/// A name that is free, after the pack and the frame, next to the pack or in `folder`.
pub(crate) fn free_path(pack: &Path, folder: Option<&Path>, frame: u32) -> PathBuf {
    let beside = pack.parent().unwrap_or(Path::new("."));
    let folder = folder.unwrap_or(beside);
    let stem = pack.file_stem().unwrap_or_default().to_string_lossy();
    let named = |number: u32| match number {
        1 => folder.join(format!("{stem}-frame-{frame:05}.png")),
        _ => folder.join(format!("{stem}-frame-{frame:05}-{number}.png")),
    };
    let mut names = (1..MOST).map(named);
    names
        .find(|name| !name.exists())
        .unwrap_or_else(|| named(MOST))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_screenshot_replaces_another() {
        let folder = std::env::temp_dir().join(format!("foveal-shots-{}", std::process::id()));
        std::fs::create_dir(&folder).unwrap();
        let name = |frame| free_path(Path::new("a/b.foveal"), Some(&folder), frame);
        assert_eq!(name(7), folder.join("b-frame-00007.png"));
        std::fs::write(name(7), "").unwrap();
        assert_eq!(name(7), folder.join("b-frame-00007-2.png"));
        assert_eq!(name(8), folder.join("b-frame-00008.png"));
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
