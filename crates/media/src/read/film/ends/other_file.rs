//! What is a file in which FFmpeg finds no video, and what should its owner do?

use std::path::Path;

use crate::error::MediaError;
use crate::plain_file::first_bytes;
use crate::read::film::corrected::mp4_says::{Lacks, how_to_join};

/// Bytes at the beginning that tell.
const HEAD: u64 = 512;
/// The flag of an Ogg's first page of a stream.
const OGG_FIRST: u8 = 2;

/// First bytes of files that are no video, what they are, and what to do.
const KINDS: [(&[u8], &str, &str); 10] = [
    (
        b"%PDF-",
        "is a PDF document",
        "write its pages as pictures with `pdftoppm -png FILE PAGE`",
    ),
    (
        b"PK\x03\x04",
        "is a ZIP archive",
        "unpack it with `unzip FILE`, and give a file of it",
    ),
    (
        b"\x1f\x8b",
        "is compressed by gzip",
        "unpack it with `gunzip FILE`",
    ),
    (
        b"7z\xbc\xaf\x27\x1c",
        "is a 7z archive",
        "unpack it, and give a file of it",
    ),
    (
        b"Rar!\x1a\x07",
        "is a RAR archive",
        "unpack it, and give a file of it",
    ),
    (
        b"version https://git-lfs",
        "is a pointer of Git LFS, not the file itself",
        "fetch the file with `git lfs pull`",
    ),
    (
        b"<!DOCTYPE html",
        "is a web page",
        "download the file that it links to",
    ),
    (
        b"<!doctype html",
        "is a web page",
        "download the file that it links to",
    ),
    (
        b"<html",
        "is a web page",
        "download the file that it links to",
    ),
    (
        b"8BPS",
        "is a Photoshop file that FFmpeg does not read",
        "export it as PNG or JPEG",
    ),
];

/// What is to be said of a file that is no video, where that is known.
pub(crate) fn other_file(path: &Path) -> Option<MediaError> {
    let head = first_bytes(path, HEAD).unwrap_or_default();
    let other = |what: &str, next: String| {
        Some(MediaError::OtherFile {
            path: path.to_owned(),
            what: what.to_owned(),
            next,
        })
    };
    if let Some((_, what, next)) = KINDS.iter().find(|it| head.starts_with(it.0)) {
        return other(what, (*next).to_owned());
    }
    if begins_in_ogg(&head) {
        let what = "begins in the middle of an Ogg stream: how it is coded stands at its beginning";
        return other(what, "take the file from its beginning on".to_owned());
    }
    match Lacks::of(path)? {
        Lacks::Init => {
            let what = "is a segment of a stream, without the init segment that says how it is \
                        coded";
            other(what, how_to_join(path))
        }
        Lacks::Index => {
            let what = "is an MP4 without its index (moov), as where recording broke off before \
                        it was written: how its frames are coded, and where they lie, stood there";
            let next = "rebuild it with `untrunc GOOD FILE`, where GOOD is a whole recording of \
                        the same camera";
            other(what, next.to_owned())
        }
        Lacks::IndexEnd => {
            let what = "is an MP4 that ends within its index (moov)";
            let next = "copy it again, or rebuild it with `untrunc GOOD FILE`, where GOOD is a \
                        whole recording of the same camera";
            other(what, next.to_owned())
        }
        Lacks::Segments => {
            let what = "is the init segment of a stream, which holds no pictures";
            let next = "join it with its segments, in order, with `cat FILE 1.m4s 2.m4s > \
                        whole.mp4`";
            other(what, next.to_owned())
        }
    }
}

/// Whether an Ogg begins with another page than the first one of a stream (RFC 3533).
fn begins_in_ogg(head: &[u8]) -> bool {
    head.starts_with(b"OggS\0") && head.get(5).is_some_and(|flags| flags & OGG_FIRST == 0)
}
