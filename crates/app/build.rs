//! Which files of the built page go into the program?
//!
//! Those of `web/dist`, which a release build makes where it is missing or old; a program built
//! without them says so when they are asked for.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::SystemTime;
use std::{env, fs};

/// Written last by `cargo xtask web`: the folder is whole.
const STAMP: &str = ".built";

/// What the page is made of, from the root of the repository.
const SOURCES: [&str; 13] = [
    "crates/core/src",
    "crates/render/shaders",
    "crates/render/src",
    "crates/web/Cargo.toml",
    "crates/web/src",
    "web/404.html",
    "web/index.html",
    "web/package-lock.json",
    "web/public",
    "web/src",
    "web/tsconfig.json",
    "web/view.html",
    "web/vite.config.ts",
];
/// Set to 0, no page is built here: the one that is there goes into the program, or none.
const SWITCH: &str = "FOVEAL_BUILD_PAGE";

fn main() {
    let manifest = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    let root = manifest.join("../..");
    let dist = root.join("web/dist");
    let stamp = dist.join(STAMP);
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed={SWITCH}");
    let wanted = env::var("PROFILE").is_ok_and(|profile| profile == "release");
    if wanted && env::var_os(SWITCH).is_none_or(|switch| switch != "0") {
        if is_stale(&root, &stamp) {
            build_page(&root);
        }
        for source in SOURCES.map(|source| root.join(source)) {
            if source.exists() {
                println!("cargo::rerun-if-changed={}", source.display());
            }
        }
    }
    // The stamp changes with every build of the page. While it is not there, its folder is watched:
    // a path that does not exist would make this run every time.
    let folder = root.join("web");
    let watched = [&stamp, &dist].into_iter().find(|path| path.exists());
    println!(
        "cargo::rerun-if-changed={}",
        watched.unwrap_or(&folder).display()
    );
    write_table(&dist, stamp.exists());
}

/// Whether the page is not there, or older than what it is made of.
fn is_stale(root: &Path, stamp: &Path) -> bool {
    let Some(built) = modified(stamp) else {
        return true;
    };
    let newest = SOURCES
        .iter()
        .filter_map(|source| newest(&root.join(source)));
    newest.max().is_some_and(|newest| newest > built)
}

fn modified(path: &Path) -> Option<SystemTime> {
    fs::metadata(path).ok()?.modified().ok()
}

/// When anything in a file or folder was changed last.
fn newest(path: &Path) -> Option<SystemTime> {
    if !path.is_dir() {
        return modified(path);
    }
    let entries = fs::read_dir(path).into_iter().flatten().flatten();
    entries.filter_map(|entry| newest(&entry.path())).max()
}

/// Runs `cargo xtask web` with a target folder of its own, as this one is in use. Where that is
/// not possible the program is built all the same, and says so when it is asked for pages.
fn build_page(root: &Path) {
    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default());
    // OUT_DIR is target/PROFILE/build/PACKAGE/out.
    let target = out.ancestors().nth(4).unwrap_or(&out).join("page");
    let mut command = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command
        .args(["run", "--quiet", "--package", "xtask", "--", "web"])
        .current_dir(root)
        .env("CARGO_TARGET_DIR", target);
    // What is said about this build does not hold for that one.
    for name in [
        "CARGO_ENCODED_RUSTFLAGS",
        "RUSTC_WORKSPACE_WRAPPER",
        "RUSTC",
    ] {
        command.env_remove(name);
    }
    let why = match command.output() {
        Ok(output) if output.status.success() => return,
        Ok(output) => String::from_utf8_lossy(&output.stderr).into_owned(),
        Err(error) => error.to_string(),
    };
    let last = why.lines().rev().find(|line| !line.trim().is_empty());
    println!(
        "cargo::warning=the program carries no pages, for they could not be built: {}; \
         `cargo xtask web` says more",
        last.unwrap_or("no reason given")
    );
}

fn write_table(dist: &Path, is_whole: bool) {
    let mut names = Vec::new();
    if is_whole {
        list(dist, "", &mut names);
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
