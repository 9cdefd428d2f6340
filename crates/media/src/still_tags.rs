//! What does a picture file say of how it is meant to be looked at?
//!
//! EXIF of JPEG, PNG, WebP and TIFF files tells which way is up, XMP of JPEG and PNG files (before
//! the pixels) whether the picture is of a sphere.

use std::fs::File;
use std::io::{BufRead, BufReader, Seek, SeekFrom};
use std::path::Path;

use exif::{In, Reader, Tag};
use zune_jpeg::JpegDecoder;

use crate::orientation::Orientation;
use crate::photo_sphere::PhotoSphere;

/// What text chunk of a PNG file holds XMP.
const XMP_OF_PNG: &str = "XML:com.adobe.xmp";

/// What a file says, and what of it cannot be read.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct StillTags {
    /// Which way up its samples lie.
    pub(crate) orientation: Orientation,
    /// What it says of a sphere, if it says anything.
    pub photo_sphere: Option<PhotoSphere>,
    /// What is broken and passed over, in words.
    pub broken: Vec<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Jpeg,
    Png,
    WebP,
    Tiff,
}

impl StillTags {
    /// What the file at `path` says; nothing where it cannot be read.
    pub(crate) fn of(path: &Path) -> Self {
        File::open(path)
            .map(|file| Self::read(&mut BufReader::new(file)))
            .unwrap_or_default()
    }

    /// What a file of any kind says.
    pub fn read(file: &mut (impl BufRead + Seek)) -> Self {
        let mut tags = Self::default();
        let Some(kind) = kind_of(file) else {
            return tags;
        };
        match orientation_of(file) {
            Ok(orientation) => tags.orientation = orientation,
            Err((orientation, why)) => {
                tags.orientation = orientation;
                tags.broken.push(format!(
                    "its EXIF data are broken ({why}); what can be read of them counts"
                ));
            }
        }
        let xmp = match kind {
            Kind::Jpeg => xmp_of_jpeg(file),
            Kind::Png => xmp_of_png(file),
            Kind::WebP | Kind::Tiff => None,
        };
        match xmp.as_deref().map(PhotoSphere::of_xmp) {
            Some(Ok(sphere)) => tags.photo_sphere = sphere,
            Some(Err(why)) => tags.broken.push(format!(
                "its XMP data are broken ({why}) and passed over; give --projection if it is 360°"
            )),
            None => {}
        }
        tags
    }
}

/// By the first bytes; the file stands at its beginning afterwards.
fn kind_of(file: &mut (impl BufRead + Seek)) -> Option<Kind> {
    let mut head = [0; 12];
    file.seek(SeekFrom::Start(0)).ok()?;
    file.read_exact(&mut head).ok()?;
    file.seek(SeekFrom::Start(0)).ok()?;
    match &head {
        [0xff, 0xd8, 0xff, ..] => Some(Kind::Jpeg),
        [0x89, b'P', b'N', b'G', ..] => Some(Kind::Png),
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P'] => Some(Kind::WebP),
        [b'I', b'I', 42, 0, ..] | [b'M', b'M', 0, 42, ..] => Some(Kind::Tiff),
        _ => None,
    }
}

/// The orientation; where EXIF is broken, what can still be read of it, and why it is broken.
fn orientation_of(file: &mut (impl BufRead + Seek)) -> Result<Orientation, (Orientation, String)> {
    let upright = Orientation::default();
    let read = Reader::new()
        .continue_on_error(true)
        .read_from_container(file);
    let (exif, broken) = match read {
        Ok(exif) => (exif, None),
        Err(exif::Error::NotFound(_)) => return Ok(upright),
        Err(exif::Error::PartialResult(part)) => {
            let (exif, errors) = part.into_inner();
            let why = errors.first().map(ToString::to_string);
            (exif, Some(why.unwrap_or_default()))
        }
        Err(error) => return Err((upright, error.to_string())),
    };
    let field = exif.get_field(Tag::Orientation, In::PRIMARY);
    // 0 is written where nothing is known.
    let said = field.and_then(|field| field.value.get_uint(0)).unwrap_or(0);
    let orientation = match said {
        0 => Some(upright),
        said => Orientation::from_exif(said),
    };
    let unknown = || format!("its orientation is {said}, not 1 to 8");
    match (orientation, broken) {
        (Some(orientation), None) => Ok(orientation),
        (orientation, broken) => Err((
            orientation.unwrap_or(upright),
            broken.unwrap_or_else(unknown),
        )),
    }
}

/// What has been read is kept where the decoder refuses what follows.
fn xmp_of_jpeg(file: &mut (impl BufRead + Seek)) -> Option<Vec<u8>> {
    file.seek(SeekFrom::Start(0)).ok()?;
    let mut decoder = JpegDecoder::new(file);
    let _ = decoder.decode_headers();
    decoder.xmp().cloned()
}

fn xmp_of_png(file: &mut (impl BufRead + Seek)) -> Option<Vec<u8>> {
    file.seek(SeekFrom::Start(0)).ok()?;
    let reader = png::Decoder::new(file).read_info().ok()?;
    let texts = &reader.info().utf8_text;
    let xmp = texts.iter().find(|text| text.keyword == XMP_OF_PNG)?;
    xmp.get_text().ok().map(String::into_bytes)
}
