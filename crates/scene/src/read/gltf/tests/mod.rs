//! What of glTF is read, and what is refused?

mod clouds;
mod lenient;
mod made;
mod meshes;
mod packed;
mod refused;
mod scenes;
mod textures;

use super::super::files::Nowhere;
use super::read;
use crate::source::SourceScene;
use made::Made;

fn scene(made: &Made) -> SourceScene {
    read(&made.glb(), "a", &mut Nowhere).unwrap()
}

fn refusal(bytes: &[u8]) -> String {
    let fault = read(bytes, "a", &mut Nowhere).unwrap_err();
    fault.in_file("a.glb".as_ref()).to_string()
}
