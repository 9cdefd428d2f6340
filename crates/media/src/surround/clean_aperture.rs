//! Which part of its pictures does an MP4 or QuickTime file say is to be shown (`clap`)?

use std::path::Path;

use av::ffi;
use av::frame::Video;
use ffmpeg_next as av;

use crate::plain_file::open_plain;
use crate::surround::spherical_boxes::aperture_numbers;

/// A clean aperture (ISO/IEC 14496-12, 12.1.4), which FFmpeg passes over.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CleanAperture {
    /// Width and height of pictures as they are coded, in pixels.
    coded: [u32; 2],
    /// Left, top, width and height of what is shown; none where no such part is theirs.
    part: Option<[u32; 4]>,
    /// Whether the file says what shape its pixels have.
    has_pixel_shape: bool,
}

/// That of the first video track of a file; none where there is none, or all is shown.
pub(crate) fn clean_aperture_of(path: &Path) -> Option<CleanAperture> {
    let (mut file, _) = open_plain(path).ok()?;
    let found = aperture_numbers(&mut file)?;
    let aperture = CleanAperture {
        coded: found.coded,
        part: part(found.numbers, found.coded),
        has_pixel_shape: found.has_pixel_shape,
    };
    let [w, h] = aperture.coded;
    (w > 0 && h > 0 && aperture.part != Some([0, 0, w, h])).then_some(aperture)
}

/// The pixels that numerators and denominators of width, height, and the way from the middle to the
/// right and down give.
fn part(numbers: [u32; 8], coded: [u32; 2]) -> Option<[u32; 4]> {
    let ratio = |k: usize| {
        let [over, under] = [numbers[2 * k] as i32, numbers[2 * k + 1] as i32].map(f64::from);
        (under > 0.0).then(|| over / under)
    };
    let along = |k: usize| {
        let (length, whole) = (ratio(k)?, f64::from(coded[k]));
        let first = ((whole - length) / 2.0 + ratio(k + 2)?).round();
        let length = length.round();
        // Half a pixel is rounded away.
        let first = match (first, first + length - whole) {
            (-1.0, _) => 0.0,
            (_, 1.0) => first - 1.0,
            _ => first,
        };
        let fits = length >= 1.0 && first >= 0.0 && first + length <= whole;
        fits.then_some([first as u32, length as u32])
    };
    let [[left, width], [top, height]] = [along(0)?, along(1)?];
    // Samples of colour lie between two of brightness, and fields apart.
    let [left, top] = [left / 2 * 2, top / 2 * 2];
    Some([left, top, width, height])
}

impl CleanAperture {
    /// Cuts a frame to what is shown; frames of another size stay as they are.
    #[allow(unsafe_code)] // ffmpeg-next has no such call.
    pub(crate) fn apply(&self, frame: &mut Video) {
        let size = [frame.width(), frame.height()];
        let Some([left, top, width, height]) = self.part.filter(|_| size == self.coded) else {
            return;
        };
        let [right, bottom] = [size[0] - left - width, size[1] - top - height];
        // SAFETY: the frame is alive; the call moves its planes within their buffers, or does
        // nothing where the numbers do not fit.
        unsafe {
            let raw = frame.as_mut_ptr();
            (*raw).crop_left = left as usize;
            (*raw).crop_right = right as usize;
            (*raw).crop_top = top as usize;
            (*raw).crop_bottom = bottom as usize;
            ffi::av_frame_apply_cropping(raw, ffi::AV_FRAME_CROP_UNALIGNED as i32);
        }
    }

    /// What a person should know of it; the error says that it is passed over.
    pub(crate) fn remark(&self) -> Result<String, String> {
        let [w, h] = self.coded;
        match self.part {
            Some([_, _, width, height]) => Ok(format!(
                "its clean aperture (clap) is shown, {width}x{height} of {w}x{h} pixels"
            )),
            None => Err(format!(
                "its clean aperture (clap) is no part of its {w}x{h} pixels, and is passed over"
            )),
        }
    }

    /// The shape of pixels, as width over height, of what FFmpeg takes it for: without a box of its
    /// own it is that of the track's size on screen, which is the size of the part.
    pub(crate) fn aspect(&self, taken: Option<[i32; 2]>) -> Option<[i32; 2]> {
        let (Some([_, _, width, height]), Some(shape)) = (self.part, taken) else {
            return taken;
        };
        if self.has_pixel_shape {
            return taken;
        }
        let wide = i64::from(shape[0]) * i64::from(self.coded[0]) * i64::from(height);
        let high = i64::from(shape[1]) * i64::from(self.coded[1]) * i64::from(width);
        if (wide as f64 / high.max(1) as f64 - 1.0).abs() < 0.01 {
            return None;
        }
        let (mut w, mut h) = (0, 0);
        // SAFETY: writes the two numbers.
        #[allow(unsafe_code)]
        unsafe {
            ffi::av_reduce(&raw mut w, &raw mut h, wide, high, 4096);
        }
        (w > 0 && h > 0).then_some([w, h])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_part_lies_round_the_middle_moved_by_its_way() {
        let coded = [720, 486];
        let told = |w, h, x: i32, y: i32| part([w, 1, h, 1, x as u32, 1, y as u32, 1], coded);
        assert_eq!(told(704, 480, 0, 0), Some([8, 2, 704, 480]));
        assert_eq!(told(100, 486, -310, 0), Some([0, 0, 100, 486]));
        assert_eq!(told(720, 486, 0, 0), Some([0, 0, 720, 486]));
        for (w, x) in [(721, 0), (0, 0), (704, 10), (704, -10)] {
            assert_eq!(told(w, 486, x, 0), None, "{w} {x}");
        }
        assert_eq!(part([704, 0, 480, 1, 0, 1, 0, 1], coded), None);
    }
}
