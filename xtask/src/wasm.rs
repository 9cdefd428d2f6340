//! Is the same selection made natively and in wasm, bit for bit?

use std::path::Path;
use std::process::Command;

use crate::steps::{self, Outcome, cargo, output_of};

const TARGET: &str = "wasm32-unknown-unknown";
/// The package that exports the hash of a scripted run.
const PACKAGE: &str = "wasm-check";
/// Calls the module's one function and prints its 64 bits: wasm knows no unsigned result.
const SCRIPT: &str = "\
const bytes = require('fs').readFileSync(process.argv[1]);
WebAssembly.instantiate(bytes, {})
  .then(({ instance }) => BigInt.asUintN(64, instance.exports.selection_hash()))
  .then((hash) => console.log(hash.toString(16)))
  .catch((error) => { console.error(String(error)); process.exit(1); });";

/// Compiles what must run in a browser, then runs one log through core on both targets.
pub(crate) fn run() -> Outcome {
    steps::run(&mut cargo(&[
        "check",
        "--quiet",
        "--target",
        TARGET,
        "-p",
        "foveal-core",
        "-p",
        "foveal-render",
        "--lib",
    ]))?;
    let in_wasm = hash_from_text(&hash_in_wasm()?)?;
    let native = hash_from_text(&output_of(&mut cargo(&["run", "--quiet", "-p", PACKAGE]))?)?;
    compare(native, in_wasm)?;
    println!("wasm: selection hash {native:016x}, natively and in wasm");
    Ok(())
}

fn hash_in_wasm() -> Result<String, String> {
    steps::run(&mut cargo(&[
        "build",
        "--quiet",
        "--release",
        "--target",
        TARGET,
        "-p",
        PACKAGE,
        "--lib",
    ]))?;
    let metadata = crate::tidy::workspace_metadata()?;
    let target = metadata["target_directory"]
        .as_str()
        .ok_or("cargo names no target folder")?;
    let module = Path::new(target)
        .join(TARGET)
        .join("release/wasm_check.wasm");
    output_of(Command::new("node").arg("-e").arg(SCRIPT).arg(module))
}

fn hash_from_text(text: &str) -> Result<u64, String> {
    let digits = text.trim().trim_start_matches("0x");
    u64::from_str_radix(digits, 16).map_err(|_| {
        format!(
            "expected a hash of at most 16 hex digits, found `{}`",
            text.trim()
        )
    })
}

fn compare(native: u64, in_wasm: u64) -> Outcome {
    if native == in_wasm {
        return Ok(());
    }
    Err(format!(
        "one log, two selections: {native:016x} natively, {in_wasm:016x} in wasm; look for \
         platform mathematics, hash order or usize in core"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hash_reads_the_same_with_and_without_prefix_and_newline() {
        assert_eq!(hash_from_text("0x00ff\n"), Ok(255));
        assert_eq!(hash_from_text("ffffffffffffffff"), Ok(u64::MAX));
        assert!(hash_from_text("").is_err());
        assert!(hash_from_text("12345678123456781").is_err());
    }

    #[test]
    fn two_different_hashes_are_an_error_that_shows_both() {
        assert_eq!(compare(7, 7), Ok(()));
        let message = compare(0xab, 0xcd).unwrap_err();
        assert!(
            message.contains("00ab") && message.contains("00cd"),
            "{message}"
        );
    }
}
