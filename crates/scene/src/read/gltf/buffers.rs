//! Which bytes does a view of a glTF buffer show?

use std::borrow::Cow;
use std::collections::HashSet;
use std::rc::Rc;

use base64::Engine;
use base64::alphabet;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use percent_encoding::percent_decode_str;

use super::super::error::Fault;
use super::super::search::{self, Folder};
use super::json::{Document, View};

/// Bytes that may be unpacked for each byte of the buffers: meshoptimizer's codecs come near that
/// where all elements are the same.
const MOST_UNPACKED: u64 = 64;

/// The bytes of all buffers that could be read.
pub(super) struct Buffers<'a> {
    /// Why there are none; nothing for a buffer that stands in for views that are compressed.
    buffers: Vec<Result<Bytes<'a>, Option<Fault>>>,
    /// How many bytes all have together; what several name counts once, what is unpacked does not.
    pub(super) total: usize,
    /// How many bytes were unpacked.
    pub(super) unpacked: u64,
    /// How many have fewer bytes than the file says.
    pub(super) short: usize,
}

enum Bytes<'a> {
    OfFile(&'a [u8]),
    Read(Rc<Vec<u8>>),
}

impl Bytes<'_> {
    fn get(&self) -> &[u8] {
        match self {
            Self::OfFile(bytes) => bytes,
            Self::Read(bytes) => bytes,
        }
    }
}

impl<'a> Buffers<'a> {
    /// Reads the buffers of a document; `binary` is the binary part of a `.glb`.
    pub(super) fn read(
        document: &Document,
        binary: Option<&'a [u8]>,
        folder: &mut dyn Folder,
    ) -> Self {
        let mut met = HashSet::new();
        let mut buffers = Vec::with_capacity(document.buffers.len());
        let mut short = 0;
        let mut total = binary.map_or(0, <[u8]>::len);
        for (number, buffer) in document.buffers.iter().enumerate() {
            let bytes = match (&buffer.uri, binary) {
                _ if buffer.is_fallback() => Err(None),
                (Some(uri), _) => match bytes_of(uri, &format!("buffer {number}"), folder) {
                    Ok(bytes) => {
                        if met.insert(Rc::as_ptr(&bytes)) {
                            total += bytes.len();
                        }
                        Ok(Bytes::Read(bytes))
                    }
                    Err(fault) => Err(Some(fault)),
                },
                (None, Some(binary)) if number == 0 => Ok(Bytes::OfFile(binary)),
                (None, _) => Err(None),
            };
            let found = bytes.as_ref().ok().map(|it| it.get().len() as u64);
            short += usize::from(found.is_some_and(|found| found < buffer.byte_length));
            buffers.push(bytes);
        }
        Self {
            buffers,
            total,
            unpacked: 0,
            short,
        }
    }

    /// The bytes of view `number`.
    pub(super) fn view(&self, document: &Document, number: u32) -> Result<&[u8], Fault> {
        let place = || format!("buffer view {number}");
        let Some(view) = document.buffer_views.get(number as usize) else {
            let count = document.buffer_views.len();
            return Err(Fault::at(
                place(),
                format!("there are only {count} buffer views"),
            ));
        };
        self.part(view, &place)
    }

    /// Whether a view of a buffer that is there ends beyond it, so that [`Self::part`] is shorter.
    pub(super) fn is_cut(&self, view: &View) -> bool {
        let buffer = self.buffers.get(view.buffer as usize);
        let length = buffer.and_then(|it| it.as_ref().ok());
        let length = length.map_or(u64::MAX, |it| it.get().len() as u64);
        view.byte_offset.saturating_add(view.byte_length) > length
    }

    /// The bytes that a view at `place` names; where it ends beyond its buffer, those before that.
    pub(super) fn part(&self, view: &View, place: &dyn Fn() -> String) -> Result<&[u8], Fault> {
        let Some(bytes) = self.buffers.get(view.buffer as usize) else {
            let what = format!("names buffer {}, of {}", view.buffer, self.buffers.len());
            return Err(Fault::at(place(), what));
        };
        let bytes = match bytes {
            Ok(bytes) => bytes.get(),
            Err(Some(fault)) => return Err(fault.clone()),
            Err(None) => {
                let what = "has no uri and no bytes";
                return Err(Fault::at(format!("buffer {}", view.buffer), what));
            }
        };
        let length = match view.byte_length {
            0 => u64::MAX,
            length => length,
        };
        range(bytes, view.byte_offset, length).ok_or_else(|| {
            let what = format!(
                "bytes {} and {} more are beyond buffer {}, which has {}",
                view.byte_offset,
                view.byte_length,
                view.buffer,
                bytes.len()
            );
            Fault::at(place(), what)
        })
    }

