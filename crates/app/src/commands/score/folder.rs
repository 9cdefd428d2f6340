//! Which pictures does a folder hold, in which order?

use anyhow::{Context, bail};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Endings of pictures.
const ENDINGS: [&str; 7] = ["png", "jpg", "jpeg", "webp", "bmp", "tif", "tiff"];

/// The pictures of a folder whose names end with a number, in the order of the numbers; every
/// number from the first to the last is there once.
pub(super) fn numbered_pictures(folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let name = folder.display();
    let entries = std::fs::read_dir(folder).with_context(|| format!("{name}: cannot be listed"))?;
    let mut pictures: BTreeMap<u64, PathBuf> = BTreeMap::new();
    for entry in entries {
        let path = entry
            .with_context(|| format!("{name}: cannot be listed"))?
            .path();
        let Some(number) = number_of(&path) else {
            continue;
        };
        let file = path.file_name().unwrap_or_default().to_string_lossy();
        if file.contains(char::is_control) {
            bail!(
                "{name}: the name {file:?} in it holds a line end or another control character; \
                 rename that picture"
            );
        }
        if let Some(other) = pictures.insert(number, path.clone()) {
            bail!(
                "{}: has the number of {}; keep one of them there",
                path.display(),
                other.display()
            );
        }
    }
    let (Some(first), Some(last)) = (pictures.keys().next(), pictures.keys().next_back()) else {
        bail!("{name}: holds no numbered pictures; name them as 0000.png, 0001.png and so on");
    };
    if let Some(missing) = (*first..*last).find(|number| !pictures.contains_key(number)) {
        bail!("{name}: picture {missing} is missing between {first} and {last}; put it there");
    }
    Ok(pictures.into_values().collect())
}

/// The number at the end of a picture's name.
fn number_of(path: &Path) -> Option<u64> {
    let ending = path.extension()?.to_str()?.to_lowercase();
    let stem = path.file_stem()?.to_string_lossy();
    let text = stem.trim_end_matches(|c: char| c.is_ascii_digit());
    ENDINGS.contains(&ending.as_str()).then_some(())?;
    stem[text.len()..].parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_number_is_what_the_name_ends_with() {
        for (name, number) in [
            ("0012.png", Some(12)),
            ("frame_00003.PNG", Some(3)),
            ("a1b2.jpg", Some(2)),
            ("session.png", None),
            ("12.csv", None),
            ("99999999999999999999999.png", None),
        ] {
            assert_eq!(number_of(Path::new(name)), number, "{name}");
        }
    }
}
