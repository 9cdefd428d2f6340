//! Is the same selection made natively and in wasm, bit for bit, and do sessions do the same?

use std::process::Command;

use crate::steps::{self, Outcome, output_of};

/// What is compared, in the order in which either side prints its hashes.
const COMPARED: [&str; 2] = ["selection", "session"];

/// Calls the module's functions and prints the 64 bits of each: wasm knows no unsigned result.
const SCRIPT: &str = "\
const bytes = require('fs').readFileSync(process.argv[1]);
WebAssembly.instantiate(bytes, {})
  .then(({ instance: { exports } }) => [exports.selection_hash(), exports.session_hash()])
  .then((hashes) => hashes.map((hash) => BigInt.asUintN(64, hash).toString(16)))
  .then((hashes) => console.log(hashes.join('\\n')))
  .catch((error) => { console.error(String(error)); process.exit(1); });";

/// Runs one log, and a hundred sessions whose wishes are fulfilled in any order, through core on
/// both targets. That core and render compile for the browser shows the page, which is made of
/// them.
pub(crate) fn run() -> Outcome {
    let in_wasm = hashes_from_text(&hashes_in_wasm()?)?;
    let native = hashes_from_text(&output_of(&mut steps::built("selection-hash")?)?)?;
    for ((what, native), in_wasm) in COMPARED.into_iter().zip(native).zip(in_wasm) {
        compare(what, native, in_wasm)?;
        println!("wasm: {what} hash {native:016x}, natively and in wasm");
    }
    Ok(())
}

fn hashes_from_text(text: &str) -> Result<[u64; 2], String> {
    let hashes: Result<Vec<u64>, String> = text.lines().map(hash_from_text).collect();
    let wrong = |found: Vec<u64>| format!("expected two hashes, found {}", found.len());
    hashes?.try_into().map_err(wrong)
}

fn hashes_in_wasm() -> Result<String, String> {
    let module = steps::module("wasm_check")?;
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

fn compare(what: &str, native: u64, in_wasm: u64) -> Outcome {
    if native == in_wasm {
        return Ok(());
    }
    Err(format!(
        "{what}: {native:016x} natively, {in_wasm:016x} in wasm; look for platform \
         mathematics, hash order or usize in core"
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
        assert_eq!(compare("selection", 7, 7), Ok(()));
        let message = compare("selection", 0xab, 0xcd).unwrap_err();
        assert!(
            message.contains("00ab") && message.contains("00cd"),
            "{message}"
        );
    }
}
