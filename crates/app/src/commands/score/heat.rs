//! How is what is lost at every pixel written down: as colours, as numbers?

use crate::report::colour_ramp::fire;
use crate::report::output::{WrongUsage, growing_name, out_of_range, write_whole};
use crate::report::picture_file::write_png;
use foveal_eval::score::fast::HeatMap;
use foveal_render::RgbaImage;
use std::path::Path;

/// What is shown in the lightest colour, JOD lost: the same in every picture, so that two can be
/// compared.
const LIGHTEST_JOD: f32 = 5.0;

/// What an NPY header's length is a multiple of, bytes.
const NPY_ALIGNMENT: usize = 64;

/// Refuses a name that says neither how to write a file there; devices take a picture.
pub(crate) fn check_name(path: &Path) -> Result<(), WrongUsage> {
    let is = |ending: &str| {
        path.extension()
            .is_some_and(|e| e.eq_ignore_ascii_case(ending))
    };
    if is("png") || is("npy") || growing_name(path).is_none() {
        return Ok(());
    }
    let range = "a name that ends in .png, for a picture, or .npy, for numbers";
    Err(out_of_range("--heat", path.display(), range))
}

/// Writes a heat map: numbers where the name ends in `.npy`, else PNG, in which black is nothing
/// lost, then violet, orange and light yellow.
pub(crate) fn write_heat(path: &Path, heat: &HeatMap) -> anyhow::Result<()> {
    let ending = path.extension().unwrap_or_default();
    if ending.eq_ignore_ascii_case("npy") {
        return write_whole(path, &npy(heat));
    }
    let mut image = RgbaImage::black(heat.size);
    for (pixel, lost) in image.pixels.chunks_exact_mut(4).zip(&heat.jod_lost) {
        // The root keeps what is small in sight.
        pixel[..3].copy_from_slice(&fire((lost / LIGHTEST_JOD).sqrt()));
    }
    write_png(path, &image)
}

/// JOD lost as NPY 1.0: little-endian single precision, rows by columns, row by row.
fn npy(heat: &HeatMap) -> Vec<u8> {
    let [columns, rows] = heat.size;
    let about =
        format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({rows}, {columns}), }}");
    let magic = b"\x93NUMPY\x01\x00";
    // Length of the text in two bytes; spaces and a new line fill it up.
    let before = magic.len() + 2;
    let header = (before + about.len() + 1).next_multiple_of(NPY_ALIGNMENT);
    let text = format!("{about:<width$}\n", width = header - before - 1);
    let length = (text.len() as u16).to_le_bytes();
    let numbers = heat.jod_lost.iter().flat_map(|lost| lost.to_le_bytes());
    let mut bytes = [magic.as_slice(), &length, text.as_bytes()].concat();
    bytes.extend(numbers);
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_as_numpy_reads_them() {
        let heat = HeatMap {
            size: [3, 2],
            jod_lost: vec![0.0, 0.5, 1.0, -2.0, 4.25, 1e-3],
        };
        let text = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }";
        let mut wanted = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
        wanted.extend(format!("{text:<117}\n").as_bytes());
        assert_eq!(wanted.len(), 128);
        for number in &heat.jod_lost {
            wanted.extend(number.to_le_bytes());
        }
        assert_eq!(npy(&heat), wanted);
    }
}
