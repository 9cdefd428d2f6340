//! What changes with the content of a pack, and is read of it quickly?

use foveal_core::content::scene::pack::{ScenePack, is_scene};
use foveal_core::content::video::bytes::pack::VideoPack;
use foveal_core::pack::{HEADER_BYTES, Header, Index, MAGIC, PackError};
use foveal_core::session::log::sha256_hex;
use std::fs::File;
use std::io::{Read, Result, Seek, SeekFrom};

/// Where in a page of an index its checksum is, and how long that is.
const CRC_AT: u64 = 12;
const CRC_BYTES: usize = 4;
/// Hexadecimal digits of a hash that distinguish packs.
const DIGITS: usize = 32;

/// A hash over the header, the description and the checksum of every page of the index: with those
/// of the side tables, which the description holds, they cover every byte of a pack. `None` of what
/// is no pack, or a damaged one. Reads some bytes for every page.
///
/// # Errors
/// It cannot be read.
pub fn content_tag(file: &mut File) -> Result<Option<String>> {
    let Some((head, index)) = beginning(file)? else {
        return Ok(None);
    };
    let mut told = head;
    for page in 0..index.pages() {
        let Some(place) = index.page_place(page) else {
            continue;
        };
        let mut crc = [0; CRC_BYTES];
        file.seek(SeekFrom::Start(place.start + CRC_AT))?;
        file.read_exact(&mut crc)?;
        told.extend(crc);
    }
    let mut hash = sha256_hex(&told);
    hash.truncate(DIGITS);
    Ok(Some(hash))
}

/// Whether a file begins as a pack does. Leaves it at its beginning.
fn begins_as_pack(file: &mut File) -> Result<bool> {
    let mut first = Vec::new();
    file.seek(SeekFrom::Start(0))?;
    file.by_ref()
        .take(MAGIC.len() as u64)
        .read_to_end(&mut first)?;
    file.seek(SeekFrom::Start(0))?;
    Ok(first == MAGIC)
}

/// Header and description, and an index that knows where its pages lie.
fn beginning(file: &mut File) -> Result<Option<(Vec<u8>, Index)>> {
    if !begins_as_pack(file)? {
        return Ok(None);
    }
    let mut head = Vec::new();
    file.by_ref()
        .take(HEADER_BYTES as u64)
        .read_to_end(&mut head)?;
    let Ok(header) = Header::parse(&head) else {
        return Ok(None);
    };
    let mut description = Vec::new();
    let bytes = u64::from(header.description_bytes);
    file.by_ref().take(bytes).read_to_end(&mut description)?;
    let index = match is_scene(&description) {
        true => of_scene(&header, &description),
        false => VideoPack::begin(&header, &description).map(|it| it.index().clone()),
    };
    if file.metadata()?.len() != header.file_bytes {
        return Ok(None);
    }
    head.extend(description);
    Ok(index.ok().map(|index| (head, index)))
}

fn of_scene(header: &Header, description: &[u8]) -> std::result::Result<Index, PackError> {
    let about = ScenePack::describe(header, description)?;
    ScenePack::index_of(header, &about)
}
