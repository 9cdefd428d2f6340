//! Which pixels of a PNG name colours that its palette does not have?

use std::io::{BufRead, Seek, SeekFrom};

use foveal_core::units::counted;
use png::{BitDepth, ColorType, Decoder, Transformations};

/// Bytes of a colour.
const COLOUR: usize = 3;

/// What a person should know of them; none where there are none, and for other files.
pub(super) fn beyond_palette(file: &mut (impl BufRead + Seek)) -> Option<String> {
    file.seek(SeekFrom::Start(0)).ok()?;
    let mut decoder = Decoder::new(file);
    decoder.set_transformations(Transformations::IDENTITY);
    let mut reader = decoder.read_info().ok()?;
    let info = reader.info();
    let colours = info.palette.as_ref()?.len() / COLOUR;
    let bits = match (info.color_type, info.bit_depth) {
        (ColorType::Indexed, BitDepth::One) => 1,
        (ColorType::Indexed, BitDepth::Two) => 2,
        (ColorType::Indexed, BitDepth::Four) => 4,
        (ColorType::Indexed, _) => 8,
        _ => return None,
    };
    if colours >= 1 << bits {
        return None;
    }
    let mask = ((1_u32 << bits) - 1) as u8;
    let is_beyond = |it: &u8| usize::from(*it) >= colours;
    let mut beyond = 0_u64;
    // A picture that breaks off is refused elsewhere.
    while let Ok(Some(row)) = reader.next_row() {
        let of_byte = |byte: &u8| {
            let byte = *byte;
            (0..8 / bits).map(move |k| byte >> (k * bits) & mask)
        };
        let codes = row.data().iter().flat_map(of_byte);
        beyond += codes.filter(is_beyond).count() as u64;
    }
    (beyond > 0).then(|| {
        format!(
            "{} of it name colours that its palette of {} does not have, and are black",
            counted(beyond, "pixel"),
            counted(colours as u64, "colour")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    #[test]
    fn pixels_beyond_the_palette_are_counted() {
        let told = |depth: BitDepth, row: &[u8], colours: usize| {
            let mut bytes = Vec::new();
            let width = row.len() as u32 * 8 / depth as u32;
            let mut encoder = png::Encoder::new(&mut bytes, width, 1);
            encoder.set_color(ColorType::Indexed);
            encoder.set_depth(depth);
            encoder.set_palette(vec![9; COLOUR * colours]);
            let mut writer = encoder.write_header().unwrap();
            writer.write_image_data(row).unwrap();
            drop(writer);
            beyond_palette(&mut Cursor::new(bytes))
        };
        assert_eq!(told(BitDepth::Eight, &[0, 1, 2], 3), None);
        let beyond = told(BitDepth::Eight, &[0, 3, 9, 2], 3).unwrap();
        assert!(
            beyond.contains("2 pixels") && beyond.contains("3 colours"),
            "{beyond}"
        );
        let beyond = told(BitDepth::Four, &[0x21, 0x03], 3).unwrap();
        assert!(beyond.contains("1 pixel of"), "{beyond}");
        assert_eq!(told(BitDepth::Four, &[0x21, 0x03], 16), None);
    }
}
