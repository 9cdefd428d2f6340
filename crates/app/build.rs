//! Which files of the built page go into the program?
//!
//! Those of `web/dist`, where `cargo xtask web` finished it; a program built without them says so
//! when they are asked for.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

/// Written last by `cargo xtask web`: the folder is whole.
const STAMP: &str = ".built";

fn main() {
    let manifest = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    let dist = manifest.join("../../web/dist");
    // The stamp changes with every build of the page. While it is not there, its folder is watched:
    // a path that does not exist would make this run every time.
    let stamp = dist.join(STAMP);
    let watched = [&stamp, &dist].into_iter().find(|path| path.exists());
    let folder = manifest.join("../../web");
    let watched = watched.unwrap_or(&folder);
    println!("cargo::rerun-if-changed={}", watched.display());
    println!("cargo::rerun-if-changed=build.rs");
    let mut names = Vec::new();
    if stamp.exists() {
        list(&dist, "", &mut names);
    }
    names.sort();
    let mut table = String::from("&[\n");
    for name in names {
        let path = dist.join(&name);
        let _ = writeln!(
            table,
            "    WebFile {{ name: {name:?}, bytes: include_bytes!({path:?}) }},"
        );
    }
    table.push(']');
    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default());
    if let Err(error) = fs::write(out.join("web_files.rs"), table) {
        println!("cargo::error=the list of the page's files cannot be written: {error}");
    }
}

/// The names of all files in a folder and below, with `/` between folders.
fn list(folder: &Path, under: &str, names: &mut Vec<String>) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = format!("{under}{}", entry.file_name().to_string_lossy());
        if entry.path().is_dir() {
            list(&entry.path(), &format!("{name}/"), names);
        } else if !entry.file_name().to_string_lossy().starts_with('.') {
            names.push(name);
        }
    }
}
