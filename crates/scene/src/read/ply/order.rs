//! Are the numbers of a binary file stored in the order of bytes that its header says?

use super::header::{Encoding, PlyHeader, Property, Scalar};
use super::numbers::Numbers;

/// Rows that are looked at, evenly over the file.
const ROWS: u64 = 64;
/// Sizes of coordinates that can be meant; the other way round, nearly all lie outside.
const MEANT: std::ops::RangeInclusive<f64> = 1e-12..=1e18;
/// Fewest coordinates that show it.
const LEAST: usize = 3;

/// How many of the coordinates that are looked at can be meant, and how many cannot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Seen {
    meant: usize,
    odd: usize,
}

/// Gives a header the other order of bytes where coordinates of vertices can only be meant in that;
/// whether it did.
pub(super) fn mend(header: &mut PlyHeader, bytes: &[u8]) -> bool {
    let other = match header.encoding {
        Encoding::Text => return false,
        Encoding::LittleEndian => Encoding::BigEndian,
        Encoding::BigEndian => Encoding::LittleEndian,
    };
    let Some(told) = seen(header, bytes, header.encoding) else {
        return false;
    };
    // So it is in all files but a few.
    if told.odd <= told.meant || told.odd < LEAST {
        return false;
    }
    let turned = seen(header, bytes, other).unwrap_or_default();
    let is_turned = turned.meant >= LEAST && turned.odd * 16 <= turned.meant;
    if is_turned {
        header.encoding = other;
    }
    is_turned
}

/// What coordinates look like in an order of bytes; none where vertices are not real numbers at the
/// beginning of the data.
fn seen(header: &PlyHeader, bytes: &[u8], encoding: Encoding) -> Option<Seen> {
    let vertices = header.elements.first().filter(|it| it.name == "vertex")?;
    let mut all = Vec::new();
    for property in &vertices.properties {
        match property {
            Property::One { name, scalar } => {
                let is_along = ["x", "y", "z"].contains(&&*name.to_ascii_lowercase());
                let is_real = matches!(scalar, Scalar::F32 | Scalar::F64);
                all.push((*scalar, is_along && is_real));
            }
            Property::List { .. } => return None,
        }
    }
    let row = all.iter().map(|(scalar, _)| scalar.bytes()).sum::<usize>();
    let step = vertices.count.div_ceil(ROWS).max(1);
    let mut found = Seen::default();
    for index in (0..vertices.count).step_by(usize::try_from(step).ok()?) {
        let at = usize::try_from(index).ok()?.checked_mul(row)?;
        let Some(at) = header.end.checked_add(at).filter(|it| *it < bytes.len()) else {
            break;
        };
        let one = PlyHeader {
            encoding,
            end: at,
            ..header.clone()
        };
        let mut numbers = Numbers::of(&one, bytes);
        for (scalar, is_along) in &all {
            let Some(number) = numbers.number(*scalar) else {
                break;
            };
            // No number at all may be meant.
            if *is_along && number != 0.0 && !number.is_nan() {
                match MEANT.contains(&number.abs()) {
                    true => found.meant += 1,
                    false => found.odd += 1,
                }
            }
        }
    }
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cloud whose header says so, of points whose numbers are stored so.
    fn cloud(told: &str, stored: impl Fn(f32) -> [u8; 4], points: &[[f32; 3]]) -> Vec<u8> {
        let mut bytes = format!(
            "ply\nformat {told} 1.0\nelement vertex {}\nproperty float x\nproperty float y\n\
             property float z\nproperty uchar red\nend_header\n",
            points.len()
        )
        .into_bytes();
        for point in points {
            bytes.extend(point.iter().flat_map(|it| stored(*it)));
            bytes.push(7);
        }
        bytes
    }

    fn is_mended(bytes: &[u8]) -> bool {
        mend(&mut PlyHeader::parse(bytes).unwrap(), bytes)
    }

    #[test]
    fn only_numbers_that_cannot_be_meant_are_turned_round() {
        let points: Vec<[f32; 3]> = (0..900)
            .map(|k| [k as f32 * 0.37, 1e5 - k as f32, f32::NAN])
            .collect();
        for (told, other) in [
            ("binary_little_endian", "binary_big_endian"),
            ("binary_big_endian", "binary_little_endian"),
        ] {
            let is_little = told == "binary_little_endian";
            let stored = |it: f32| {
                if is_little {
                    it.to_le_bytes()
                } else {
                    it.to_be_bytes()
                }
            };
            assert!(!is_mended(&cloud(told, stored, &points)));
            assert!(is_mended(&cloud(other, stored, &points)));
            // Nothing is known of numbers that cannot be meant either way.
            let odd = [[1e-40, 2e-40, 3e30]; 9];
            assert!(!is_mended(&cloud(told, stored, &odd)));
            let zeros = [[0.0, 0.0, 0.0]; 9];
            assert!(!is_mended(&cloud(told, stored, &zeros)));
        }
    }
}
