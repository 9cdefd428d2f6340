//! How do six pictures look side by side?

use foveal_render::RgbaImage;

/// Widest that a panel is shown.
const PANEL_WIDTH: u32 = 480;
/// Pixels between panels.
const GAP: u32 = 6;

/// Two rows of three pictures of one size, made smaller by whole factors where they are wide.
pub(super) fn sheet(panels: [&RgbaImage; 6]) -> RgbaImage {
    let size = panels[0].size;
    let factor = size[0].div_ceil(PANEL_WIDTH).max(1);
    let panel = size.map(|side| (side / factor).max(1));
    let mut sheet = RgbaImage::black([3 * panel[0] + 2 * GAP, 2 * panel[1] + GAP]);
    for pixel in sheet.pixels.chunks_exact_mut(4) {
        pixel.fill(255);
    }
    for (index, image) in (0_u32..).zip(panels) {
        let corner = [index % 3 * (panel[0] + GAP), index / 3 * (panel[1] + GAP)];
        for y in 0..panel[1] {
            for x in 0..panel[0] {
                let colour = block_mean(image, [x * factor, y * factor], factor);
                let width = sheet.size[0] as usize;
                let place = (corner[1] + y) as usize * width + (corner[0] + x) as usize;
                sheet.pixels[place * 4..][..3].copy_from_slice(&colour);
            }
        }
    }
    sheet
}

fn block_mean(image: &RgbaImage, corner: [u32; 2], side: u32) -> [u8; 3] {
    let mut sum = [0_u32; 3];
    let [w, h] = image.size;
    for y in corner[1]..corner[1] + side {
        for x in corner[0]..corner[0] + side {
            let place = y.min(h - 1) as usize * w as usize + x.min(w - 1) as usize;
            for (sum, &byte) in sum.iter_mut().zip(&image.pixels[place * 4..][..3]) {
                *sum += u32::from(byte);
            }
        }
    }
    sum.map(|sum| (sum / (side * side)) as u8)
}
