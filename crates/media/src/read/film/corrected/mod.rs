//! What a file says wrongly of itself, and what is read in its place.

pub(crate) mod bytes;
pub mod corrections;
pub(crate) mod file;
mod mp4_edits;
pub mod mp4_says;

/// Pieces of MP4 files that tests make.
#[cfg(test)]
mod made {
    pub(super) fn boxed(name: &[u8; 4], inside: &[u8]) -> Vec<u8> {
        let length = (inside.len() as u32 + 8).to_be_bytes();
        [&length[..], name, inside].concat()
    }

    pub(super) fn words(all: &[u32]) -> Vec<u8> {
        all.iter().flat_map(|it| it.to_be_bytes()).collect()
    }
}
