//! What does a WebP say of how it is to be looked at, and does it hold what it says?

use std::io::{Read, Seek, SeekFrom};

/// What some writers put before EXIF.
const EXIF_HEAD: &[u8] = b"Exif\0\0";
/// Most parts that are looked at, and most bytes of EXIF.
const MOST_CHUNKS: u32 = 4096;
const MOST_EXIF: u64 = 1 << 20;
/// What begins the data of a picture without loss, and of one with loss behind three bytes.
const LOSSLESS: u8 = 0x2f;
const LOSSY: [u8; 3] = [0x9d, 0x01, 0x2a];

/// What its chunks say.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct WebPSays {
    pub(super) exif: Option<Vec<u8>>,
    /// Columns and rows of its canvas, and of its first picture.
    canvas: Option<[u32; 2]>,
    picture: Option<[u32; 2]>,
}

impl WebPSays {
    /// Of a file, as far as it goes.
    pub(super) fn read(file: &mut (impl Read + Seek)) -> Self {
        let mut says = Self::default();
        // What was read counts, wherever the file ends.
        let _ = says.take(file);
        says
    }

    /// That its canvas is of another size than its picture, which is shown alone.
    pub(super) fn other_canvas(&self) -> Option<String> {
        let ([w, h], [own_w, own_h]) = self.canvas.zip(self.picture)?;
        ([w, h] != [own_w, own_h]).then(|| {
            format!(
                "it says that it is {w}x{h} pixels, and its picture is {own_w}x{own_h}, which is \
                 shown"
            )
        })
    }

    fn take(&mut self, file: &mut (impl Read + Seek)) -> Option<()> {
        let mut at = 12;
        for _ in 0..MOST_CHUNKS {
            file.seek(SeekFrom::Start(at)).ok()?;
            let mut head = [0; 8];
            file.read_exact(&mut head).ok()?;
            let length = u64::from(u32::from_le_bytes(*head[4..].first_chunk()?));
            let mut inside = [0; 10];
            match head.first_chunk()? {
                b"EXIF" if length <= MOST_EXIF && self.exif.is_none() => {
                    let mut exif = Vec::new();
                    file.take(length).read_to_end(&mut exif).ok()?;
                    self.exif = Some(match exif.strip_prefix(EXIF_HEAD) {
                        Some(rest) => rest.to_vec(),
                        None => exif,
                    });
                }
                b"VP8X" => {
                    file.read_exact(&mut inside).ok()?;
                    let side =
                        |k: usize| u32::from_le_bytes([inside[k], inside[k + 1], inside[k + 2], 0]);
                    self.canvas = Some([side(4) + 1, side(7) + 1]);
                }
                b"VP8 " if self.picture.is_none() => {
                    file.read_exact(&mut inside).ok()?;
                    let side = |k: usize| {
                        u32::from(u16::from_le_bytes([inside[k], inside[k + 1]]) & 0x3fff)
                    };
                    let is_whole = inside[3..6] == LOSSY;
                    self.picture = is_whole.then(|| [side(6), side(8)]);
                }
                b"VP8L" if self.picture.is_none() => {
                    file.read_exact(&mut inside[..5]).ok()?;
                    let word = u32::from_le_bytes(*inside[1..].first_chunk()?);
                    let is_whole = inside[0] == LOSSLESS;
                    self.picture =
                        is_whole.then(|| [word & 0x3fff, word >> 14 & 0x3fff].map(|it| it + 1));
                }
                _ => {}
            }
            at += 8 + length + length % 2;
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    #[test]
    fn a_canvas_of_another_size_than_its_picture_is_told() {
        let canvas =
            |side: u8| [&b"VP8X\x0a\0\0\0\0\0\0\0"[..], &[side, 0, 0, side, 0, 0]].concat();
        let told = |bytes: Vec<u8>| {
            let bytes = [&b"RIFF\0\0\0\0WEBP"[..], &bytes].concat();
            WebPSays::read(&mut Cursor::new(bytes)).other_canvas()
        };
        let lossy = b"VP8 \x0a\0\0\0\0\0\0\x9d\x01\x2a\x40\0\x40\0".to_vec();
        let lossless = b"VP8L\x05\0\0\0\x2f\x3f\xc0\x0f\0\0".to_vec();
        for picture in [lossy, lossless] {
            assert_eq!(told([canvas(63), picture.clone()].concat()), None);
            assert_eq!(told(picture.clone()), None);
            let other = told([canvas(127), picture].concat()).unwrap();
            assert!(
                other.contains("128x128") && other.contains("64x64"),
                "{other}"
            );
        }
    }
}
