//! How do a picture and an FFmpeg frame become each other?

use av::format::Pixel;
use av::frame::Video;
use ffmpeg_next as av;
use foveal_core::view::picture::{Picture, plane_size};

/// A new frame with memory for its samples.
#[allow(unsafe_code)] // `is_empty` is marked unsafe; `Video::new` does not report a failure.
pub(crate) fn new_frame(format: Pixel, [width, height]: [u32; 2]) -> Result<Video, String> {
    let frame = Video::new(format, width, height);
    // SAFETY: the frame was allocated just now; only its first plane pointer is compared to null.
    if unsafe { frame.is_empty() } {
        return Err(format!("no memory for a frame of {width} x {height}"));
    }
    Ok(frame)
}

/// Whether a frame has an alpha plane or channel (grey or colour plus one), or a palette that is
/// not opaque.
pub(crate) fn has_alpha(frame: &Video) -> bool {
    let format = frame.format();
    let components = format.descriptor().map_or(0, |d| d.nb_components());
    matches!(components, 2 | 4) || format == Pixel::PAL8 && !is_opaque_palette(frame)
}

#[allow(unsafe_code)] // A palette has no line size, from which ffmpeg-next computes lengths.
fn is_opaque_palette(frame: &Video) -> bool {
    // SAFETY: the second plane of a frame with a palette, where there is one, is its 256 entries of
    // four bytes, alpha in the highest of each.
    let entries = unsafe {
        let palette = (*frame.as_ptr()).data[1].cast_const();
        if palette.is_null() {
            return true;
        }
        std::slice::from_raw_parts(palette, 4 * 256)
    };
    let alpha = if cfg!(target_endian = "big") { 0 } else { 3 };
    entries.chunks_exact(4).all(|entry| entry[alpha] == 255)
}

/// The picture as a frame of `format`, which must be one of the two 8-bit 4:2:0 formats.
pub(crate) fn frame_from_picture(picture: &Picture, format: Pixel) -> Result<Video, String> {
    assert!(is_420(format), "a picture is 8-bit 4:2:0, not {format:?}");
    let mut frame = new_frame(format, [picture.width, picture.height])?;
    for p in 0..3 {
        let width = picture.plane_size(p)[0] as usize;
        let stride = frame.stride(p);
        let rows = picture.planes[p].chunks_exact(width);
        for (from, to) in rows.zip(frame.data_mut(p).chunks_mut(stride)) {
            to[..width].copy_from_slice(from);
        }
    }
    Ok(frame)
}

/// The frame as a picture; refuses other formats than 8-bit 4:2:0 and frames stored bottom up.
pub(crate) fn picture_from_frame(frame: &Video) -> Result<Picture, String> {
    if !is_420(frame.format()) {
        return Err(format!(
            "the pixel format is {:?}, expected 8-bit 4:2:0",
            frame.format()
        ));
    }
    if !rows_run_down(frame) {
        return Err("the frame's rows run upwards".to_owned());
    }
    let [width, height] = [frame.width(), frame.height()];
    let planes = [0, 1, 2].map(|p| {
        let [w, h] = plane_size(width, height, p).map(|n| n as usize);
        let mut plane = Vec::with_capacity(w * h);
        for row in frame.data(p).chunks(frame.stride(p)).take(h) {
            plane.extend_from_slice(&row[..w]);
        }
        plane
    });
    Ok(Picture {
        width,
        height,
        planes,
    })
}

/// The frame as a picture; refuses another format than NV12, whose chroma is interleaved.
pub(crate) fn picture_from_nv12(frame: &Video) -> Result<Picture, String> {
    let [width, height] = [frame.width(), frame.height()];
    let [w, h] = [width as usize, height as usize];
    let [half_w, half_h] = plane_size(width, height, 1).map(|n| n as usize);
    let fits = frame.planes() == 2
        && [w, 2 * half_w]
            .into_iter()
            .enumerate()
            .all(|(p, width)| (width..=i32::MAX as usize).contains(&frame.stride(p)));
    if frame.format() != Pixel::NV12 || !fits {
        return Err(format!(
            "the pixel format is {:?}, expected NV12 with rows from the top",
            frame.format()
        ));
    }
    let luma = frame.data(0).chunks(frame.stride(0)).take(h);
    let mut planes = [w * h, half_w * half_h, half_w * half_h].map(Vec::with_capacity);
    luma.for_each(|row| planes[0].extend_from_slice(&row[..w]));
    for row in frame.data(1).chunks(frame.stride(1)).take(half_h) {
        let pairs = row[..2 * half_w].chunks_exact(2);
        planes[1].extend(pairs.clone().map(|pair| pair[0]));
        planes[2].extend(pairs.map(|pair| pair[1]));
    }
    Ok(Picture {
        width,
        height,
        planes,
    })
}

/// Whether each of the three planes has a positive row step of at least its width (decoders of raw
/// video hand out negative ones, which ffmpeg-next's slices cannot express).
pub(crate) fn rows_run_down(frame: &Video) -> bool {
    frame.planes() >= 3
        && (0..3).all(|p| {
            let width = plane_size(frame.width(), frame.height(), p)[0] as usize;
            (width..=i32::MAX as usize).contains(&frame.stride(p))
        })
}

/// Whether the format is what a [`Picture`] holds, in limited or full range.
pub(crate) fn is_420(format: Pixel) -> bool {
    matches!(format, Pixel::YUV420P | Pixel::YUVJ420P)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::scenes::scene;

    #[test]
    fn interleaved_chroma_comes_apart_at_any_size_and_stride() {
        crate::ffmpeg::start();
        for size in [[64, 48], [33, 17], [1, 1], [2, 7]] {
            let picture = scene(size, 3, 5);
            let mut frame = new_frame(Pixel::NV12, size).unwrap();
            let [w, h] = picture.plane_size(1).map(|side| side as usize);
            let stride = frame.stride(0);
            let rows = picture.planes[0].chunks_exact(size[0] as usize);
            for (to, from) in frame.data_mut(0).chunks_mut(stride).zip(rows) {
                to[..from.len()].copy_from_slice(from);
            }
            let stride = frame.stride(1);
            for (x, y) in (0..w * h).map(|at| (at % w, at / w)) {
                for p in [1, 2] {
                    let sample = picture.planes[p][y * w + x];
                    frame.data_mut(1)[y * stride + 2 * x + p - 1] = sample;
                }
            }
            assert_eq!(picture_from_nv12(&frame).unwrap(), picture, "{size:?}");
            assert!(picture_from_frame(&frame).is_err());
            let planar = frame_from_picture(&picture, Pixel::YUV420P).unwrap();
            assert!(picture_from_nv12(&planar).is_err());
        }
    }
}
