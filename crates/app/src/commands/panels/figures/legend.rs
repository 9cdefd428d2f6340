//! What do the colours of a picture stand for?

use foveal_media::generate::text::{ADVANCE, word};
use foveal_render::RgbaImage;

/// Pixels of a dot of a letter, of the bar's height, and of what is round both.
const DOT: f32 = 2.0;
const BAR: u32 = 14;
const MARGIN: u32 = 8;
/// Rows of a line of words.
const LINE: u32 = 18;
/// Most columns of a bar.
const WIDEST: u32 = 480;
const INK: [u8; 4] = [48, 52, 58, 255];

/// A bar of colours.
pub(super) struct Legend<'a> {
    /// Its text, in capitals.
    pub(super) caption: &'a str,
    /// Words, each at a share of the bar from 0 to 1.
    pub(super) ticks: &'a [(&'a str, f64)],
    /// The colour of a share.
    pub(super) colour: &'a dyn Fn(f64) -> [u8; 4],
}

impl Legend<'_> {
    /// The same picture with the bar below.
    pub(super) fn below(&self, picture: &RgbaImage) -> RgbaImage {
        let [w, h] = picture.size;
        let size = [w, h + 2 * LINE + BAR + 2 * MARGIN];
        let mut image = RgbaImage {
            size,
            pixels: picture.pixels.clone(),
        };
        image.pixels.resize(4 * (size[0] * size[1]) as usize, 255);
        let wide = w.saturating_sub(6 * MARGIN).clamp(1, WIDEST);
        let left = 3 * MARGIN;
        write(&mut image, self.caption, [left as f32, h as f32]);
        let top = h + LINE + MARGIN / 2;
        for x in 0..wide.min(w.saturating_sub(left)) {
            let colour = (self.colour)(f64::from(x) / f64::from((wide - 1).max(1)));
            for y in 0..BAR {
                image.set_pixel([left + x, top + y], colour);
            }
        }
        for (text, share) in self.ticks {
            let middle = f64::from(left) + share * f64::from(wide - 1);
            let column = (middle as u32).min(w - 1);
            for y in BAR..BAR + 4 {
                image.set_pixel([column, top + y], INK);
            }
            let half = 0.5 * DOT * (ADVANCE * text.len() as f32 - 1.0);
            let at = [middle as f32 - half, (top + BAR + 5) as f32];
            write(&mut image, text, at);
        }
        image
    }
}

/// Writes a word from its upper left corner.
fn write(image: &mut RgbaImage, text: &str, [left, top]: [f32; 2]) {
    let [w, h] = image.size;
    let end = left + DOT * ADVANCE * text.len() as f32;
    for y in (top.max(0.0) as u32..h).take_while(|y| (*y as f32) < top + 8.0 * DOT) {
        for x in (left.max(0.0) as u32..w).take_while(|x| (*x as f32) < end) {
            let at = [(x as f32 + 0.5 - left) / DOT, (y as f32 + 0.5 - top) / DOT];
            let inked = word(text, at, 1.0 / DOT);
            let ground = image.pixel([x, y]);
            let mix = |k: usize| {
                let (from, to) = (f32::from(ground[k]), f32::from(INK[k]));
                (from + (to - from) * inked).round() as u8
            };
            image.set_pixel([x, y], [mix(0), mix(1), mix(2), 255]);
        }
    }
}
