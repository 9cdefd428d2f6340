//! What does a picture file say of how it is meant to be looked at?
//!
//! EXIF of JPEG, PNG, WebP and TIFF files says which way is up, XMP of JPEG and PNG files (before
//! the pixels) whether the picture is of a sphere.

use std::io::{BufRead, BufReader, Seek, SeekFrom};
use std::path::Path;

use exif::{In, Reader, Tag};
use zune_jpeg::JpegDecoder;

use crate::plain_file::open_plain;
use crate::read::orientation::Orientation;
use crate::read::still::png_palette::beyond_palette;
use crate::read::still::png_says::PngSays;
use crate::read::still::tiff_head::TiffHead;
use crate::read::still::webp_says::WebPSays;
use crate::surround::photo_sphere::PhotoSphere;

/// What text chunk of a PNG file holds XMP.
const XMP_OF_PNG: &str = "XML:com.adobe.xmp";

/// What is said of a JPEG without EXIF that has no end, of which only that end is missing.
const NO_END: &str = "Broken JPEG file";

/// What a file says, and what of it cannot be read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StillTags {
    /// Which way up its samples lie.
    pub(crate) orientation: Orientation,
    /// What it says of a sphere, if it says anything.
    pub photo_sphere: Option<PhotoSphere>,
    /// What is broken and passed over, in words.
    pub broken: Vec<String>,
    /// What else a person should know of it.
    pub notes: Vec<String>,
    /// Its samples are light to this power, where that is not what displays expect.
    pub(crate) power: Option<f64>,
    /// Whether its samples follow PQ or HLG.
    pub(crate) is_hdr: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Jpeg,
    Png,
    WebP,
    Tiff,
    BigTiff,
}

impl StillTags {
    /// What the file at `path` says; nothing where it cannot be read.
    pub(crate) fn of(path: &Path) -> Self {
        open_plain(path)
            .map(|(file, _)| Self::read(&mut BufReader::new(file)))
            .unwrap_or_default()
    }

