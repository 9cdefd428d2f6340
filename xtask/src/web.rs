//! How do the crates and the TypeScript of the page become a folder for a static host?
//!
//! Core and render as wasm, made small, then bundled with the page. `web/dist` is what hosts
//! serve, and what the program embeds.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::steps::{self, Outcome, output_of, repository_root};

/// Written last: where it exists, the folder is whole.
const STAMP: &str = ".built";
/// Most bytes of scripts, styles and wasm together, compressed by brotli.
const MOST_BYTES: u64 = 1 << 20;
/// How the package names its types, which are made next to the page.
const TYPES: &str = "types/foveal-view.d.ts";
/// What every browser with WebGPU runs; more features make some refuse the module.
const WASM_OPT: [&str; 8] = [
    "-O3",
    "--enable-bulk-memory",
    "--enable-nontrapping-float-to-int",
    "--enable-sign-ext",
    "--enable-mutable-globals",
    "--enable-reference-types",
    "--enable-multivalue",
    "--strip-debug",
];
/// Prints name and compressed bytes of each file of a folder that a page loads.
const SIZES: &str = "\
const { readdirSync, readFileSync } = require('fs');
const { brotliCompressSync } = require('zlib');
const list = (folder) => readdirSync(folder, { withFileTypes: true }).flatMap((entry) =>
  entry.isDirectory() ? list(`${folder}/${entry.name}`) : [`${folder}/${entry.name}`]);
for (const file of list('dist').filter((name) => /\\.(js|css|wasm)$/.test(name))) {
  console.log(brotliCompressSync(readFileSync(file)).length, file);
}";

/// Builds `web/dist` and says how large it is.
pub(crate) fn run() -> Outcome {
    let web = repository_root().join("web");
    let _ = fs::remove_file(web.join("dist").join(STAMP));
    build_module(&web)?;
    install(&web)?;
    shrink(&web)?;
    steps::run(&mut tool(&web, "tsc", &["--noEmit"]))?;
    steps::run(&mut tool(&web, "tsc", &["-p", "tsconfig.types.json"]))?;
    steps::run(&mut tool(
        &web,
        "vite",
        &["build", "--logLevel", "warn", "--emptyOutDir"],
    ))?;
    check_size(&web)?;
    fs::write(web.join("dist").join(STAMP), "").map_err(|e| format!("web/dist: {e}"))
}

/// The tests of the TypeScript; then those in a browser.
pub(crate) fn test() -> Outcome {
    let web = repository_root().join("web");
    if !web.join("dist").join(STAMP).exists() || !web.join(TYPES).exists() {
        run()?;
    }
    check()?;
    in_browser(&web, "vitest.e2e.config.ts", program()?)
}

/// The tests of the TypeScript that need no browser.
pub(crate) fn check() -> Outcome {
    let web = repository_root().join("web");
    install(&web)?;
    steps::run(&mut tool(&web, "tsc", &["--noEmit"]))?;
    steps::run(&mut tool(&web, "tsc", &["--noEmit", "-p", "test"]))?;
    steps::run(&mut tool(&web, "vitest", &["run"]))
}

/// Whether memory stays what it is, over minutes of looking (MINUTES, 10 if nothing is said), and
/// how soon a 16K panorama is seen over a link (PANORAMA, else the one that `bench video` keeps).
pub(crate) fn bench() -> Outcome {
    let web = repository_root().join("web");
    install(&web)?;
    in_browser(&web, "vitest.bench.config.ts", program()?)
}

/// The program that FOVEAL names, else one that is built with the page in it.
fn program() -> Result<PathBuf, String> {
    match std::env::var_os("FOVEAL") {
        Some(program) => Ok(program.into()),
        None => Ok(steps::built("foveal")?.get_program().into()),
    }
}

fn in_browser(web: &Path, config: &str, program: PathBuf) -> Outcome {
    let words = ["run", "--config", config];
    steps::run(tool(web, "vitest", &words).env("FOVEAL", program))
}

fn build_module(web: &Path) -> Outcome {
    let module = steps::module("foveal_web")?;
    steps::run(
        steps::built("web-bindgen")?
            .arg(module)
            .arg(web.join("pkg")),
    )
}

/// The tools and libraries of the lock file, once.
fn install(web: &Path) -> Outcome {
    let modified = |path: &str| fs::metadata(web.join(path)).and_then(|m| m.modified()).ok();
    let [lock, installed] = ["package-lock.json", "node_modules/.package-lock.json"].map(modified);
    if installed.is_some() && installed >= lock {
        return Ok(());
    }
    steps::run(
        Command::new("npm")
            .args(["ci", "--no-audit", "--no-fund", "--loglevel", "error"])
            .current_dir(web),
    )
}

fn tool(web: &Path, name: &str, words: &[&str]) -> Command {
    let mut command = Command::new("node");
    let script = match name {
        "tsc" => "typescript/bin/tsc",
        "vite" => "vite/bin/vite.js",
        "vitest" => "vitest/vitest.mjs",
        _ => "binaryen/bin/wasm-opt",
    };
    command
        .arg(web.join("node_modules").join(script))
        .args(words)
        .current_dir(web);
    command
}

fn shrink(web: &Path) -> Outcome {
    let module = "pkg/foveal_bg.wasm";
    let mut words = WASM_OPT.to_vec();
    words.extend([module, "-o", module]);
    steps::run(&mut tool(web, "wasm-opt", &words))
}

fn check_size(web: &Path) -> Outcome {
    let listed = output_of(Command::new("node").args(["-e", SIZES]).current_dir(web))?;
    let size = |line: &str| line.split_once(' ')?.0.parse::<u64>().ok();
    let all: u64 = listed.lines().filter_map(size).sum();
    println!("web: {all} bytes of scripts, styles and wasm, brotli");
    if all <= MOST_BYTES {
        return Ok(());
    }
    Err(format!(
        "web/dist has {all} compressed bytes, at most {MOST_BYTES} are allowed:\n{listed}"
    ))
}
