//! Which colours did ZBrush paint on the vertices of an OBJ file?
//!
//! It writes them into comments, up to 64 in a line: `#MRGB`, then for each vertex in order eight
//! hexadecimal digits of mask, red, green and blue.

use super::super::colour::linear_from_encoded;
use super::super::mends::{Mends, POLYPAINT_LENGTH};
use super::super::text::Words;

/// Digits of a vertex.
const DIGITS: usize = 8;

/// The colours that were read, as codes.
#[derive(Debug, Default)]
pub(super) struct Polypaint(Vec<[u8; 3]>);

impl Polypaint {
    /// Reads what follows `#MRGB`.
    pub(super) fn read(&mut self, words: &mut Words<'_>) {
        while let Some(word) = words.next() {
            for digits in word.as_bytes().chunks_exact(DIGITS) {
                let said = core::str::from_utf8(digits).ok();
                let code = said.and_then(|it| u32::from_str_radix(it, 16).ok());
                let [_, red, green, blue] = code.unwrap_or(u32::MAX).to_be_bytes();
                self.0.push([red, green, blue]);
            }
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The colours of this many vertices, in linear light; vertices without one are white.
    pub(super) fn lights(&self, vertices: usize, mends: &mut Mends) -> Vec<[f32; 4]> {
        let is_other = usize::from(self.0.len() != vertices);
        let painted = self.0.len();
        mends.add(POLYPAINT_LENGTH, is_other, || {
            format!("is {painted} for {vertices}")
        });
        let light = |code: u8| linear_from_encoded(f64::from(code) / 255.0);
        let colour = |[red, green, blue]: &[u8; 3]| [light(*red), light(*green), light(*blue), 1.0];
        let mut all: Vec<[f32; 4]> = self.0.iter().take(vertices).map(colour).collect();
        all.resize(vertices, [1.0; 4]);
        all
    }
}
