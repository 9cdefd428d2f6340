//! How do the commands of xtask run programs?

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

/// What a command comes to: nothing to say, or why it failed.
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

/// Cargo in the repository root, as a user's shell would start it: without what `cargo run` adds
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

/// [`cargo`] with Clippy as the compiler of the workspace's own crates: compiling lints, where
/// `cargo clippy` would check every dependency again. Warnings are errors. Cargo keeps what it
/// builds so apart from what plain cargo builds.
pub(crate) fn linting_cargo(arguments: &[&str]) -> Result<Command, String> {
    let sysroot = output_of(Command::new("rustc").args(["--print", "sysroot"]))?;
    let driver = Path::new(sysroot.trim()).join("bin").join("clippy-driver");
    let driver = driver.with_extension(env::consts::EXE_EXTENSION);
    if !driver.is_file() {
        return Err("clippy is missing: run `rustup component add clippy`".to_owned());
    }
    let mut command = cargo(arguments);
    command.env("RUSTC_WORKSPACE_WRAPPER", driver);
    // `cargo clippy -- -D warnings` hands its words to the driver so.
    const BETWEEN: &str = "__CLIPPY_HACKERY__";
    command.env("CLIPPY_ARGS", format!("-D{BETWEEN}warnings{BETWEEN}"));
    Ok(command)
}

/// The program `name` of the workspace, built. With the features of the whole workspace, so that
/// it shares what tests and other programs are made of.
pub(crate) fn built(name: &str) -> Result<Command, String> {
    let words = ["build", "--quiet", "--workspace", "--bin", name];
    run(&mut linting_cargo(&words)?)?;
    Ok(Command::new(target_folder()?.join("debug").join(name)))
}

/// The wasm module `name`, built as pages load it. All of them are built together, to share what
/// they are made of.
pub(crate) fn module(name: &str) -> Result<PathBuf, String> {
    let build = [
        "build",
        "--quiet",
        "--profile",
        "web",
        "--target",
        WASM,
        "--lib",
    ];
    run(cargo(&build).args(["-p", "foveal-web", "-p", "wasm-check"]))?;
    let folder = target_folder()?.join(WASM).join("web");
    Ok(folder.join(format!("{name}.wasm")))
}

const WASM: &str = "wasm32-unknown-unknown";

/// Where cargo builds.
pub(crate) fn target_folder() -> Result<PathBuf, String> {
    let metadata = workspace_metadata()?;
    let folder = metadata["target_directory"].as_str();
    Ok(folder.ok_or("cargo names no target folder")?.into())
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

/// Runs the tests so that they write their golden files instead of comparing with them.
pub(crate) fn bless(filter: Option<&str>) -> Outcome {
    let mut words = vec!["test", "--workspace"];
    words.extend(filter);
    run(linting_cargo(&words)?.env("FOVEAL_BLESS", "1"))?;
    println!("bless: look at each picture that `git status` now lists before you commit it");
    Ok(())
}

/// What cargo knows of the workspace's own packages; asks no registry.
pub(crate) fn workspace_metadata() -> Result<Value, String> {
    let words = [
        "metadata",
        "--no-deps",
        "--offline",
        "--format-version",
        "1",
    ];
    let text = output_of(&mut cargo(&words))?;
    serde_json::from_str(&text).map_err(|e| format!("cargo metadata: {e}"))
}
