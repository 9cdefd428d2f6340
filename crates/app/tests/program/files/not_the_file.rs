//! Does a message say what a file really is that was given under another name?

use crate::support::{Folder, refused};

const POINTER: &[u8] = b"version https://git-lfs.github.com/spec/v1\n\
    oid sha256:4d7a214614ab2935c943f9e0ff69d22eadbb8f32b1258daaa5e2ca24d17e2393\nsize 12345\n";

#[test]
fn what_is_no_model_or_film_is_named_with_what_to_do() {
    let folder = Folder::new();
    let page = b"<!DOCTYPE html><html><body>404</body></html>\n";
    let zip = [&b"PK\x03\x04"[..], &[0; 200]].concat();
    let mut files: Vec<(String, &[u8], [&str; 2])> = Vec::new();
    for ending in ["obj", "ply", "stl", "gltf", "glb", "las", "laz", "mp4"] {
        let name = format!("pointer.{ending}");
        files.push((name, POINTER, ["Git LFS pointer", "git lfs pull"]));
    }
    for ending in ["obj", "glb", "las", "mp4"] {
        files.push((format!("zip.{ending}"), &zip, ["ZIP", "unpack"]));
        files.push((format!("page.{ending}"), page, ["HTML", "download"]));
    }
    let gltf_1 = br#"{"asset":{"version":"1.0"},"meshes":{"m":{}},"accessors":{},"nodes":{}}"#;
    let glb_1 = b"glTF\x01\0\0\0\x20\0\0\0\x0c\0\0\0\0\0\0\0{}          ";
    files.push(("old.gltf".to_owned(), gltf_1, ["glTF 1.0", "gltf-pipeline"]));
    files.push(("old.glb".to_owned(), glb_1, ["glTF 1.0", "gltf-pipeline"]));
    files.push((
        "a.fbx".to_owned(),
        b"anything",
        ["is not a 3D file", "Blender"],
    ));
    files.push((
        "a.xyz".to_owned(),
        b"0 0 0\n",
        ["is not a 3D file", "CloudCompare"],
    ));
    for (name, bytes, words) in files {
        let file = folder.holding(&name, bytes);
        let kind = if name.ends_with("mp4") {
            "video"
        } else {
            "scene"
        };
        let out = folder.name("none.foveal");
        let all = [&name[..], words[0], words[1]];
        refused(1, &["prepare", kind, &file, "--out", &out], &all);
    }
    let missing = folder.name("missing.obj");
    let ran = crate::support::foveal(&["prepare", "scene", &missing, "--out", "none.foveal"]);
    assert!(ran.stderr.contains("No such file or directory;"), "{ran:?}");
    assert!(!ran.stderr.contains("os error"), "{ran:?}");
}