    /// Why the first buffer that is not there cannot be read.
    pub(super) fn first_fault(&self) -> Option<Fault> {
        let mut lost = self.buffers.iter().filter_map(|it| it.as_ref().err());
        lost.find_map(Clone::clone)
    }

    /// Bytes that may still be unpacked.
    pub(super) fn left(&self) -> u64 {
        let most = (self.total as u64).saturating_mul(MOST_UNPACKED);
        most.saturating_sub(self.unpacked)
    }

    /// Counts bytes that are to be unpacked at `place`, so that a small file cannot become large.
    pub(super) fn allow(&mut self, bytes: u64, place: &str) -> Result<(), Fault> {
        if bytes > self.left() {
            let total = self.total;
            let what = format!("{bytes} bytes are too many to be compressed in {total}");
            return Err(Fault::at(place, what));
        }
        self.unpacked += bytes;
        Ok(())
    }

    /// Adds a buffer of bytes that were unpacked, and gives its number.
    pub(super) fn add(&mut self, bytes: Vec<u8>) -> u32 {
        self.buffers.push(Ok(Bytes::Read(Rc::new(bytes))));
        self.buffers.len() as u32 - 1
    }

    /// Adds a buffer that is not there, for what could not be unpacked, and gives its number.
    pub(super) fn add_lost(&mut self, fault: Fault) -> u32 {
        self.buffers.push(Err(Some(fault)));
        self.buffers.len() as u32 - 1
    }
}

fn range(bytes: &[u8], begin: u64, length: u64) -> Option<&[u8]> {
    let rest = bytes.get(usize::try_from(begin).ok()?..)?;
    let length = usize::try_from(length).unwrap_or(usize::MAX);
    let is_there = length == 0 || !rest.is_empty();
    is_there.then(|| &rest[..length.min(rest.len())])
}

/// The bytes that a URI of something names.
pub(super) fn bytes_of(
    uri: &str,
    what: &str,
    folder: &mut dyn Folder,
) -> Result<Rc<Vec<u8>>, Fault> {
    if let Some(inline) = after_scheme(uri, "data:") {
        return bytes_of_inline(inline)
            .map(Rc::new)
            .map_err(|wrong| Fault::at(what, wrong));
    }
    // Some name a file as it is called, whatever stands for a blank in addresses.
    let name = percent_decode_str(uri).decode_utf8_lossy();
    search::read(folder, &[&name, uri])
}

/// Whether a URI holds its bytes itself.
pub(super) fn is_inline(uri: &str) -> bool {
    after_scheme(uri, "data:").is_some()
}

/// What follows a scheme, in capitals or not.
fn after_scheme<'a>(uri: &'a str, scheme: &str) -> Option<&'a str> {
    let uri = uri.trim_start();
    let (begin, rest) = uri.split_at_checked(scheme.len())?;
    begin.eq_ignore_ascii_case(scheme).then_some(rest)
}

/// Base64 as people write it: with or without what fills up the end.
const LENIENT: GeneralPurpose = GeneralPurpose::new(
    &alphabet::STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_allow_trailing_bits(true)
        .with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// What follows `data:`: a type, maybe `;base64`, a comma, and the bytes.
fn bytes_of_inline(inline: &str) -> Result<Vec<u8>, String> {
    const BASE64: &str = "base64";
    let Some((kind, text)) = inline.split_once(',') else {
        return Err("its data URI has no comma".to_owned());
    };
    let bytes: Cow<'_, [u8]> = percent_decode_str(text).into();
    let last = kind.rsplit(';').next().unwrap_or_default().trim();
    if !last.eq_ignore_ascii_case(BASE64) {
        return Ok(bytes.into_owned());
    }
    let standard = |byte: &u8| match byte {
        b'-' => Some(b'+'),
        b'_' => Some(b'/'),
        blank if blank.is_ascii_whitespace() => None,
        other => Some(*other),
    };
    let plain: Vec<u8> = bytes.iter().filter_map(standard).collect();
    LENIENT
        .decode(plain)
        .map_err(|error| format!("its data URI is no base64: {error}"))
}
