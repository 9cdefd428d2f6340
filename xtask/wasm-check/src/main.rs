//! Prints the hashes of scripted runs on this machine, as wasm computes them: of what is selected,
//! and of what sessions do.

#![allow(clippy::print_stdout, reason = "printing is what it is for")]

fn main() {
    println!("{:016x}", wasm_check::selection_hash());
    println!("{:016x}", wasm_check::session_hash());
}
