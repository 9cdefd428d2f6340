//! How does a picture get onto a canvas without a graphics device?

use foveal_render::RgbaImage;
use wasm_bindgen::{Clamped, JsCast};
use web_sys::{ImageData, OffscreenCanvas, OffscreenCanvasRenderingContext2d};

/// A canvas that pictures are put on pixel by pixel.
pub(crate) struct PixelCanvas {
    element: OffscreenCanvas,
    context: OffscreenCanvasRenderingContext2d,
}

impl PixelCanvas {
    /// Takes a canvas over; says why where that is not possible.
    pub(crate) fn new(element: OffscreenCanvas) -> Result<Self, String> {
        let context = element.get_context("2d").ok().flatten();
        let context = context.and_then(|context| context.dyn_into().ok());
        let context = context.ok_or("the canvas gives no 2D context")?;
        Ok(Self { element, context })
    }

    /// Shows `picture` with its left top pixel at `origin` of a canvas of `size` pixels, and black
    /// round it.
    pub(crate) fn show(
        &self,
        picture: &RgbaImage,
        origin: [u32; 2],
        size: [u32; 2],
    ) -> Result<(), String> {
        if [self.element.width(), self.element.height()] != size {
            self.element.set_width(size[0]);
            self.element.set_height(size[1]);
        }
        let refused = |error| format!("the canvas takes no picture: {error:?}");
        self.context.set_fill_style_str("black");
        let [width, height] = size.map(f64::from);
        self.context.fill_rect(0.0, 0.0, width, height);
        let pixels = Clamped(picture.pixels.as_slice());
        let data = ImageData::new_with_u8_clamped_array(pixels, picture.size[0]);
        let [x, y] = origin.map(f64::from);
        let put = |data| self.context.put_image_data(&data, x, y);
        data.and_then(put).map_err(refused)
    }
}
