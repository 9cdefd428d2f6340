//! Where in a frame does each eye's picture lie?

use foveal_core::view::picture::Picture;
use std::borrow::Cow;

/// How the pictures of the eyes share a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Packing {
    /// One picture for both eyes.
    #[default]
    Mono,
    /// Next to each other.
    SideBySide,
    /// One above the other.
    TopBottom,
}

/// Where the pictures of the eyes lie in a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EyeLayout {
    /// How they share it.
    pub packing: Packing,
    /// True when the right eye's picture comes first (left or top).
    pub right_first: bool,
}

impl EyeLayout {
    /// Number of eyes with a picture of their own: 1 or 2.
    #[must_use]
    pub fn eyes(&self) -> u8 {
        match self.packing {
            Packing::Mono => 1,
            Packing::SideBySide | Packing::TopBottom => 2,
        }
    }

    /// Columns and rows of pictures in a frame.
    fn pictures(&self) -> [u32; 2] {
        match self.packing {
            Packing::Mono => [1, 1],
            Packing::SideBySide => [2, 1],
            Packing::TopBottom => [1, 2],
        }
    }

    /// Pixels of one eye's picture in a frame of `size`; refuses, with what to do, a frame that
    /// cannot be halved at an even pixel, on which chroma samples lie.
    pub fn eye_size(&self, size: [u32; 2]) -> Result<[u32; 2], String> {
        let pictures = self.pictures();
        for k in 0..2 {
            let step = 2 * pictures[k];
            if pictures[k] == 2 && (size[k] == 0 || !size[k].is_multiple_of(step)) {
                let next = size[k].max(1).next_multiple_of(step);
                let scale = [format!("{next}:ih"), format!("iw:{next}")];
                return Err(format!(
                    "its {}x{} pixels do not hold two equal eyes that begin at an even pixel; \
                     scale it with `ffmpeg -i FILE -vf scale={} OUT`, or give --stereo mono",
                    size[0], size[1], scale[k]
                ));
            }
        }
        Ok([0, 1].map(|k| size[k] / pictures[k]))
    }

    /// The picture of each eye, the left eye's first.
    ///
    /// # Panics
    /// When the frame is one that [`Self::eye_size`] refuses.
    #[must_use]
    pub fn split<'a>(&self, frame: &'a Picture) -> Cow<'a, [Picture]> {
        let [columns, rows] = self.pictures();
        if self.packing == Packing::Mono {
            return Cow::Borrowed(std::slice::from_ref(frame));
        }
        let size = [frame.width / columns, frame.height / rows];
        let second = [size[0] * (columns - 1), size[1] * (rows - 1)];
        let corners = if self.right_first {
            [second, [0, 0]]
        } else {
            [[0, 0], second]
        };
        Cow::Owned(corners.map(|corner| frame.crop(corner, size)).into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layout(packing: Packing, right_first: bool) -> EyeLayout {
        EyeLayout {
            packing,
            right_first,
        }
    }

    /// Luma that says where a pixel lies.
    fn frame(width: u32, height: u32) -> Picture {
        let mut frame = Picture::filled(width, height, [0, 128, 128]);
        for (at, luma) in frame.planes[0].iter_mut().enumerate() {
            *luma = at as u8;
        }
        frame
    }

    #[test]
    fn each_eye_gets_its_half_whichever_comes_first() {
        let frame = frame(8, 4);
        let [left, right] = [frame.crop([0, 0], [4, 4]), frame.crop([4, 0], [4, 4])];
        let [top, bottom] = [frame.crop([0, 0], [8, 2]), frame.crop([0, 2], [8, 2])];
        for (layout, expected) in [
            (layout(Packing::Mono, false), vec![frame.clone()]),
            (
                layout(Packing::SideBySide, false),
                vec![left.clone(), right.clone()],
            ),
            (layout(Packing::SideBySide, true), vec![right, left]),
            (
                layout(Packing::TopBottom, false),
                vec![top.clone(), bottom.clone()],
            ),
            (layout(Packing::TopBottom, true), vec![bottom, top]),
        ] {
            let eyes = layout.split(&frame);
            assert_eq!(*eyes, *expected);
            assert_eq!(eyes.len(), usize::from(layout.eyes()));
            let size = layout.eye_size([8, 4]).unwrap();
            assert!(eyes.iter().all(|eye| [eye.width, eye.height] == size));
        }
    }

    #[test]
    fn unequal_eyes_are_refused_with_what_to_do() {
        for (packing, size, next) in [
            (Packing::SideBySide, [1919, 1080], "scale=1920:ih"),
            (Packing::SideBySide, [1918, 1080], "scale=1920:ih"),
            (Packing::TopBottom, [1920, 1081], "scale=iw:1084"),
            (Packing::TopBottom, [1920, 0], "scale=iw:4"),
        ] {
            let error = layout(packing, false).eye_size(size).unwrap_err();
            assert!(error.contains(next), "{error}");
        }
        let odd = layout(Packing::SideBySide, false).eye_size([1920, 1081]);
        assert_eq!(odd, Ok([960, 1081]));
    }
}
