//! What does an animation show whose pictures lie over each other?

use std::ops::Range;

use foveal_core::view::picture::{Colour, Picture};

use crate::read::deliver::over;
use crate::write::picture_from_rgba::picture_from_rgba;

/// How a picture covers the canvas.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Cover {
    /// Its upper left corner; pixels beyond the canvas are not drawn.
    pub(crate) at: [u32; 2],
    pub(crate) size: [u32; 2],
    /// Whether it blends with what is there, or replaces it.
    pub(crate) blends: bool,
    /// Whether its part is cleared before the next is drawn.
    pub(crate) vanishes: bool,
}

/// Red, green, blue and alpha of every pixel, and the part that is to be cleared.
pub(crate) struct Canvas {
    rgba: Vec<u8>,
    size: [u32; 2],
    vanishing: Option<Cover>,
}

impl Canvas {
    /// A canvas that is clear everywhere.
    pub(crate) fn new(size: [u32; 2]) -> Self {
        let pixels = size[0] as usize * size[1] as usize;
        Self {
            rgba: vec![0; 4 * pixels],
            size,
            vanishing: None,
        }
    }

    /// Clears what is to vanish, then draws a picture, if there is one.
    pub(crate) fn draw(&mut self, cover: Cover, pixels: Option<&[u8]>) {
        if let Some(last) = self.vanishing.take() {
            for (row, _) in rows_of(self.size, last) {
                self.rgba[row].fill(0);
            }
        }
        for (row, first) in pixels.into_iter().flat_map(|_| rows_of(self.size, cover)) {
            let own = pixels.and_then(|it| it.get(first..first + row.len()));
            let Some(own) = own else {
                continue;
            };
            let row = &mut self.rgba[row];
            if cover.blends {
                let all = row.chunks_exact_mut(4).zip(own.chunks_exact(4));
                all.for_each(|(behind, own)| blend(behind, own));
            } else {
                row.copy_from_slice(own);
            }
        }
        self.vanishing = cover.vanishes.then_some(cover);
    }

    /// Whether any of it can be seen through.
    pub(crate) fn is_clear(&self) -> bool {
        self.rgba.chunks_exact(4).any(|pixel| pixel[3] < 255)
    }

    /// How it looks over black.
    pub(crate) fn over_black(&self, colour: Colour) -> Picture {
        let mut rgba = self.rgba.clone();
        for pixel in rgba.chunks_exact_mut(4).filter(|pixel| pixel[3] < 255) {
            let alpha = pixel[3];
            pixel[..3]
                .iter_mut()
                .for_each(|code| *code = over(*code, 0, alpha));
        }
        picture_from_rgba(&rgba, self.size, colour)
    }
}

/// The rows of a canvas that a picture covers, in bytes, and for each the first byte of the
/// picture.
fn rows_of([w, h]: [u32; 2], cover: Cover) -> impl Iterator<Item = (Range<usize>, usize)> {
    let [x, y] = cover.at;
    let wide = cover.size[0].min(w.saturating_sub(x)) as usize;
    let high = cover.size[1].min(h.saturating_sub(y)) as usize;
    let high = if wide == 0 { 0 } else { high };
    let (w, x, y, own) = (w as usize, x as usize, y as usize, cover.size[0] as usize);
    (0..high).map(move |row| {
        let first = 4 * ((y + row) * w + x);
        (first..first + 4 * wide, 4 * row * own)
    })
}

/// Lays a pixel over another; in both, colour is not multiplied by alpha.
fn blend(behind: &mut [u8], own: &[u8]) {
    let (front, back) = (u32::from(own[3]), u32::from(behind[3]));
    // In 255ths of 255ths.
    let back = back * (255 - front);
    let both = 255 * front + back;
    if both == 0 {
        behind.fill(0);
        return;
    }
    for k in 0..3 {
        let sum = u32::from(own[k]) * 255 * front + u32::from(behind[k]) * back;
        behind[k] = ((sum + both / 2) / both) as u8;
    }
    behind[3] = ((both + 127) / 255) as u8;
}
