//! Which other kind of file was given, by its first bytes, and how does one get at what was meant?

use foveal_media::plain_file::first_bytes;
use std::path::Path;

/// So many bytes are looked at.
const HEAD: u64 = 4096;
/// Where a tar archive names its format.
const TAR_AT: usize = 257;

/// How a kind of file begins, what it is, and what to do with it.
type Kind = (&'static [u8], &'static str, &'static str);

const UNPACK: &str = "unpack it and give the file in it";
/// What is a ZIP archive by its format.
const ARCHIVES: [&str; 5] = ["3mf", "usdz", "kmz", "sog", "fcstd"];
const EXPORT: &str = "open it in Blender or the program that made it, and export it as .glb";
const AS_POINTS: &str = "open it in CloudCompare, and save it as .laz or .ply";

const KINDS: [Kind; 26] = [
    (
        b"version https://git-lfs",
        "a Git LFS pointer, not the file itself",
        "run `git lfs pull` in its repository",
    ),
    (b"PK\x03\x04", "a ZIP archive", UNPACK),
    (b"PK\x05\x06", "an empty ZIP archive", UNPACK),
    (
        b"\x1f\x8b",
        "packed by gzip",
        "unpack it with `gzip -dc FILE > NEW`",
    ),
    (
        b"BZh",
        "packed by bzip2",
        "unpack it with `bzip2 -dc FILE > NEW`",
    ),
    (
        b"\xfd7zXZ\0",
        "packed by xz",
        "unpack it with `xz -dc FILE > NEW`",
    ),
    (
        b"\x28\xb5\x2f\xfd",
        "packed by zstd",
        "unpack it with `zstd -dc FILE > NEW`",
    ),
    (b"7z\xbc\xaf\x27\x1c", "a 7z archive", UNPACK),
    (b"Rar!\x1a\x07", "a RAR archive", UNPACK),
    (
        b"%PDF-",
        "a PDF document",
        "give the file that it is about, or its pages as pictures, which `pdftoppm -png FILE PAGE` \
         writes",
    ),
    (b"Kaydara FBX Binary", "an FBX file", EXPORT),
    (b"; FBX ", "an FBX file", EXPORT),
    (b"BLENDER", "a Blender file", EXPORT),
    (b"PXR-USDC", "a USD file", EXPORT),
    (b"#usda", "a USD file", EXPORT),
    (b"#VRML", "a VRML file", EXPORT),
    (b"OFF\n", "an OFF file", EXPORT),
    (b"OFF\r\n", "an OFF file", EXPORT),
    (
        b"ISO-10303-21",
        "a STEP or IFC file",
        "export its surfaces as .glb or .stl",
    ),
    (
        b"AC10",
        "a DWG drawing",
        "export its surfaces as .glb or .stl",
    ),
    (b"ASTM-E57", "an E57 scan", AS_POINTS),
    (b"# .PCD", "a PCD cloud", AS_POINTS),
    (b"VERSION .7", "a PCD cloud", AS_POINTS),
    (b"FOVEAL\r\n", "a pack", "play it with `foveal view`"),
    (
        b"SQLite format 3",
        "a database",
        "export what is to be shown from it",
    ),
    (b"\x7fELF", "a program", "give the file that it makes"),
];

/// What a file is, and what to do, where its first bytes show that it is not what its name says.
pub(crate) fn found(path: &Path) -> Option<String> {
    let head = first_bytes(path, HEAD).ok()?;
    let (what, next) = kind_of(&head)?;
    // Formats that are such archives are named by their own ends.
    let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
    if next == UNPACK && ARCHIVES.iter().any(|it| ending == *it) {
        return None;
    }
    Some(format!("{}: is {what}; {next}", path.display()))
}

fn kind_of(head: &[u8]) -> Option<(&'static str, &'static str)> {
    let bare = head
        .strip_prefix(b"\xef\xbb\xbf")
        .unwrap_or(head)
        .trim_ascii_start();
    let begins = |it: &&Kind| bare.starts_with(it.0);
    if let Some((_, what, next)) = KINDS.iter().find(begins) {
        return Some((what, next));
    }
    if head.get(TAR_AT..TAR_AT + 5) == Some(b"ustar") {
        return Some(("a tar archive", UNPACK));
    }
    if !head.is_empty() && head.iter().all(|byte| *byte == 0) {
        let what = "nothing but zeros where it should begin";
        return Some((
            what,
            "copy or download it again, as it did not arrive whole",
        ));
    }
    let small = String::from_utf8_lossy(bare).to_ascii_lowercase();
    let is_page = ["<!doctype html", "<html", "<head", "<script", "<body"];
    if is_page.iter().any(|it| small.starts_with(it)) || is_xml_with(&small, "<html") {
        let what = "a web page (HTML), as a server gives in place of a file";
        return Some((what, "download the file itself"));
    }
    if is_xml_with(&small, "<collada") || small.starts_with("<collada") {
        return Some(("a COLLADA file", EXPORT));
    }
    if is_xml_with(&small, "<x3d") || small.starts_with("<x3d") {
        return Some(("an X3D file", EXPORT));
    }
    if is_xml_with(&small, "<error") || small.starts_with("<error") {
        let what = "an answer of a server (XML) that reports an error, in place of a file";
        return Some((what, "download the file itself"));
    }
    None
}

/// Whether a text is XML in which an element begins soon.
fn is_xml_with(text: &str, element: &str) -> bool {
    text.starts_with("<?xml") && text.contains(element)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_known_by_their_first_bytes() {
        let mut tar = vec![b'a'; 512];
        tar[TAR_AT..TAR_AT + 5].copy_from_slice(b"ustar");
        for (head, word) in [
            (
                &b"version https://git-lfs.github.com/spec/v1\noid"[..],
                "Git LFS",
            ),
            (b"PK\x03\x04..", "ZIP"),
            (b"\n<!DOCTYPE HTML><p>", "HTML"),
            (b"<?xml version=\"1.0\"?><COLLADA>", "COLLADA"),
            (b"<?xml version=\"1.0\"?><Error><Code>", "server"),
            (b"Kaydara FBX Binary  \0", "FBX"),
            (&[0; 300], "zeros"),
            (&tar, "tar"),
        ] {
            let found = kind_of(head).map(|it| it.0);
            assert!(
                found.is_some_and(|it| it.contains(word)),
                "{word}: {found:?}"
            );
        }
        for head in [
            &b""[..],
            b"v 0 0 0\n",
            b"ply\n",
            b"solid a\n",
            b"<svg>",
            b"<?xml?><mpcdi>",
        ] {
            assert_eq!(kind_of(head), None);
        }
    }
}
