//! What does source say: its characters, its files, the modules of a crate?

pub(crate) mod file;
pub(crate) mod graph;
pub(crate) mod lexing;
pub(crate) mod modules;
mod syntax;
pub(crate) mod typescript;
