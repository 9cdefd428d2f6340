//! What do any bytes say, read as a page of a texture? Also the body of a fuzz target.

#![allow(dead_code)]

use foveal_core::content::images::payload::ImagePage;
use foveal_core::content::images::shape::{BORDER, TextureShape};
use foveal_core::content::images::wrap::Wrap;
use foveal_core::content::scene::description::SceneTexture;

/// Textures of one page, of a few, and of the largest size.
pub(crate) fn textures() -> Vec<SceneTexture> {
    let texture = |size| SceneTexture {
        name: String::new(),
        size,
        wrap: [Wrap::Repeat; 2],
        colour: [0.5; 3],
        cutoff: None,
    };
    [[6, 5], [700, 300], [16384, 16384]].map(texture).to_vec()
}

/// Reads bytes as a page of these textures; returns whether they were one.
pub(crate) fn parse_anything(data: &[u8]) -> bool {
    let textures = textures();
    let Ok(read) = ImagePage::parse(data, &textures) else {
        return false;
    };
    let size = textures[usize::from(read.texture)].size;
    let inner = TextureShape { size }.page_size(read.page);
    let inner = inner.expect("a page that was read is one of its texture's");
    assert_eq!(read.picture.size, inner.map(|side| side + 2 * BORDER));
    let [columns, rows] = read.picture.size.map(|side| side as usize);
    assert_eq!(read.picture.texels.len(), columns * rows);
    true
}