    /// What a file of any kind says.
    pub fn read(file: &mut (impl BufRead + Seek)) -> Self {
        let mut tags = Self::default();
        let Some(kind) = kind_of(file) else {
            return tags;
        };
        let oriented = match kind {
            Kind::Png => {
                let says = PngSays::read(file);
                (tags.power, tags.is_hdr) = (says.power, says.is_hdr);
                tags.broken.extend(beyond_palette(file));
                orientation_of(
                    says.exif
                        .map(|it| Reader::new().continue_on_error(true).read_raw(it)),
                )
            }
            Kind::BigTiff => orientation_of(None),
            Kind::WebP => {
                let says = WebPSays::read(file);
                tags.broken.extend(says.other_canvas());
                let exif = says.exif;
                orientation_of(exif.map(|it| Reader::new().continue_on_error(true).read_raw(it)))
            }
            Kind::Jpeg | Kind::Tiff => orientation_of(Some(
                Reader::new()
                    .continue_on_error(true)
                    .read_from_container(file),
            )),
        };
        match oriented {
            Ok(orientation) => tags.orientation = orientation,
            Err((orientation, why)) => {
                tags.orientation = orientation;
                tags.broken.push(format!(
                    "its EXIF data are broken ({why}); what can be read of them counts"
                ));
            }
        }
        if matches!(kind, Kind::Tiff | Kind::BigTiff) {
            let pages = TiffHead::read(file).and_then(|it| it.pages_note());
            tags.notes.extend(pages);
        }
        let xmp = match kind {
            Kind::Jpeg => xmp_of_jpeg(file),
            Kind::Png => xmp_of_png(file),
            Kind::WebP | Kind::Tiff | Kind::BigTiff => None,
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
        [b'I', b'I', 43, 0, ..] | [b'M', b'M', 0, 43, ..] => Some(Kind::BigTiff),
        _ => None,
    }
}

/// The orientation by EXIF, if there is any; where that is broken, what can still be read of it,
/// and why it is broken.
fn orientation_of(
    read: Option<Result<exif::Exif, exif::Error>>,
) -> Result<Orientation, (Orientation, String)> {
    let upright = Orientation::default();
    let Some(read) = read else {
        return Ok(upright);
    };
    let (exif, broken) = match read {
        Ok(exif) => (exif, None),
        Err(exif::Error::NotFound(_) | exif::Error::InvalidFormat(NO_END)) => return Ok(upright),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::scenes::{raw, write_raw};
    use ffmpeg_next::format::Pixel;
    use proptest::prelude::*;
    use std::io::Cursor;

    const SPHERE: &str = "<a xmlns:G=\"http://ns.google.com/photos/1.0/panorama/\" \
        G:ProjectionType=\"equirectangular\" G:FullPanoWidthPixels=\"400\" \
        G:FullPanoHeightPixels=\"200\" G:CroppedAreaImageWidthPixels=\"100\" \
        G:CroppedAreaImageHeightPixels=\"50\" G:CroppedAreaLeftPixels=\"101\" \
        G:CroppedAreaTopPixels=\"149\"><G:PoseHeadingDegrees>90</G:PoseHeadingDegrees></a>";

    /// EXIF of orientation 6.
    const EXIF: &[u8] = b"II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0";

    fn segment(bytes: &mut Vec<u8>, head: &[u8], body: &[u8]) {
        bytes.extend([0xff, 0xe1]);
        bytes.extend(((head.len() + body.len() + 2) as u16).to_be_bytes());
        bytes.extend([head, body].concat());
    }

    /// A JPEG file with both.
    fn tagged() -> Vec<u8> {
        let file = raw("mjpeg", "jpg", Pixel::YUVJ420P, [16, 16]);
        let plain = std::fs::read(&*write_raw(&file, 1, |_, _, x, y| (x * y) as u8)).unwrap();
        let mut bytes = plain[..2].to_vec();
        segment(&mut bytes, b"Exif\0\0", EXIF);
        segment(
            &mut bytes,
            b"http://ns.adobe.com/xap/1.0/\0",
            SPHERE.as_bytes(),
        );
        bytes.extend(&plain[2..]);
        bytes
    }

    /// Reads tags, and lays a picture by them.
    fn tried(bytes: &[u8]) -> StillTags {
        let tags = StillTags::read(&mut Cursor::new(bytes));
        let alone = PhotoSphere::of_xmp(bytes).ok().flatten();
        for sphere in [tags.photo_sphere.clone(), alone].into_iter().flatten() {
            for size in [[1, 1], [100, 50], [4001, 1999]] {
                if let Ok(placed) = sphere.placed(size) {
                    let part = placed.part;
                    assert!(part.whole[0] >= size[0] && part.whole[1] >= size[1] + part.at[1]);
                    assert!(part.at[0] <= part.whole[0] && part.at.iter().all(|at| at % 2 == 0));
                }
            }
        }
        tags
    }

    #[test]
    fn a_jpeg_file_says_which_way_is_up_and_where_on_the_sphere_it_lies() {
        let tags = tried(&tagged());
        assert_eq!(Some(tags.orientation), Orientation::from_exif(6));
        assert_eq!(tags.broken, [""; 0]);
        let sphere = tags.photo_sphere.unwrap();
        assert_eq!(sphere.flat_because(), None);
        let placed = sphere.placed([100, 50]).unwrap();
        assert_eq!(
            (placed.part.whole, placed.heading_deg),
            ([400, 200], Some(90.0))
        );
        // An even place that is a pixel off at most, a quarter of a turn on.
        assert!(placed.part.at[0].abs_diff(201) <= 1 && placed.part.at[1].abs_diff(149) <= 1);
        // Twice the size, the same place.
        let placed = sphere.placed([200, 100]).unwrap();
        assert_eq!(
            (placed.part.whole, placed.part.at),
            ([800, 400], [402, 298])
        );
    }

    #[test]
    fn a_file_that_ends_anywhere_says_what_it_can_and_never_panics() {
        let whole = tagged();
        let mut complete = 0;
        for length in 0..whole.len() {
            let tags = tried(&whole[..length]);
            complete += usize::from(tags.photo_sphere.is_some());
        }
        // Pixels that are missing take no tags along.
        assert!(complete > 50, "{complete}");
        for length in 0..EXIF.len() {
            let mut cut = whole[..2].to_vec();
            segment(&mut cut, b"Exif\0\0", &EXIF[..length]);
            cut.extend(&whole[2 + 10 + EXIF.len()..]);
            let tags = tried(&cut);
            assert_eq!(tags.broken.len(), 1, "{length}: {tags:?}");
            assert!(tags.photo_sphere.is_some(), "{length}");
        }
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic(
            at in 0usize..900,
            bytes in prop::collection::vec(any::<u8>(), 1..9),
        ) {
            let mut file = tagged();
            let at = at % file.len();
            let end = (at + bytes.len()).min(file.len());
            file[at..end].copy_from_slice(&bytes[..end - at]);
            tried(&file);
            let mut packet = SPHERE.as_bytes().to_vec();
            let at = at % packet.len();
            packet[at] = bytes[0];
            tried(&packet);
        }

        #[test]
        fn no_numbers_lay_a_picture_beyond_the_sphere(
            numbers in prop::array::uniform6(prop_oneof![
                -10.0..5000.0f64, Just(1e300), Just(-1e300), 0.0..1.0f64, Just(4e9)
            ]),
            heading in -400.0..400.0f64,
        ) {
            let [a, b, c, d, e, f] = numbers;
            let packet = format!(
                "<a xmlns:G=\"{}\" G:ProjectionType=\"equirectangular\" \
                 G:FullPanoWidthPixels=\"{a}\" G:FullPanoHeightPixels=\"{b}\" \
                 G:CroppedAreaImageWidthPixels=\"{c}\" G:CroppedAreaImageHeightPixels=\"{d}\" \
                 G:CroppedAreaLeftPixels=\"{e}\" G:CroppedAreaTopPixels=\"{f}\" \
                 G:PoseHeadingDegrees=\"{heading}\"/>",
                "http://ns.google.com/photos/1.0/panorama/"
            );
            tried(packet.as_bytes());
        }
    }
}
