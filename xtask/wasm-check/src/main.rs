//! Prints the hash of a scripted run on this machine, as wasm computes it.

#![allow(clippy::print_stdout, reason = "printing is what it is for")]

fn main() {
    println!("{:016x}", wasm_check::selection_hash());
}
