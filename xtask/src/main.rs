//! Does this repository keep its own rules? The commands behind `cargo xtask`.

#![allow(clippy::print_stdout)]

mod ci;
mod deps;
mod measured;
mod steps;
mod tidy;
mod touched;
mod wasm;
mod web;

use std::process::ExitCode;

use measured::Which;

const USAGE: &str = "\
cargo xtask COMMAND
  tidy            rules of ARCHITECTURE.md and STYLE.md that a machine can check
  tidy known      what broke them before they were checked, and is listed until it is mended
  wasm            core and render for the browser; the same selection natively and in wasm
  web             the page: wasm, scripts and pages in web/dist, with their size
  web-test        the tests of the page; its pictures against those of the program
  web-bench       the page's memory over ten minutes, and a 16K panorama over a link
  ci              every check: what CI runs
  measured [NAME] repeat the figures of docs/measured.toml (of runs whose name contains NAME) and
                  say what moved; --sample only the quick ones, as CI does; --take NAME writes
                  what came out into the list; --write writes the tables and plots of documents
  check           fmt, tidy, clippy and tests of the crates that differ from the last commit
  bless [FILTER]  run the tests (those whose name contains FILTER) and rewrite their goldens";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let outcome = match words.as_slice() {
        ["tidy"] => tidy::run(),
        ["tidy", "known"] => tidy::tell_known(),
        ["wasm"] => wasm::run(),
        ["web"] => web::run(),
        ["web-test"] => web::test(),
        ["web-bench"] => web::bench(),
        ["ci"] => ci::all(),
        ["measured"] => measured::repeat(&Which::Named("")),
        ["measured", "--sample"] => measured::repeat(&Which::Sample),
        ["measured", "--write"] => measured::write(),
        ["measured", "--take", name] => measured::take(name),
        ["measured", name] if !name.starts_with('-') => measured::repeat(&Which::Named(name)),
        ["check"] => ci::touched(),
        ["bless"] => steps::bless(None),
        ["bless", filter] => steps::bless(Some(filter)),
        ["help" | "--help" | "-h"] => {
            println!("{USAGE}");
            Ok(())
        }
        _ => {
            eprintln!("{USAGE}");
            return ExitCode::from(2);
        }
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("xtask: {message}");
            ExitCode::FAILURE
        }
    }
}
