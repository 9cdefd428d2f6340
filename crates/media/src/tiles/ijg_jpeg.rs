//! How does a picture become a JPEG of a quality that other programs call the same?
//!
//! Qualities 1 to 100 scale the tables of annex K of ITU-T T.81 the way the library of the
//! Independent JPEG Group does. FFmpeg's encoder cannot: it has one quantiser, and fixes that of
//! the mean.

use foveal_core::view::picture::Picture;
use jpeg_encoder::{Encoder, EncodingError, ImageBuffer, JpegColorType, SamplingFactor};

/// The picture as a baseline JPEG of 4:2:0; `optimised` codes it twice to fit the Huffman tables,
/// a few per cent smaller.
pub(crate) fn jpeg_from_picture(
    picture: &Picture,
    quality: u8,
    optimised: bool,
) -> Result<Vec<u8>, String> {
    let size = [picture.width, picture.height].map(u16::try_from);
    let [Ok(width), Ok(height)] = size else {
        return Err("a JPEG has at most 65535 pixels on a side".to_owned());
    };
    let mut file = Vec::new();
    let mut encoder = Encoder::new(&mut file, quality);
    encoder.set_sampling_factor(SamplingFactor::R_4_2_0);
    encoder.set_optimized_huffman_tables(optimised);
    let rows = Rows {
        picture,
        size: [width, height],
    };
    let coded = encoder.encode_image(rows);
    coded.map_err(|e: EncodingError| e.to_string())?;
    Ok(file)
}

/// The rows as the encoder asks for them: chroma as wide and high as luma, each sample repeated, so
/// that its mean over two by two is the sample itself.
struct Rows<'a> {
    picture: &'a Picture,
    size: [u16; 2],
}

impl ImageBuffer for Rows<'_> {
    fn get_jpeg_color_type(&self) -> JpegColorType {
        JpegColorType::Ycbcr
    }

    fn width(&self) -> u16 {
        self.size[0]
    }

    fn height(&self) -> u16 {
        self.size[1]
    }

    fn fill_buffers(&self, y: u16, buffers: &mut [Vec<u8>; 4]) {
        let width = usize::from(self.size[0]);
        buffers[0].extend_from_slice(&self.picture.planes[0][usize::from(y) * width..][..width]);
        let columns = width.div_ceil(2);
        for (plane, buffer) in self.picture.planes.iter().zip(buffers).skip(1) {
            let row = &plane[usize::from(y / 2) * columns..][..columns];
            let doubled = row.iter().flat_map(|sample| [*sample; 2]);
            buffer.extend(doubled.take(width));
        }
    }
}
