//! What runs in CI, in which order?

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use crate::{tidy, wasm, web};

/// What a step does: nothing to say, or why it failed.
pub(crate) type Outcome = Result<(), String>;

/// The folder that holds the workspace. Cargo says at run time where xtask's manifest is; what was
/// compiled in may be another clone's, where two of them share a target folder.
pub(crate) fn repository_root() -> PathBuf {
    let here = env::var_os("CARGO_MANIFEST_DIR").unwrap_or(env!("CARGO_MANIFEST_DIR").into());
    let manifest = PathBuf::from(here);
    manifest
        .parent()
        .map_or(PathBuf::from("."), Path::to_path_buf)
}

/// Cargo in the repository root, as a user's shell would start it: without what `cargo run` tells
/// xtask about itself, which would make build scripts run again.
pub(crate) fn cargo(arguments: &[&str]) -> Command {
    let mut command = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(repository_root()).args(arguments);
    for (name, _) in env::vars_os() {
        if name.to_str().is_some_and(|n| {
            n.starts_with("CARGO_PKG_") || n.starts_with("CARGO_MANIFEST_") || n == "CARGO"
        }) {
            command.env_remove(name);
        }
    }
    command
}

/// Runs `command` with its output shown.
pub(crate) fn run(command: &mut Command) -> Outcome {
    let status = command.status().map_err(|e| not_started(command, &e))?;
    if status.success() {
        Ok(())
    } else {
        Err(format!("{} failed ({status})", shown(command)))
    }
}

/// Runs `command` and returns what it wrote to standard output.
pub(crate) fn output_of(command: &mut Command) -> Result<String, String> {
    let output = command
        .stderr(std::process::Stdio::inherit())
        .output()
        .map_err(|e| not_started(command, &e))?;
    if !output.status.success() {
        return Err(format!("{} failed ({})", shown(command), output.status));
    }
    String::from_utf8(output.stdout).map_err(|_| format!("{} wrote no UTF-8", shown(command)))
}

fn shown(command: &Command) -> String {
    let program = Path::new(command.get_program())
        .file_name()
        .unwrap_or_default();
    let words = std::iter::once(program).chain(command.get_args());
    words
        .map(|word| word.to_string_lossy())
        .collect::<Vec<_>>()
        .join(" ")
}

fn not_started(command: &Command, error: &std::io::Error) -> String {
    format!(
        "{} did not start: {error}; scripts/install.sh --check says why",
        shown(command)
    )
}

/// Every check, the fast ones first and the tests last, so that a log ends in their summaries.
pub(crate) fn ci() -> Outcome {
    step("fmt", || run(&mut cargo(&["fmt", "--all", "--check"])))?;
    step("tidy", tidy::run)?;
    // The program carries the page, so the page comes first.
    step("web", web::run)?;
    step("clippy", || {
        let words = [
            "clippy",
            "--workspace",
            "--all-targets",
            "--quiet",
            "--",
            "-D",
            "warnings",
        ];
        run(&mut cargo(&words))
    })?;
    step("wasm", wasm::run)?;
    step("web-test", web::test)?;
    step("test", || {
        run(cargo(&["test", "--workspace"]).env("RUST_BACKTRACE", "1"))
    })
}

/// Runs the tests so that they write their golden files instead of comparing with them.
pub(crate) fn bless(filter: Option<&str>) -> Outcome {
    let mut words = vec!["test", "--workspace"];
    words.extend(filter);
    run(cargo(&words).env("FOVEAL_BLESS", "1"))?;
    println!("bless: look at each picture that `git status` now lists before you commit it");
    Ok(())
}

fn step(name: &str, work: impl FnOnce() -> Outcome) -> Outcome {
    println!("== {name}");
    let start = Instant::now();
    let outcome = work();
    println!("== {name}: {:.1} s", start.elapsed().as_secs_f64());
    outcome.map_err(|message| format!("step {name}: {message}"))
}
