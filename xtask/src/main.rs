//! Checks the rules of the repository.

fn main() {}
